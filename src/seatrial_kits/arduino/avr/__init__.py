"""Real firmware: the program around simavr, and a Servo library for it, in C and C++."""

DATA_FILES = (
    "Servo.cpp",
    "Servo.h",
    "adc.h",
    "emulated_board.c",
    "hangs.h",
    "i2c.h",
    "lines.h",
    "memory.h",
    "modulation.h",
    "pins.c",
    "spi.h",
    "stack.h",
    "ticks.h",
)
