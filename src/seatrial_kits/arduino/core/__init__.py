"""The Arduino API of AVR boards in simulated time, in C++."""

DATA_FILES = (
    "Arduino.h",
    "EEPROM.h",
    "HardwareSerial.h",
    "SPI.h",
    "Servo.h",
    "SoftwareSerial.h",
    "Wire.h",
    "api.cpp",
    "avr_libc.cpp",
    "avr_libc.h",
    "board.h",
    "devices.cpp",
    "pins_arduino.h",
    "sketch.h",
)
