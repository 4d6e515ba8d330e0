"""Base64 as libraries include it."""

DATA_FILES = ("cencode.h",)
