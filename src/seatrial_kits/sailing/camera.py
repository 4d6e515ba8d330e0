"""Camera whose image a detector searches for buoys and obstacles."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any, ClassVar, NamedTuple

from seatrial.devices.sensor import ALWAYS_THERE, Derived, Measured, Sensor, Value, half_circle
from seatrial.model.component import Input, Parameter, terminal
from seatrial.model.waypoints import NED
from seatrial.physics.craft.kinematics import to_body, to_ned

TARGETS = SLOTS = 6
"""What it may see, and how many detections of a frame it reports."""
NOTHING, BUOY, OBSTACLE = range(3)
"""Kinds of what is detected."""
EXTINCTION = 3.912
"""Koschmieder: at the visibility, contrast is 2 %, exp(-3.912) of itself."""
_DEG = math.radians(1.0)
_NUMBERS = range(1, TARGETS + 1)
_SLOTS = tuple(f"d{number}" for number in range(1, SLOTS + 1))


class _Targets:
    """Inputs of the targets by number: position_1, diameter_1, kind_1 ...; reading gives all."""

    def __set_name__(self, owner: type, name: str) -> None:
        self._name = name
        for n in _NUMBERS:
            ports = {
                f"position_{n}": Input("m", f"middle of target {n}", axes=NED, optional=True),
                f"diameter_{n}": Input("m", f"diameter of target {n}, 0 for none", optional=True),
                f"kind_{n}": Input(
                    "1", f"kind of target {n}: 1 buoy, 2 obstacle", type=int, start=1, optional=True
                ),
            }
            for key, port in ports.items():
                port.__set_name__(owner, key)
                setattr(owner, key, port)

    def __get__(self, component: Any, owner: type | None = None) -> Any:
        if component is None:
            return self
        return [
            tuple(getattr(component, f"{part}_{n}") for part in ("position", "diameter", "kind"))
            for n in _NUMBERS
        ]


class Detection(NamedTuple):
    """Something in a frame: bearing and apparent size, rad, and its kind."""

    bearing: float
    size: float
    kind: int


class Camera(Sensor):
    """Detector of spheres in the images of a camera that is fixed to the body.

    Every ``period`` a frame. A target of diameter D at r, a vector from the lens (``place``, body
    axes) in body axes, has

        bearing   = atan2(r_y, r_x), from the bow to starboard               rad
        elevation = atan2(-r_z, sqrt(r_x^2 + r_y^2))                         rad
        size      = 2 asin(D / (2 |r|)), its apparent diameter               rad

    It is detected, with probability ``detection`` in each frame, if its bearing is within ``width``
    / 2 of ``direction`` and its elevation within ``height`` / 2, its size is ``size_min`` or more,
    and its contrast in the haze

        contrast exp(-3.912 |r| / visibility) >= contrast_min                (Koschmieder's law)

    so up to |r| = visibility ln(contrast / contrast_min) / 3.912. With probability
    ``false_detection`` a frame has one that is nothing: uniform in bearing over the field of view,
    in size from ``size_min`` to ``false_size``, a buoy or an obstacle alike.

    Detections are in the order of their true size, the largest first, the others of the axes not
    valid; ``detected`` is how many there are, ``kind`` what each is (1 buoy, 2 obstacle, 0 none).
    The errors of `Sensor` act on bearing and size of a detection. A frame without a detection is
    a measurement like any other: ``count`` goes on.

    Defaults, all assumed: a small camera of 75 by 47 degrees in 320 by 200 pixels (a pixel is 0.23
    degrees: noise of the bearing; a blob has two at least), 5 frames a second of which 90 % have a
    target that can be seen, one in 100 something that is none, contrast 0.5 over a threshold of
    0.05.

    Not modelled: images, lens distortion, glare, waves in front of a target, one target behind
    another, shapes, colours that are mistaken, false detections that stay from frame to frame.
    """

    empty_is_lost: ClassVar = False
    exercised: ClassVar = {
        "width": 6.0,
        "height": 3.0,
        "detection": 0.8,
        "false_detection": 0.3,
        "place": [0.2, 0.1, -0.3],
        "visibility": 50.0,
    }

    period = Parameter(0.2, "s", "time from frame to frame", min=1e-6)
    place = Parameter(0.0, "m", "lens from the body origin, body axes", axes="xyz")
    direction = Parameter(0.0, "rad", "middle of the field of view, from the bow to starboard")
    width = Parameter(75.0 * _DEG, "rad", "field of view, horizontal", min=0.0, max=math.tau)
    height = Parameter(47.0 * _DEG, "rad", "field of view, vertical", min=0.0, max=math.pi)
    size_min = Parameter(0.46 * _DEG, "rad", "least size that is detected", min=0.0)
    detection = Parameter(
        0.9, "1", "probability that a target in sight is detected", min=0.0, max=1.0
    )
    false_detection = Parameter(
        0.01, "1", "probability that a frame has a detection of nothing", min=0.0, max=1.0
    )
    false_size = Parameter(5.0 * _DEG, "rad", "largest size of one of nothing", min=0.0)
    contrast = Parameter(0.5, "1", "of targets against their background", min=0.0, max=1.0)
    contrast_min = Parameter(0.05, "1", "least contrast that is detected", min=1e-6, max=1.0)

    position = Input("m", "body origin in north-east-down", axes="xyz", frame="n")
    attitude = Input("rad", "Euler angles, ZYX", axes=("phi", "theta", "psi"))
    visibility = Input("m", "meteorological visibility", start=10000.0, optional=True)
    targets = _Targets()

    bearing = Measured(
        "rad",
        "bearing of each detection from the bow, to starboard positive",
        axes=_SLOTS,
        span=(-math.pi, math.pi),
        noise=0.23 * _DEG,
        validity="axes",
    )
    size = Measured(
        "rad", "apparent diameter of each detection", axes=_SLOTS, span=(0.0, 1.0), noise=0.1 * _DEG
    )
    kind = Derived("1", "kind of each detection: 1 buoy, 2 obstacle, 0 none", type=int, axes=_SLOTS)
    detected = Derived("1", "number of detections in the frame", type=int)

    terminals: ClassVar = {
        "motion": terminal("position", "attitude"),
        "sightings": terminal(
            "bearing", "size", "kind", "detected", frame="count", sight_valid="valid"
        ),
        **{
            f"target_{n}": terminal(
                position=f"position_{n}", diameter=f"diameter_{n}", kind=f"kind_{n}"
            )
            for n in _NUMBERS
        },
    }
    _SEEN = (
        *("position", "attitude", "visibility", "fault"),
        *(f"{part}_{n}" for n in _NUMBERS for part in ("position", "diameter")),
    )
    feedthrough: ClassVar = {
        **ALWAYS_THERE,
        **dict.fromkeys(("bearing", "bearing_valid", "size", "detected"), _SEEN),
    }

    def measure(self) -> Sequence[Value]:
        """Return bearings and sizes of what this frame has."""
        found = self._frame()
        lacking: list[Value] = [None] * (SLOTS - len(found))
        return [
            *(each.bearing for each in found),
            *lacking,
            *(each.size for each in found),
            *lacking,
        ]

    def finish(self, values: list[float]) -> list[float]:
        """Return bearings in (-pi, pi] and sizes that are not negative."""
        bearings, sizes = values[:SLOTS], values[SLOTS:]
        return [*map(half_circle, bearings), *(max(0.0, size) for size in sizes)]

    def derive(self, values: Sequence[Value]) -> Sequence[Value]:
        """Return the kinds of what this frame has, and how many there are."""
        kinds = [each.kind for each in self._frame()]
        there = [value is not None for value in values[:SLOTS]]
        kinds = [*kinds, *[NOTHING] * (SLOTS - len(kinds))]
        return [
            *(kind if valid else NOTHING for kind, valid in zip(kinds, there, strict=True)),
            sum(there),
        ]

    # ------------------------------------------------------------------ inside

    def _frame(self) -> list[Detection]:
        """Return the detections of the frame of this instant, without errors of measurement."""
        draws = self.generator(self._next, 3).random(TARGETS + 4).tolist()
        seen = [self._sight(*target) for target in self.targets]
        found = [
            each
            for each, draw in zip(seen, draws[4:], strict=True)
            if each is not None and draw < self.detection
        ]
        there, where, how_large, what = draws[:4]
        if there < self.false_detection:
            bearing = self.direction + (where - 0.5) * self.width
            size = self.size_min + how_large * (self.false_size - self.size_min)
            found.append(Detection(half_circle(bearing), size, BUOY if what < 0.5 else OBSTACLE))
        found.sort(key=lambda each: -each.size)
        return found[:SLOTS]

    def _sight(self, position: Sequence[float], diameter: float, kind: int) -> Detection | None:
        """Return what is in the image of a target, None if it cannot be seen."""
        if diameter <= 0.0:
            return None
        lens = to_ned(self.attitude, self.place)
        away = [p - o - a for p, o, a in zip(position, self.position, lens, strict=True)]
        x, y, z = to_body(self.attitude, (away[0], away[1], away[2]))
        distance = math.hypot(x, y, z)
        if distance <= 0.5 * diameter:
            return None
        bearing, elevation = math.atan2(y, x), math.atan2(-z, math.hypot(x, y))
        size = 2.0 * math.asin(0.5 * diameter / distance)
        haze = math.exp(-EXTINCTION * distance / max(self.visibility, 1e-9))
        framed = (
            abs(math.remainder(bearing - self.direction, math.tau)) <= 0.5 * self.width
            and abs(elevation) <= 0.5 * self.height
        )
        if not framed or size < self.size_min or self.contrast * haze < self.contrast_min:
            return None
        return Detection(bearing, size, kind)
