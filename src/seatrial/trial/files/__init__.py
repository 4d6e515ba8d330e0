"""Trial and campaign files."""
