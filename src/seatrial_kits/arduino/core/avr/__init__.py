"""Headers of avr-libc that sketches include."""

DATA_FILES = ("eeprom.h", "interrupt.h", "io.h", "pgmspace.h", "wdt.h")
