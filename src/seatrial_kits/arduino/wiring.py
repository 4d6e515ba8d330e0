"""Wiring of a board: pins, I2C devices and UARTs, as a profile writes it."""

from __future__ import annotations

from dataclasses import dataclass

from seatrial.errors import InputError, unknown
from seatrial.links.endpoints.budget import Budget
from seatrial.links.endpoints.endpoint import Endpoint
from seatrial.links.endpoints.url import check_urls, open_endpoints

from .mcus import MCUS, Mcu
from .parts.shelf import is_part, known_part, part_names

UARTS, SERVOS, OTHERS, STEPPERS, BLOCKS, GROUP = 4, 12, 8, 4, 6, 4
_NUMBERED = {
    "servo": SERVOS,
    "pwm": OTHERS,
    "output": OTHERS,
    "input": OTHERS,
    "voltage": OTHERS,
    "receiver": OTHERS,
    "step": STEPPERS,
    "direction": STEPPERS,
    "soft_rx": UARTS - 1,
    "soft_tx": UARTS - 1,
}
_ANALOG = ("voltage", "vane")
_FACTORS = {"anemometer": 1.0, "vane": 5.0}
"""Kinds with a factor, and its default: Hz per m/s; volts of a full circle."""


@dataclass(frozen=True)
class Wire:
    """A pin's or an address's ``kind``, which of its kind, and its factor."""

    kind: str
    place: int
    number: int = 0
    factor: float = 1.0
    at: str = ""
    """Of a part: ``address``, ``pin`` or ``uart``."""
    more: tuple[int, ...] = ()
    """A part's pins besides the first."""

    def taken(self) -> set[tuple[str, int]]:
        """Return the places that it takes, by what they are."""
        return {(self.at or "pin", place) for place in (self.place, *self.more)}

    def __str__(self) -> str:
        place = (
            f"0x{self.place:02x}" if self.at == "address" else f"{self.at or 'pin'} {self.place}"
        )
        return f"{place}: {self.kind} {self.number or ''}".rstrip()


def read_wires(text: str, mcu: Mcu = MCUS["atmega2560"]) -> list[Wire]:
    """Return the wires of ``9 servo 1; A0 vane 5; 2 anemometer 0.9; 0x68 mpu6050``.

    Raises InputError for a kind, pin, address or number that cannot be, or a pin used twice.
    """
    wires: list[Wire] = []
    for part in filter(None, (each.strip() for each in text.split(";"))):
        wire = _wire(part, mcu)
        if any(w.taken() & wire.taken() for w in wires):
            raise InputError(f"wires: {part!r}: this place is used twice")
        if not wire.at and any((w.kind, w.number) == (wire.kind, wire.number) for w in wires):
            raise InputError(f"wires: {part!r}: there is a {wire.kind} {wire.number or ''} already")
        wires.append(wire)
    return wires


def check_wires(text: str) -> None:
    """Raise InputError, the first board's, for wires that no board can have."""
    errors = []
    for mcu in MCUS.values():
        try:
            read_wires(text, mcu)
        except InputError as error:
            errors.append(error)
        else:
            return
    raise errors[0]


def _wire(part: str, mcu: Mcu) -> Wire:
    place, kind, *more = part.split() if " " in part else (part, "")
    if kind not in (*_NUMBERED, *_FACTORS) and not is_part(kind):
        known = [*_NUMBERED, *_FACTORS, *part_names()]
        raise InputError(f"wires: {part!r}: {unknown('kind', kind, known)}")
    if len(more) > 1:
        raise InputError(f"wires: {part!r} has too many words: PLACE KIND NUMBER is needed")
    try:
        if is_part(kind):
            return _part(kind, place, int(more[0]) if more else 0, mcu)
        at = mcu.pin(place)
        if kind in _ANALOG:
            mcu.channel(at)
        if kind in _FACTORS:
            return Wire(kind, at, 0, float(more[0]) if more else _FACTORS[kind])
        return Wire(kind, at, _within(int(more[0]), 1, _NUMBERED[kind]))
    except (ValueError, IndexError) as error:
        raise InputError(f"wires: {part!r} is not 'PLACE {kind} NUMBER': {error}") from None


def _part(kind: str, place: str, number: int, mcu: Mcu) -> Wire:
    """Return the wire of a part: at an address of I2C, at pins, or at a UART."""
    known = known_part(kind)
    if known is not None and known.address != place.lower().startswith("0x"):
        wanted = "an address, as 0x68" if known.address else "a pin"
        raise ValueError(f"{wanted} is needed, not {place!r}")
    if place.lower().startswith("0x"):
        return Wire(kind, _within(int(place, 16), 0x08, 0x77), number, at="address")
    if place.startswith("uart"):
        return Wire(kind, _within(int(place[4:]), 0, UARTS - 1), number, at="uart")
    first, *others = (mcu.pin(each) for each in place.split(","))
    if known is not None and 1 + len(others) != known.pins:
        raise ValueError(f"{known.pins} pins are needed, with commas between, not {place!r}")
    return Wire(kind, first, number, at="pin", more=tuple(others))


def _within(value: int, least: int, most: int) -> int:
    if not least <= value <= most:
        raise ValueError(f"{value} is not in {least} to {most}")
    return value


def read_uarts(text: str) -> dict[int, int]:
    """Return the baud rates of ``0 115200; 1 38400``, by UART. Raises InputError."""
    rates: dict[int, int] = {}
    for part in filter(None, (each.strip() for each in text.split(";"))):
        try:
            uart, rate = (int(word) for word in part.split())
            rates[_within(uart, 0, UARTS - 1)] = _within(rate, 300, 2_000_000)
        except ValueError:
            raise InputError(f"uarts: {part!r} is not 'UART BAUD', such as '1 38400'") from None
    return rates


def read_links(text: str, key: str = "links") -> dict[int, str]:
    """Return the URL of each UART. Raises InputError for a ``key`` that is not UART=URL."""
    found: dict[int, str] = {}
    for link in text.split():
        uart, _, url = link.partition("=")
        if not (uart.isdecimal() and int(uart) < UARTS and url):
            raise InputError(
                f"{key}: {link!r} is not UART=URL, as 0=serial:/dev/ttyACM0:115200 or 0=pty:/tmp/0"
            )
        if int(uart) in found:
            raise InputError(f"{key}: {link!r}: UART {uart} has a link already")
        try:
            check_urls(url)
        except InputError as error:
            raise InputError(f"{key}: {error}") from None
        found[int(uart)] = url
    return found


def read_monitors(text: str) -> dict[int, str]:
    """`read_links` of the key ``monitors``."""
    return read_links(text, "monitors")


def open_links(text: str, key: str = "links") -> dict[int, Endpoint]:
    """Open the links of a text. Raises InputError, and leaves none open, if one cannot be."""
    links = read_links(text, key)
    ports = open_endpoints(key, " ".join(links.values()))
    for port in ports:
        port.budget = Budget.of_raw_bytes()
    return dict(zip(links, ports, strict=True))
