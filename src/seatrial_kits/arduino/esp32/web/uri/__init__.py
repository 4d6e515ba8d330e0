"""Paths that a web server answers."""

DATA_FILES = (
    "UriBraces.h",
    "UriRegex.h",
)
