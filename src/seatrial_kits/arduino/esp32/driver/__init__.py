"""Drivers of ESP-IDF that sketches use by themselves."""

DATA_FILES = (
    "adc.h",
    "gpio.h",
    "ledc.h",
    "twai.h",
)
