"""Functions of the chip's ROM."""

DATA_FILES = ("ets_sys.h",)
