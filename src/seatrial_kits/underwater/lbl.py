"""Positioning of a vehicle by its ranges to transponders on the bottom: LBL."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import ClassVar

import numpy as np

from seatrial.devices.sensor import Derived, Measured, Sensor, Value
from seatrial.errors import InputError
from seatrial.model.component import NS, Input, Parameter, terminal
from seatrial.physics.craft.kinematics import Vector3, to_ned

COUNT = 6
"""Most transponders."""
_EACH = tuple(f"r{number}" for number in range(1, COUNT + 1))
_NED = ("north", "east", "down")
_NOTHING: tuple[Value, ...] = (None, None, None)
_LEAST = 3
"""Ranges that a place in the plane needs, without a guess of the side."""
_ITERATIONS = 8


class Lbl(Sensor):
    """Long baseline: the vehicle asks, up to six transponders at known places answer.

        range_i = (assumed_sound_speed / sound_speed) |transponder_i - transducer|    m
        depth   = depth of the transducer                                              m

    with the errors of `Sensor`. ``position_n`` is the place at that depth that fits the ranges
    best, by least squares in north and east; it needs three ranges at least, to transponders that
    are not in one line. ``transponders`` says how many of ``transponder_1`` ... there are.

    With probability ``outlier`` a range is that of a reflection, up to ``outlier_range`` too
    long, drawn for each. A measurement arrives when the farthest answer has and ``delay`` is
    over. Beyond ``range_max``, and out of the water, nothing answers; that is known when the
    time for the farthest is over.

    Defaults, all assumed: a net at some 10 kHz, 2 km, every 5 s, with 0.3 m of noise; depth to
    5 cm.

    Not modelled: rays that bend, answers that collide, motion while the sound travels.
    """

    exercised: ClassVar = {
        "transponders": 4.0,
        "transponder_1": [5.0, 0.0, 9.0],
        "transponder_2": [-5.0, 2.0, 8.0],
        "transponder_3": [0.0, 7.0, 9.0],
        "transponder_4": [1.0, -6.0, 7.0],
        "outlier": 0.2,
        "outlier_range": 1.0,
        "place": [0.2, 0.1, 0.3],
    }

    period = Parameter(5.0, "s", "time from question to question", min=1e-6)
    delay = Parameter(0.1, "s", "time from the last answer to the output", min=0.0)
    place = Parameter(0.0, "m", "transducer from the body origin, body axes", axes="xyz")
    sound_speed = Parameter(1500.0, "m/s", "mean speed of sound on the way", min=1.0)
    assumed_sound_speed = Parameter(1500.0, "m/s", "speed that the vehicle is set to", min=1.0)
    range_max = Parameter(2000.0, "m", "greatest range", min=0.0)
    outlier = Parameter(0.0, "1", "probability of a reflection", min=0.0, max=1.0)
    outlier_range = Parameter(50.0, "m", "most that a reflection is too long", min=0.0)
    transponders = Parameter(0.0, "1", "number of transponders", min=0.0, max=COUNT)
    transponder_1 = Parameter(0.0, "m", "place of transponder 1, north-east-down", axes=_NED)
    transponder_2 = Parameter(0.0, "m", "place of transponder 2, north-east-down", axes=_NED)
    transponder_3 = Parameter(0.0, "m", "place of transponder 3, north-east-down", axes=_NED)
    transponder_4 = Parameter(0.0, "m", "place of transponder 4, north-east-down", axes=_NED)
    transponder_5 = Parameter(0.0, "m", "place of transponder 5, north-east-down", axes=_NED)
    transponder_6 = Parameter(0.0, "m", "place of transponder 6, north-east-down", axes=_NED)

    position = Input("m", "body origin in north-east-down", axes="xyz", frame="n")
    attitude = Input("rad", "Euler angles, ZYX", axes=("phi", "theta", "psi"))

    ranges = Measured(
        "m", "range to each transponder", axes=_EACH, span=(0.0, 2000.0), noise=0.3, validity="axes"
    )
    depth = Measured("m", "depth of the transducer", span=(0.0, 300.0), noise=0.05)
    position_n = Derived(
        "m", "position of the transducer, north-east-down", axes=_NED, validity="whole"
    )

    # Sound takes its time: nothing arrives at the instant of the question.
    feedthrough: ClassVar = dict.fromkeys(
        ("valid", "count", "ranges", "ranges_valid", "depth", "position_n", "position_n_valid"), ()
    )
    terminals: ClassVar = {
        "motion": terminal("position", "attitude"),
        "reading": terminal("position_n", position_valid="position_n_valid"),
    }

    def reset(self, t: float) -> None:
        """Raise InputError for a number of transponders that is not whole."""
        if self.transponders % 1.0:
            raise InputError(
                f"{self.name}.transponders is {self.transponders!r}, a whole number is needed"
            )
        super().reset(t)

    def measure(self) -> Sequence[Value]:
        """Return the ranges and the depth."""
        away, shown = self._away(), self.assumed_sound_speed / self.sound_speed
        if all(r is None for r in away):
            return [None] * (COUNT + 1)
        late = [0.0] * COUNT
        if self.outlier:
            drawn = self.generator(self._next, 2).random((COUNT, 2)).tolist()
            late = [self.outlier_range * far if u < self.outlier else 0.0 for u, far in drawn]
        ranges = [None if r is None else shown * r + x for r, x in zip(away, late, strict=True)]
        return [*ranges, self._transducer()[2]]

    def derive(self, values: Sequence[Value]) -> Sequence[Value]:
        """Return the place at the depth measured that fits the ranges best."""
        *ranges, depth = values
        known = [
            (place, r) for place, r in zip(self._places(), ranges, strict=False) if r is not None
        ]
        if depth is None or len(known) < _LEAST:
            return _NOTHING
        fixed = np.array([place for place, _ in known])
        found = _fitted(fixed, np.array([r for _, r in known]), depth)
        return _NOTHING if found is None else [*found, depth]

    def travel_ns(self) -> int:
        """Return the time until the farthest answer, or after which none is waited for, ns."""
        away = [r for r in self._away() if r is not None]
        taken: int = round(NS * 2.0 * max(away, default=self.range_max) / self.sound_speed)
        return taken

    def _transducer(self) -> Vector3:
        arm = to_ned(self.attitude, self.place)
        x, y, z = (p + a for p, a in zip(self.position, arm, strict=True))
        return (x, y, z)

    def _places(self) -> list[tuple[float, ...]]:
        every = range(1, int(self.transponders) + 1)
        return [getattr(self, f"transponder_{number}") for number in every]

    def _away(self) -> list[Value]:
        """Return the distance of each transponder that answers, m."""
        own = self._transducer()
        distances = [math.dist(place, own) for place in self._places()]
        found = [r if r <= self.range_max and own[2] >= 0.0 else None for r in distances]
        return [*found, *[None] * (COUNT - len(found))]


def _fitted(fixed: np.ndarray, ranges: np.ndarray, depth: float) -> list[float] | None:
    """Return north and east by Gauss-Newton; None if the transponders are in one line.

    It begins at the solution of the differences of squared ranges, which are linear.
    """
    level = np.sqrt(np.maximum(0.0, ranges**2 - (fixed[:, 2] - depth) ** 2))
    plane = fixed[:, :2]
    apart = 2.0 * (plane[1:] - plane[0])
    squares = (plane[1:] ** 2).sum(1) - (plane[0] ** 2).sum() - level[1:] ** 2 + level[0] ** 2
    place, _, rank, _ = np.linalg.lstsq(apart, squares, rcond=1e-9)
    if rank < 2:
        return None
    for _ in range(_ITERATIONS):
        away = np.column_stack([place - plane, depth - fixed[:, 2]])
        distances = np.maximum(1e-9, np.sqrt((away**2).sum(1)))
        towards = away[:, :2] / distances[:, None]
        place = place + np.linalg.lstsq(towards, ranges - distances, rcond=1e-9)[0]
    found: list[float] = place.tolist()
    return found
