"""The simulated board of the host back end in C++, below the API of any family of boards."""

DATA_FILES = (
    "Print.h",
    "Stream.h",
    "WString.h",
    "basics.cpp",
    "basics.h",
    "binary.h",
    "crashes.h",
    "interrupts.h",
    "machine.cpp",
    "machine.h",
    "messages.h",
    "pins.h",
    "reset.h",
    "servos.h",
    "texts.cpp",
    "tones.h",
    "uarts.cpp",
)
