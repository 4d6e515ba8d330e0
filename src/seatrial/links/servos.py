"""Output channels: which actuator each drives, with which pulses."""

from __future__ import annotations

from dataclasses import dataclass

from seatrial.errors import InputError

_MOST_CHANNELS = 32


@dataclass(frozen=True)
class Servo:
    """An actuator on an output channel: its name, and its pulses in us."""

    name: str
    pulse_min: float
    pulse_neutral: float
    pulse_max: float
    reversed: bool


def read_servos(text: str) -> dict[int, Servo]:
    """Return the actuators by channel of ``CHANNEL NAME MIN NEUTRAL MAX; ...``, pulses in us.

    The word ``reversed`` may follow. Raises InputError for one that is written otherwise.
    """
    servos: dict[int, Servo] = {}
    for entry in text.split(";"):
        if entry.strip():
            channel, servo = _servo(entry.split())
            servos[channel] = servo
    return servos


def _servo(words: list[str]) -> tuple[int, Servo]:
    try:
        number, name, *written = words
        pulses = [float(pulse) for pulse in written[:3]]
        least, neutral, most = pulses
        channel = int(number)
        if not 1 <= channel <= _MOST_CHANNELS or not 0.0 < least < neutral < most < 1e4:
            raise ValueError
        if written[3:] not in ([], ["reversed"]):
            raise ValueError
    except ValueError:
        raise InputError(
            f"actuator {' '.join(words)!r}: a channel from 1 to {_MOST_CHANNELS}, a name and three "
            "rising pulses in us are needed, then perhaps 'reversed'"
        ) from None
    return channel, Servo(name, least, neutral, most, len(written) == 4)
