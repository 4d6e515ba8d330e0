"""Rangefinder of a drone that measures down to a deck, or to the water beside it."""

from __future__ import annotations

from collections.abc import Sequence
from typing import ClassVar

from seatrial.devices.sensor import Measured, Sensor, Value
from seatrial.model.component import Input, Parameter, terminal
from seatrial.physics.craft.kinematics import to_body, to_ned


class DeckRange(Sensor):
    """Distance from a drone along its body z to the deck of a craft, or to still water.

    With o the sensor's place (``place`` in body axes, from the CG) and d the drone's z axis, both
    in the deck's axes, c the height of ``pad`` along the deck's z, and the same in {n}:

        distance = (c - o_z) / d_z     where o + distance d is within ``deck_size``
        distance = -n_z / e_z          else, n and e of the sensor and its axis in {n}: to z = 0

    m, the nearer of both; ``deck_size`` is about the origin. A range outside of ``range_min`` to
    ``range_max`` is not measured, nor anything while the axis does not point down. The errors
    are those of `Sensor`.

    Defaults: Benewake TF03-100: 0.1 to 100 m, 1 cm of resolution, 100 Hz; noise assumed.

    Not modelled: waves beside the deck, width of the beam, water that reflects little.
    """

    exercised: ClassVar = {
        "position": [0.1, 0.2, -3.0],
        "attitude": [0.1, -0.05, 0.4],
        "deck_attitude": [0.02, 0.03, 0.4],
    }

    period = Parameter(0.01, "s", "sample period", min=1e-6)
    place = Parameter((0.0, 0.0, 0.1), "m", "sensor from the CG, body axes", axes="xyz")
    range_min = Parameter(0.1, "m", "least distance measured", min=0.0)
    range_max = Parameter(100.0, "m", "greatest distance measured", min=0.0)
    pad = Parameter((0.0, 0.0, -0.2), "m", "landing point from the craft's origin", axes="xyz")
    deck_size = Parameter(
        (1.276, 1.0), "m", "length and breadth of the deck about the origin", axes="xy", min=0.0
    )

    position = Input("m", "CG of the drone in north-east-down", axes="xyz", frame="n")
    attitude = Input("rad", "Euler angles of the drone, ZYX", axes=("phi", "theta", "psi"))
    deck_position = Input("m", "origin of the craft in {n}", axes="xyz", frame="n")
    deck_attitude = Input("rad", "Euler angles of the craft", axes=("phi", "theta", "psi"))

    distance = Measured(
        "m",
        "distance from the sensor along the drone's z",
        span=(0.0, 100.0),
        noise=0.01,
        resolution=0.01,
    )

    terminals: ClassVar = {
        "motion": terminal("position", "attitude"),
        "deck": terminal(position="deck_position", attitude="deck_attitude"),
    }

    def measure(self) -> Sequence[Value]:
        """Return the distance of the deck or the water, whichever is met first."""
        axis = to_ned(self.attitude, (0.0, 0.0, 1.0))
        arm = to_ned(self.attitude, self.place)
        sensor = [p + a for p, a in zip(self.position, arm, strict=True)]
        found = -sensor[2] / axis[2] if axis[2] > 1e-6 else self.range_max + 1.0
        away = [s - d for s, d in zip(sensor, self.deck_position, strict=True)]
        o, d = to_body(self.deck_attitude, away), to_body(self.deck_attitude, axis)
        if d[2] > 1e-6:
            deck = (self.pad[2] - o[2]) / d[2]
            ahead, aside = o[0] + deck * d[0], o[1] + deck * d[1]
            over = 2.0 * abs(ahead) <= self.deck_size[0] and 2.0 * abs(aside) <= self.deck_size[1]
            if over and deck >= 0.0:
                found = min(found, deck)
        return [found if self.range_min <= found <= self.range_max else None]
