"""Doppler velocity log with four beams."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from typing import Any, ClassVar

import numpy as np

from seatrial.devices.sensor import ALWAYS_THERE, Derived, Measured, Value, full_circle, half_circle
from seatrial.model.component import Input, Parameter, seconds, terminal
from seatrial.physics.craft.kinematics import Vector3, cross, to_body, to_ned
from seatrial.physics.sea.parameters import MeetsCurrent

from .seabed.vectors import dot
from .sounding import Sounding

_DEG = math.radians(1.0)
_BEAMS = tuple(f"b{number}" for number in range(1, 5))
_LEAST_BEAMS = 3
"""A velocity has three components."""
_UVW = ("u", "v", "w")
_NOTHING: tuple[None, ...] = (None, None, None)


class Dvl(MeetsCurrent, Sounding):
    """Velocity over the bottom and through the water from the Doppler shift of four beams.

    A Janus array that looks down: beam i has the direction, in body axes,

        b_i = (sin a cos(c + (2 i - 1) 45 deg), sin a sin(c + (2 i - 1) 45 deg), cos a)

    with a = ``beam_angle`` and c = ``mounting``, and measures, with the errors of `Sensor`,

        range_i  = distance to bottom or obstacle along b_i                       m
        bottom_i = b_i . (velocity + rates x place)                               m/s
        water_i  = b_i . (velocity + rates x place - R^T current)                 m/s

    all times ``assumed_sound_speed / sound_speed``. The trial's current at the depth of the
    transducer comes to ``current``. ``velocity_b`` and ``water_velocity_b`` are
    the least-squares solutions of the beams that are valid, three at least; one beam's noise s
    makes s / (sqrt(2) sin a) ahead and abeam and s / (2 cos a) down. ``altitude`` is the mean
    range times cos a. ``velocity_n`` turns the velocity by ``orientation``, which is what the
    DVL's own attitude sensor measures. They are of the transducer, not of the body origin.

    A beam is valid for the bottom if its range is from ``range_min`` to ``range_max``, and for
    the water if there is no bottom up to ``water_far``, the end of the layer that it listens to.
    None is valid with the array more than ``tilt_max`` off the vertical, faster than
    ``speed_max``, or out of the water.

    Defaults: Water Linked A50, as its maker has it: 0.05 to 50 m, 1500 m/s, water track from a
    layer that ends 4.5 m away. Assumed: beams at 22.5 degrees, 5 Hz, 3.75 m/s, noise of a beam
    5 mm/s (10 mm/s in the water), tilt of up to 45 degrees, ranges to 1 % of 5 m, attitude to
    0.2 degrees and heading to 1 degree, delay 0.1 s.

    Not modelled: width of a beam, bottom that moves, waves, shear within the layer, bias of water
    track by the bottom, a rate that depends on the altitude.
    """

    exercised: ClassVar = {
        "seabed_depth": 7.0,
        "seabed_slope": 0.2,
        "place": [0.2, 0.1, 0.3],
        "dropout": 0.1,
        "water_far": 2.0,
        "tilt_max": 1.5,
    }

    period = Parameter(0.2, "s", "sample period", min=1e-6)
    delay = Parameter(0.1, "s", "time from measurement to output", min=0.0)
    beam_angle = Parameter(
        22.5 * _DEG, "rad", "angle of the beams with the array's axis", min=0.01, max=1.5
    )
    mounting = Parameter(0.0, "rad", "angle by which the array is turned, to starboard")
    range_min = Parameter(0.05, "m", "least range", min=0.0)
    range_max = Parameter(50.0, "m", "greatest range", min=0.0)
    water_far = Parameter(4.5, "m", "range at which the layer of water track ends", min=0.0)
    tilt_max = Parameter(45.0 * _DEG, "rad", "greatest tilt", min=0.0, max=3.2)
    speed_max = Parameter(3.75, "m/s", "greatest speed", min=0.0)

    velocity = Input("m/s", "velocity of the body origin, body axes", axes=_UVW)
    rates = Input("rad/s", "angular velocity, body axes", axes=("p", "q", "r"))
    current = Input(
        "m/s",
        "velocity of the water over ground, {n}",
        axes=("north", "east", "down"),
        optional=True,
    )

    ranges = Measured(
        "m", "range of each beam", axes=_BEAMS, span=(0.0, 50.0), noise=0.05, validity="axes"
    )
    bottom = Measured(
        "m/s",
        "velocity along each beam over the bottom",
        axes=_BEAMS,
        span=(-3.75, 3.75),
        noise=0.005,
        resolution=1e-4,
        validity="axes",
    )
    water = Measured(
        "m/s",
        "velocity along each beam through the water",
        axes=_BEAMS,
        span=(-3.75, 3.75),
        noise=0.01,
        resolution=1e-4,
        validity="axes",
    )
    orientation = Measured(
        "rad",
        "Euler angles by its own attitude sensor",
        axes=("phi", "theta", "psi"),
        span=((-math.pi, -math.pi / 2, 0.0), (math.pi, math.pi / 2, math.tau)),
        noise=0.1 * _DEG,
        instability=(0.2 * _DEG, 0.2 * _DEG, _DEG),
    )
    velocity_b = Derived(
        "m/s", "velocity over ground of the transducer, body axes", axes=_UVW, validity="whole"
    )
    water_velocity_b = Derived(
        "m/s",
        "velocity through the water of the transducer, body axes",
        axes=_UVW,
        validity="whole",
    )
    velocity_n = Derived(
        "m/s",
        "velocity over ground of the transducer, {n}",
        axes=("north", "east", "down"),
        validity="whole",
    )
    altitude = Derived("m", "distance to the bottom along the array's axis", validity="whole")

    _MOVING: ClassVar = ("position", "attitude", "velocity", "rates", "fault")
    terminals: ClassVar = {
        "motion": terminal("position", "attitude", "velocity", "rates"),
        "reading": terminal(
            "velocity_n", water_depth="altitude", water_depth_valid="altitude_valid"
        ),
    }
    feedthrough: ClassVar = {
        **ALWAYS_THERE,
        **dict.fromkeys(
            ("ranges", "ranges_valid", "bottom", "bottom_valid", "altitude", "altitude_valid"),
            _MOVING,
        ),
        **dict.fromkeys(
            ("velocity_b", "velocity_b_valid", "velocity_n", "velocity_n_valid"), _MOVING
        ),
        **dict.fromkeys(("water_valid", "water_velocity_b_valid"), _MOVING),
        "orientation": ("attitude", "fault"),
    }

    transient = Sounding.transient | {"_stream"}

    def reset(self, t: float) -> None:
        """Start with nothing published. Raises InputError for a current that cannot be."""
        super().reset(t)
        self._stream = self.current_state()

    def set_state(self, state: Mapping[str, Any]) -> None:
        """Restore what `get_state` returned."""
        super().set_state(state)
        self._stream = self.current_state()

    def beams(self) -> list[Vector3]:
        """Return the directions of the beams, body axes."""
        a, c = self.beam_angle, self.mounting
        turns = (c + (2 * i - 1) * math.pi / 4 for i in range(1, 5))
        return [
            (math.sin(a) * math.cos(turn), math.sin(a) * math.sin(turn), math.cos(a))
            for turn in turns
        ]

    def measure(self) -> Sequence[Value]:
        """Return range and velocities of each beam, and the attitude."""
        swing = cross(self.rates, self.place)
        over_ground = [v + s for v, s in zip(self.velocity, swing, strict=True)]
        carried = to_body(self.attitude, self._water())
        through = [v - c for v, c in zip(over_ground, carried, strict=True)]
        if not self._works(over_ground):
            return [*[None] * 12, *self.attitude]
        beams, origin, shown = self.beams(), self.transducer(), self.shown
        scene, reach = self.scene(), max(self.range_max, self.water_far)
        hits = [scene.ray(origin, self.turned(b), reach, surface=False) for b in beams]
        away = [math.inf if hit is None else hit.distance for hit in hits]
        seen = [self.range_min <= r <= self.range_max for r in away]
        return [
            *(shown * r if s else None for r, s in zip(away, seen, strict=True)),
            *(shown * dot(b, over_ground) if s else None for b, s in zip(beams, seen, strict=True)),
            *(
                shown * dot(b, through) if r > self.water_far else None
                for b, r in zip(beams, away, strict=True)
            ),
            *self.attitude,
        ]

    def finish(self, values: list[float]) -> list[float]:
        """Return phi in (-pi, pi] and psi in [0, 2 pi)."""
        *others, phi, theta, psi = values
        return [*others, half_circle(phi), theta, full_circle(psi)]

    def derive(self, values: Sequence[Value]) -> Sequence[Value]:
        """Return the velocities and the altitude from the beams that are valid."""
        ranges = [r for r in values[:4] if r is not None]
        over_ground, through = self._solved(values[4:8]), self._solved(values[8:12])
        attitude = [angle or 0.0 for angle in values[12:]]
        turned = None if over_ground is None else to_ned(attitude, over_ground)
        return [
            *(over_ground or _NOTHING),
            *(through or _NOTHING),
            *(turned or _NOTHING),
            math.cos(self.beam_angle) * sum(ranges) / len(ranges) if ranges else None,
        ]

    def _water(self) -> list[float]:
        """Return the velocity of the water at the transducer, {n}, m/s."""
        north, east, down = self.current
        if self._stream.is_absent:
            return [north, east, down]
        stream = self._stream.velocity(seconds(self._instant_ns()), self.transducer()[2])
        return [north + float(stream[0]), east + float(stream[1]), down]

    def _works(self, velocity: Sequence[float]) -> bool:
        """Return whether any beam can be valid with the transducer's pose and speed."""
        upright = self.turned((0.0, 0.0, 1.0))[2]
        submerged = self.transducer()[2] >= 0.0
        tilt = math.acos(min(max(upright, -1.0), 1.0))
        return submerged and tilt <= self.tilt_max and math.hypot(*velocity) <= self.speed_max

    def _solved(self, along: Sequence[Value]) -> list[float] | None:
        """Return the velocity by least squares, None with too few beams."""
        rows = [(b, v) for b, v in zip(self.beams(), along, strict=True) if v is not None]
        if len(rows) < _LEAST_BEAMS:
            return None
        matrix = np.array([b for b, _ in rows])
        found: list[float] = np.linalg.lstsq(matrix, np.array([v for _, v in rows]))[0].tolist()
        return found
