"""FMUs as files: read without trust, built where they come as sources, loaded."""
