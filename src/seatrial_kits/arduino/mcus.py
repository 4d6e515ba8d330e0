"""The boards' microcontrollers, and their pins."""

from __future__ import annotations

from dataclasses import dataclass

from seatrial.errors import InputError

CLOCK = 16_000_000
"""Cycles a second, of all of them."""


@dataclass(frozen=True)
class Mcu:
    """A microcontroller as an Arduino board has it: ``variant`` is that of the Arduino core."""

    name: str
    board: str
    variant: str
    pins: int
    analog: int
    first_analog: int
    uarts: int
    ram: int
    eeprom: int
    """Bytes of memory."""
    ports: tuple[str, ...]
    """Port and bit of each pin, as ``B7``."""

    @property
    def defines(self) -> tuple[str, ...]:
        """Macros for the compiler."""
        board = "UNO" if self.uarts == 1 else "MEGA"
        name = "UNO" if self.uarts == 1 else "MEGA2560"
        chip = "ATmega328P" if self.uarts == 1 else "ATmega2560"
        arduino = ("-DARDUINO=10819", "-DARDUINO_ARCH_AVR", f"-DARDUINO_AVR_{name}")
        return (f"-DBOARD_{board}", *arduino, "-D__AVR__", f"-D__AVR_{chip}__")

    def pin(self, text: str) -> int:
        """Return a pin's number from its name: ``9``, ``D9``, ``A0``. Raises InputError."""
        upper = text.upper()
        number = -1
        if upper.startswith("A") and upper[1:].isdecimal() and int(upper[1:]) < self.analog:
            number = self.first_analog + int(upper[1:])
        elif upper.removeprefix("D").isdecimal():
            number = int(upper.removeprefix("D"))
        if not 0 <= number < self.pins:
            raise InputError(
                f"pin {text!r}: the {self.board} has 0 to {self.pins - 1} and "
                f"A0 to A{self.analog - 1}"
            )
        return number


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

MCUS = {
    "atmega2560": Mcu("atmega2560", "Mega", "mega", 70, 16, 54, 4, 8192, 4096, _ports(_MEGA)),
    "atmega328p": Mcu("atmega328p", "Uno", "standard", 20, 6, 14, 1, 2048, 1024, _ports(_UNO)),
}
