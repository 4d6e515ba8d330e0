"""Registers of the chip that sketches use by themselves."""

DATA_FILES = (
    "gpio_struct.h",
    "rtc_cntl_reg.h",
    "soc.h",
)
