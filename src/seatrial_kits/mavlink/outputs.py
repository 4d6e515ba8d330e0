"""Outputs of a vehicle: pulses by channel, and the throttle that they mean."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from seatrial.links.servos import Servo

SHARED = ("port", "starboard", "vertical")
"""Actuators whose commands may come as shares of full thrust in the place of pulses."""
_PROPELLING = ("throttle", "port", "starboard", "vertical")


class Outputs:
    """Outputs with actuators, ``servos``, by channel from 1; pulses in s, 0 for none."""

    def __init__(self, servos: Mapping[int, Servo]) -> None:
        self._servos = servos

    def pulses(self, measured: Sequence[float], shares: Mapping[str, float]) -> tuple[float, ...]:
        """Return the pulses as they are, or of ``shares`` of full thrust, if there are none."""
        if any(measured) or not any(shares.values()):
            return tuple(measured)
        found = list(measured)
        for channel, servo in self._servos.items():
            if servo.name in shares and channel <= len(found):
                found[channel - 1] = _pulse_us(servo, shares[servo.name]) * 1e-6
        return tuple(found)

    def throttle(self, pulses: Sequence[float]) -> float | None:
        """Return the mean share of full thrust ahead, 0 to 1; None without a propelling output.

        Outputs against each other, as those of a craft that turns on the spot, cancel out.
        """
        shares = [
            _share(servo, pulses[channel - 1] * 1e6)
            for channel, servo in self._servos.items()
            if servo.name in _PROPELLING and channel <= len(pulses) and pulses[channel - 1]
        ]
        return min(abs(sum(shares)) / len(shares), 1.0) if shares else None


def _travel_us(servo: Servo, share: float) -> float:
    return (
        servo.pulse_max - servo.pulse_neutral
        if share > 0.0
        else servo.pulse_neutral - servo.pulse_min
    )


def _pulse_us(servo: Servo, share: float) -> float:
    share = min(max(-share if servo.reversed else share, -1.0), 1.0)
    return servo.pulse_neutral + share * _travel_us(servo, share)


def _share(servo: Servo, pulse_us: float) -> float:
    away = pulse_us - servo.pulse_neutral
    return (-away if servo.reversed else away) / _travel_us(servo, away)
