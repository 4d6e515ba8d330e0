"""Digests of the chip."""

DATA_FILES = ("sha_parallel_engine.h",)
