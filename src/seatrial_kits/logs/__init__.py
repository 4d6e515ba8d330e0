"""Records as logs that other tools read, one format per file."""
