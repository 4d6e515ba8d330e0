"""Registers of the chip that sketches use by themselves."""

DATA_FILES = ("gpio_struct.h",)
