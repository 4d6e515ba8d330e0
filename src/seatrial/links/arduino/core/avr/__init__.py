"""Headers of avr-libc that sketches include."""

DATA_FILES = (
    "interrupt.h",
    "pgmspace.h",
    "wdt.h",
)
