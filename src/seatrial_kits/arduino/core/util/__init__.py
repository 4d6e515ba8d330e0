"""Headers of avr-libc that sketches include."""

DATA_FILES = ("atomic.h", "crc16.h", "delay.h")
