"""Drivers of ESP-IDF that sketches use by themselves."""

DATA_FILES = (
    "adc.h",
    "gpio.h",
    "ledc.cpp",
    "ledc.h",
    "rtc_io.h",
    "twai.h",
)
