"""The board that a sketch is for, by headers, words and project files of that board alone."""

from __future__ import annotations

import re
from collections.abc import Iterator
from itertools import islice
from pathlib import Path

from .boards import named_board
from .libraries import included, read_source
from .sketch import Sketch
from .tokens import Token, tokens

_HEADERS = {
    "ESP32": (
        r"WiFi\.h|WebServer\.h|Preferences\.h|ESPmDNS\.h|BluetoothSerial\.h|BLE\w+\.h|SPIFFS\.h"
        r"|LittleFS\.h|SD_MMC\.h|Ticker\.h|esp_\w+\.h|(?:driver|freertos|soc|rom|nvs\w*)/.*"
        r"|Esp\w+\.h|AsyncTCP\.h|ESP32\w*\.h|HWCDC\.h"
    ),
    "ESP8266": r"ESP8266\w+\.h|ESPAsyncTCP\.h|user_interface\.h",
    "Teensy": r"FlexCAN\w*\.h|IntervalTimer\.h|TeensyThreads\.h|i2c_t3\.h|imxrt\.h|kinetis\.h",
    "SAMD": r"RTCZero\.h|FlashStorage\w*\.h|SAMD\w*\.h|ArduinoLowPower\.h|WiFiNINA\.h|sam\.h",
    "STM32": r"STM32\w*\.h|stm32\w*\.h|HardwareTimer\.h|libmaple/.*",
    "RP2040": r"pico/.*|hardware/.*",
    "nRF52": r"bluefruit\.h|nrf\w*\.h|Adafruit_nRF\w*\.h",
}
_WORDS = {
    "ESP32": (
        r"ledc[A-Z]\w+|xTask\w+|vTask\w+|IRAM_ATTR|esp_\w+|portENTER_CRITICAL\w*|touchRead"
        r"|timerBegin|timerAlarm\w*|twai_\w+|GPIO_NUM_\d+|hallRead"
    ),
    "Teensy": r"IntervalTimer|elapsedMillis|elapsedMicros|Serial[4-8]|analogWriteFrequency",
    "SAMD": r"SerialUSB|SERCOM\d|PM_?APBCMASK|GCLK",
    "STM32": r"P[A-H](?:1[0-5]|\d)_?|HAL_\w+|RCC|GPIO[A-K]",
}
_CONDITIONS = {
    "ESP32": r"ESP32|ARDUINO_ARCH_ESP32",
    "ESP8266": r"ESP8266|ARDUINO_ARCH_ESP8266",
    "Teensy": r"TEENSYDUINO|__IMXRT1062__|__MK\w+__|CORE_TEENSY",
    "SAMD": r"ARDUINO_ARCH_SAMD|__SAMD\d\w+__",
    "STM32": r"ARDUINO_ARCH_STM32|STM32\w*",
    "Mega": r"__AVR_ATmega2560__|ARDUINO_AVR_MEGA2560",
    "Uno": r"__AVR_ATmega328P__|ARDUINO_AVR_UNO",
}
_GUARD = re.compile(r"^\s*#\s*(?:if|ifndef)\b([^\n]*)\n(?:\s*(?://[^\n]*)?\n)*\s*#\s*error\b", re.M)
_BOARDS = {"avr": ("Uno", "Mega"), "esp32": ("ESP32",)}
"""Of each family of microcontrollers."""


def target_boards(sketch: Sketch) -> dict[str, list[str]]:
    """Return the boards that a sketch is for, each with what says so, the most certain first.

    Evidence is what a project file names, a condition whose failure is an #error, and headers and
    words outside conditions. A sketch without any is for every board.
    """
    found: dict[str, list[str]] = {}
    file_name, fqbn = named_board(sketch.folder)
    if fqbn:
        found.setdefault(_of_fqbn(fqbn), []).append(f"{file_name}: {fqbn}")
    for file in [*sketch.tabs, *sketch.own_files()]:
        source = read_source(file)
        for match in _GUARD.finditer(source):
            for board in _matching(_CONDITIONS, re.findall(r"\w+", match[1])):
                found.setdefault(board, []).append(f"#error without {match[1].strip()}")
        plain = unconditional(source)
        headers = [header for header, _ in included(plain) if not _own(sketch, file, header)]
        words = [token.text for token in tokens(plain) if token.kind == "word"]
        for table, names in ((_HEADERS, headers), (_WORDS, words)):
            for board, evidence in _matching(table, names).items():
                found.setdefault(board, []).extend(evidence)
    return {board: list(dict.fromkeys(evidence)) for board, evidence in found.items()}


def target_text(sketch: Sketch, family: str) -> str:
    """Return ``for the ESP32 (WiFi.h, ledcSetup)``, '' if nothing says so.

    For a board of another family than the one at hand, the option that selects it stands behind.
    """
    boards = target_boards(sketch)
    parts = [f"{board} ({', '.join(evidence[:4])})" for board, evidence in boards.items()]
    text = f"for the {' or '.join(parts)}" if parts else ""
    if list(boards) == ["ESP32"] and family != "esp32":
        return f"{text}: take that board by --mcu esp32, or mcu=esp32 in a profile or rig"
    return text


def is_foreign(sketch: Sketch, family: str) -> bool:
    """Return whether all that says for which board a sketch is names others than the family's."""
    boards = target_boards(sketch)
    return bool(boards) and not any(board in _BOARDS[family] for board in boards)


def unconditional(source: str) -> str:
    """Return a source without what lies between #if and #endif; lines stay as they are.

    The guard around a whole header is no condition.
    """
    lines, depth = source.split("\n"), 0
    begin = [token.text for token in islice(_code(source), 6)]
    guard = begin[:2] == ["#", "ifndef"] and begin[3:5] == ["#", "define"]
    for number, line in enumerate(lines):
        directive = line.lstrip().lstrip("#").lstrip() if line.lstrip().startswith("#") else ""
        depth -= directive.startswith("endif")
        if depth > guard:
            lines[number] = ""
        depth += directive.startswith("if")
    return "\n".join(lines)


def _code(source: str) -> Iterator[Token]:
    return (token for token in tokens(source) if token.kind != "space")


def _matching(table: dict[str, str], names: list[str]) -> dict[str, list[str]]:
    found = {}
    for board, pattern in table.items():
        if evidence := [name for name in names if re.fullmatch(pattern, name)]:
            found[board] = list(dict.fromkeys(evidence))
    return found


def _own(sketch: Sketch, file: Path, header: str) -> bool:
    return any((folder / header).is_file() for folder in (file.parent, sketch.folder))


def _of_fqbn(fqbn: str) -> str:
    """Return the family of a board by its fully qualified name: PACKAGE:ARCHITECTURE:BOARD."""
    parts = fqbn.lower().split(":")
    architecture = parts[1] if len(parts) > 1 else ""
    board = parts[2] if len(parts) > 2 else ""
    if architecture == "avr":
        return "Mega" if board.startswith("mega") else "Uno" if board in ("uno", "nano") else board
    families = {"esp32": "ESP32", "esp8266": "ESP8266", "samd": "SAMD", "stm32": "STM32"}
    return families.get(architecture, fqbn)
