"""The Arduino API in simulated time, in C++."""

DATA_FILES = (
    "Arduino.h",
    "EEPROM.h",
    "HardwareSerial.h",
    "Print.h",
    "SPI.h",
    "Servo.h",
    "SoftwareSerial.h",
    "Stream.h",
    "WString.h",
    "Wire.h",
    "api.cpp",
    "avr_libc.cpp",
    "avr_libc.h",
    "devices.cpp",
    "machine.cpp",
    "machine.h",
    "reset.h",
    "sketch.h",
    "texts.cpp",
    "uarts.cpp",
)
