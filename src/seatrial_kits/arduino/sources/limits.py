"""What the host back end does not show or has not, by family of boards."""

from __future__ import annotations

import re

LIMITS = {
    "avr": (
        "products and sums of int are computed with 32 bits: an overflow of 16 bits stays hidden "
        "until the value is stored",
        "pointers, size_t and enums have the computer's widths",
        "double is another word for float, and int for short: what is defined for both, is twice",
        "code takes about 12 cycles from one jump to the next, whatever it computes: timing of the "
        "code itself is a guess (simavr counts cycles)",
        "interrupts come between stretches of code, never within one",
        "memory is not the board's: a sketch too large for it goes unnoticed (not by simavr's "
        "build)",
    ),
    "esp32": (
        "code takes about 15 cycles at 240 MHz from one jump to the next, whatever it computes: "
        "timing of the code itself is a guess",
        "tasks of both cores take turns on one: while one computes, the others wait, 1 ms at most",
        "interrupts and changes of tasks come between stretches of code, never within one",
        "memory and the stacks of tasks are not the board's: too large a sketch goes unnoticed",
        "the ADC is linear up to its full scale",
        "random numbers are the same in each run",
        "TLS (https, WiFiClientSecure.h) connects to nobody; nobody asks for a name by mDNS, and "
        "no update of the program arrives",
    ),
}
"""As `seatrial sketch check` prints it."""

_ABSENT = {
    r"BLE\w*\.h|NimBLE\w*\.h|esp_bt\w*\.h|esp_gap\w*\.h|esp_spp\w*\.h": "Bluetooth LE",
    r"esp_netif\w*\.h|esp_event\.h|esp_mesh\w*\.h|ETH\.h": "the radio below WiFi.h and esp_now.h",
    r"esp_http\w*\.h|esp_websocket\w*\.h|mqtt_client\.h": "ESP-IDF's web beside Arduino's",
    r"AsyncUDP\.h|lwip/.*": "the network below WiFi.h and AsyncTCP.h",
    r"mbedtls/.*|esp_tls\.h": "encryption",
    r"esp_camera\.h|camera_\w+\.h|img_converters\.h": "the camera",
    r"esp_sleep\.h|esp_pm\.h|ulp\w*\.h": "sleep",
    r"esp_ota_ops\.h|HTTPUpdate\w*\.h|esp_https_ota\.h": "updates of its program",
    r"sd_diskio\.h": "what lies below SD.h",
    r"soc/.*|rom/.*|hal/.*|xtensa/.*|esp32\w*/.*": "registers",
    r"driver/(?:mcpwm|pcnt|rmt|i2s|i2c|uart|spi_\w+|dac|touch_pad)\w*\.h": "ESP-IDF's own drivers",
    r"nvs\w*\.h|esp_partition\.h|esp_spiffs\.h|esp_vfs\w*\.h": "the flash below Preferences.h",
}


def absent(header: str, family: str) -> str:
    """Return what a family's API lacks with a header of the board's own; '' for other headers."""
    if family != "esp32":
        return ""
    return next((what for pattern, what in _ABSENT.items() if re.fullmatch(pattern, header)), "")
