"""DBC signal of a port: its unit, limits and start value."""

from __future__ import annotations

import re
from dataclasses import dataclass
from pathlib import Path

from cantools.database.can import Database, Message, Signal

from seatrial.errors import InputError
from seatrial.model.units import Unit, conversion, unit

from .database import find_signal, raw_range

_NUMBER = r"[-+]?(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?"
_ENTRY = re.compile(
    rf"(?P<name>\w+\.\w+)(?:\s+(?P<low>{_NUMBER})\s+(?P<high>{_NUMBER})(?:\s+(?P<unit>\S+))?)?"
)
_EXAMPLE = "'ThrusterCommand.PortPulse' or 'ThrusterCommand.PortPulse 1100 1900 us'"
LONGEST_SIGNAL = 64
"""Bits."""
_MARGIN = 1e-9
"""Share of a step of the scaling by which decimal numbers may seem to be beyond a limit."""


@dataclass(frozen=True)
class Mapped:
    """A signal whose value a port has in SI: value in SI = factor * physical value + offset."""

    message: Message
    signal: Signal
    factor: float
    offset: float
    low: float
    """Least physical value that the signal can have, and is allowed to."""
    high: float
    notes: tuple[str, ...] = ()
    """Oddities of the DBC that a user should know of."""

    @property
    def start(self) -> float:
        """Its GenSigStartValue in SI; physical 0, or what is nearest to it, without."""
        raw = self.signal.raw_initial
        physical = 0.0 if raw is None else float(self.signal.raw_to_scaled(raw, False))  # type: ignore[arg-type]
        return self.to_si(min(max(physical, self.low), self.high))

    def to_si(self, physical: float) -> float:
        """Return a physical value, as the DBC has it, in SI."""
        return self.factor * physical + self.offset

    def to_physical(self, value: float) -> tuple[float, bool]:
        """Return a value in SI as the DBC has it, within the limits; and whether it was beyond."""
        physical = (value - self.offset) / self.factor
        limited = min(max(physical, self.low), self.high)
        return limited, abs(physical - limited) > _MARGIN * abs(self.signal.scale)

    def to_raw(self, physical: float) -> float:
        """Return the number that the signal's bits have for a physical value within the limits."""
        least, most = raw_range(self.signal)  # the limits are rounded to doubles
        return min(max(self.signal.scaled_to_raw(physical), least), most)


def message_names(written: str) -> set[str]:
    """Return the messages of ``MESSAGE.SIGNAL ...; ...``; texts of another form have none."""
    parts = (part.strip() for part in written.split(";"))
    return {part.partition(".")[0] for part in parts if _ENTRY.fullmatch(part)}


def mapped_signals(path: Path, database: Database, written: str) -> list[Mapped]:
    """Return the signals that ``MESSAGE.SIGNAL [LOW HIGH UNIT]; ...`` names, one per port.

    LOW to HIGH is what the port will have, which the signal must be able to carry.

    Raises InputError, with the file, for a text of another form, a message or signal that the
    DBC does not have (near misses), one that is named twice, and a range beyond its limits. A unit
    that is none, and limits beyond the signal's bits, are notes.
    """
    found: list[Mapped] = []
    for text in filter(None, (part.strip() for part in written.split(";"))):
        match = _ENTRY.fullmatch(text)
        if match is None:
            raise InputError(f"{text!r} is not MESSAGE.SIGNAL [LOW HIGH UNIT], such as {_EXAMPLE}")
        message, signal = find_signal(path, database, match["name"])
        if any(signal is other.signal for other in found):
            raise InputError(f"{match['name']} is named twice")
        mapped = _mapped(path, message, signal)
        if match["low"]:
            _check_range(path, mapped, float(match["low"]), float(match["high"]), match["unit"])
        found.append(mapped)
    return found


def _mapped(path: Path, message: Message, signal: Signal) -> Mapped:
    name = f"{path}: signal {message.name}.{signal.name}"
    measure, notes = unit_of(signal.unit), []
    if measure is None:
        notes.append(f"{name}: {signal.unit!r} is not a unit: its port has the DBC's numbers")
        measure = unit("1")
    if signal.length > LONGEST_SIGNAL:
        raise InputError(f"{name} has {signal.length} bits, at most {LONGEST_SIGNAL} make a number")
    if not 1e-30 <= abs(signal.scale) <= 1e30 or not abs(signal.offset) <= 1e30:
        raise InputError(
            f"{name} has the scaling ({signal.scale:g},{signal.offset:g}); allowed are factors of "
            "1e-30 to 1e30 and offsets up to 1e30"
        )
    lowest, highest = _representable(signal)
    low = lowest if signal.minimum is None else max(lowest, float(signal.minimum))
    high = highest if signal.maximum is None else min(highest, float(signal.maximum))
    if _beyond(signal, lowest, highest):
        low, high = (low, high) if low <= high else (lowest, highest)
        notes.append(
            f"{name} has limits {signal.minimum:g} to {signal.maximum:g} {signal.unit or ''}, but "
            f"{signal.length} bits of {signal.scale:g} hold {lowest:g} to {highest:g}: it is "
            f"limited to {low:g} to {high:g}"
        )
    return Mapped(message, signal, measure.factor, measure.offset, low, high, tuple(notes))


def _beyond(signal: Signal, lowest: float, highest: float) -> bool:
    """Return whether the limits of a signal are beyond its bits, or the wrong way round."""
    if signal.minimum is None or signal.maximum is None:
        return False
    margin = _MARGIN * (highest - lowest) + abs(signal.scale)
    outside = signal.minimum < lowest - margin or signal.maximum > highest + margin
    return bool(outside or signal.minimum > signal.maximum)


def _representable(signal: Signal) -> tuple[float, float]:
    """Return the least and greatest physical value that the bits of a signal can have."""
    raw = raw_range(signal)
    # Rounded as decimals are written: 3 * 0.1 is no 0.30000000000000004 in a DBC.
    ends = sorted(float(f"{end * signal.scale + signal.offset:.12g}") for end in raw)
    return ends[0], ends[1]


def _check_range(path: Path, mapped: Mapped, low: float, high: float, written: str | None) -> None:
    signal = mapped.signal
    name = f"{path}: signal {mapped.message.name}.{signal.name}"
    try:
        of_signal = unit_of(signal.unit)
        if of_signal is None:
            unit(signal.unit)  # raises: a range in a unit cannot be compared
        factor, offset = conversion(written or "1", of_signal or "1")
    except InputError as error:
        raise InputError(f"{name}: {error}") from None
    margin = _MARGIN * abs(signal.scale)
    ends = factor * low + offset, factor * high + offset
    if not mapped.low - margin <= ends[0] <= ends[1] <= mapped.high + margin:
        raise InputError(
            f"{name} carries {mapped.low:g} to {mapped.high:g} {signal.unit or ''}, and is to "
            f"carry {low:g} to {high:g} {written or ''}"
        )


_MEANT = {"Nm": "N.m", "NM": "N.m", "C": "degC"}
"""Texts that are other units to physics: number metres, coulombs."""
_SPELLINGS = {
    spelling: name
    for name, spellings in {
        "bar": "bar",
        "deg": "deg, °, degree, degrees",
        "deg/s": "deg/s, °/s, º/s, degrees/s, deg/sec, degree/sec, degrees/sec",
        "degC": "degc, °c, ºc, deg c, degrees c, degreesc, celsius",
        "Hz": "hz",
        "km": "km",
        "km/h": "km/h, kph, kmh, km^h",
        "kPa": "kpa, kilopascal",
        "mbar": "mbar, millibar",
        "psi": "psi",
        "rpm": "rpm, r/min, 1/min",
        "mile/h": "mph",
        "m/s": "m/sec",
        "m/s2": "m/s^2, m/s²",
        "mm/s": "mm/sec",
        "V": "volt, volts",
        "A": "amp, amps, ampere",
        "W": "watt, watts",
        "kW": "kw",
        "m": "meter, meters, metre",
        "s": "sec, seconds, second",
        "us": "usec",
        "ms": "msec",
        "min": "minute, minutes",
        "h": "hour, hours",
        "%": "percent",
        "1": "unitless, -",
    }.items()
    for spelling in spellings.split(", ")
}
"""Spellings that are common in public files, by their small letters."""


def unit_of(written: str | None) -> Unit | None:
    """Return the unit of a signal, None if its text is none; without a text it is a number.

    A text is a unit as it is, or in one of `_SPELLINGS`: texts are written by hand.
    """
    text = (written or "1").strip()
    for each in (_MEANT.get(text, text), _SPELLINGS.get(text.lower(), "")):
        try:
            return unit(each) if each else None
        except InputError:
            continue
    return None
