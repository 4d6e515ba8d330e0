"""Runs on disk: their files, read, compared, and placed in the world."""
