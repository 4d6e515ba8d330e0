"""The boards' microcontrollers, and their pins."""

from __future__ import annotations

from dataclasses import dataclass

from seatrial.errors import InputError

CLOCK = 16_000_000
"""What boards count time in, a second: the cycles of an AVR, and of others the same unit."""


@dataclass(frozen=True)
class Mcu:
    """A microcontroller as an Arduino board has it."""

    name: str
    board: str
    family: str
    """``avr`` or ``esp32``."""
    pins: int
    analog: tuple[int, ...]
    """Pins A0, A1, ...; -1 for one that there is not."""
    uarts: int
    ram: int
    eeprom: int
    """Bytes of memory."""
    defines: tuple[str, ...]
    """Macros for the compiler."""
    variant: str = ""
    """Of the Arduino core for AVR boards."""
    ports: tuple[str, ...] = ()
    """Port and bit of each pin of an AVR, as ``B7``."""

    def pin(self, text: str) -> int:
        """Return a pin's number from its name: ``9``, ``D9``, ``GPIO9``, ``A0``.

        Raises InputError for one that there is not.
        """
        upper = text.upper()
        digits = upper.removeprefix("GPIO").removeprefix("IO").removeprefix("D")
        number = -1
        if upper.startswith("A") and upper[1:].isdecimal() and int(upper[1:]) < len(self.analog):
            number = self.analog[int(upper[1:])]
        elif digits.isdecimal():
            number = int(digits)
        if not 0 <= number < self.pins:
            raise InputError(f"pin {text!r}: the {self.board} has {self._pins()}")
        return number

    def channel(self, pin: int) -> int:
        """Return the ADC channel of a pin: of an AVR its number, of others the pin itself.

        Raises InputError for a pin without an ADC.
        """
        if pin not in self.analog:
            raise InputError(f"pin {pin}: the {self.board} has no ADC there: {self._pins()}")
        return pin if self.family != "avr" else self.analog.index(pin)

    def _pins(self) -> str:
        whole = f"0 to {self.pins - 1} and A0 to A{len(self.analog) - 1}"
        gaps = [f"A{n}" for n, pin in enumerate(self.analog) if pin < 0]
        return f"{whole} without {', '.join(gaps)}" if gaps else whole


def _avr(board: str, chip: str) -> tuple[str, ...]:
    name = {"UNO": "UNO", "MEGA": "MEGA2560"}[board]
    arduino = ("-DARDUINO=10819", "-DARDUINO_ARCH_AVR", f"-DARDUINO_AVR_{name}")
    return (f"-DBOARD_{board}", *arduino, "-D__AVR__", f"-D__AVR_{chip}__")


def _esp32(target: str, board: str) -> tuple[str, ...]:
    """Return macros of Arduino-ESP32 2.0, the core that PlatformIO has; of 3.0, calls are there."""
    common = ("-DESP32", "-DESP_PLATFORM", "-DARDUINO=10812", "-DARDUINO_ARCH_ESP32")
    chip = (f"-DCONFIG_IDF_TARGET_{target}=1", f"-DARDUINO_{board}", f"-DBOARD_{target}")
    return (*common, *chip, "-DF_CPU=240000000L")


def _ports(text: str) -> tuple[str, ...]:
    """Return the pins of 'E0-1 E4': E0, E1, E4; 'A7-0' runs down."""
    found = []
    for part in text.split():
        port, bits = part[0], part[1:].split("-")
        first, last = int(bits[0]), int(bits[-1])
        step = 1 if last >= first else -1
        found += [f"{port}{bit}" for bit in range(first, last + step, step)]
    return tuple(found)


# Arduino's tables of pins: Mega 2560 and Uno.
_MEGA = "E0-1 E4-5 G5 E3 H3-6 B4-7 J1-0 H1-0 D3-0 A0-7 C7-0 D7 G2-0 L7-0 B3-0 F0-7 K0-7"
_UNO = "D0-7 B0-5 C0-5"
# Arduino-ESP32's, A0 on.
_ANALOG = (36, -1, -1, 39, 32, 33, 34, 35, -1, -1, 4, 0, 2, 15, 13, 12, 14, 27, 25, 26)

MCUS = {
    mcu.name: mcu
    for mcu in (
        Mcu(
            "atmega2560", "Mega", "avr", 70, tuple(range(54, 70)), 4, 8192, 4096,
            _avr("MEGA", "ATmega2560"), "mega", _ports(_MEGA),
        ),
        Mcu(
            "atmega328p", "Uno", "avr", 20, tuple(range(14, 20)), 1, 2048, 1024,
            _avr("UNO", "ATmega328P"), "standard", _ports(_UNO),
        ),
        Mcu(
            "esp32", "ESP32", "esp32", 40, _ANALOG, 3, 327680, 4096,
            _esp32("ESP32", "ESP32_DEV"),
        ),
        Mcu(
            "esp32s3", "ESP32-S3", "esp32", 49, tuple(range(1, 21)), 3, 327680, 4096,
            _esp32("ESP32S3", "ESP32S3_DEV"),
        ),
        Mcu(
            "esp32c3", "ESP32-C3", "esp32", 22, tuple(range(6)), 2, 327680, 4096,
            _esp32("ESP32C3", "ESP32C3_DEV"),
        ),
    )
}  # fmt: skip
