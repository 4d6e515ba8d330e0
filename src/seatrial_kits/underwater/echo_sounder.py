"""Echo sounders: the distance of the first return within a cone."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import ClassVar

from seatrial.devices.sensor import Measured, Value, require_unit
from seatrial.model.component import Parameter, terminal

from .seabed.scene import first_return
from .sounding import Sounding

_DEG = math.radians(1.0)


class EchoSounder(Sounding):
    """Echo sounder on a boat: distance from the transducer to what its beam meets first.

        distance = (assumed_sound_speed / sound_speed) min |p - transducer|      m

    over the points p of bottom, obstacles and surface within the cone of ``beam_width`` about
    ``axis``, with the errors of `Sensor` on top. So on a slope, and as the boat rolls, it shows
    less than the depth below the transducer, down to the distance straight to the bottom. What
    is nearer than ``range_min`` or farther than ``range_max`` is not measured, nor is anything
    out of the water. ``axis`` is in body axes, a unit vector: down, unless another is given.

    Defaults, all assumed: a small transducer of a pleasure boat: 12 degrees, 0.5 to 100 m, 1 Hz,
    noise 5 cm, resolution 1 cm.

    Not modelled: time of travel, bottom that absorbs or penetrates, side lobes, bubbles,
    intensity: the first return is found, however weak.
    """

    exercised: ClassVar = {
        "seabed_depth": 6.0,
        "seabed_slope": 0.2,
        "place": [0.2, 0.1, 0.3],
        "beam_width": 0.1,
    }

    period = Parameter(1.0, "s", "sample period", min=1e-6)
    beam_width = Parameter(12.0 * _DEG, "rad", "full angle of the cone", min=0.0, max=3.0)
    axis = Parameter((0.0, 0.0, 1.0), "1", "direction of the beam, body axes", axes="xyz")
    range_min = Parameter(0.5, "m", "least distance measured", min=0.0)
    range_max = Parameter(100.0, "m", "greatest distance measured", min=0.0)

    distance = Measured(
        "m",
        "distance of the first return from the transducer",
        span=(0.0, 100.0),
        noise=0.05,
        resolution=0.01,
    )

    terminals: ClassVar = {
        "motion": terminal("position", "attitude"),
        "reading": terminal(water_depth="distance", water_depth_valid="valid"),
    }

    def reset(self, t: float) -> None:
        """Raise InputError for an axis that is no unit vector."""
        require_unit(self.name, "axis", self.axis)
        super().reset(t)

    def measure(self) -> Sequence[Value]:
        """Return the distance of the first return."""
        origin = self.transducer()
        if origin[2] < 0.0:
            return [None]
        half_angle, axis = 0.5 * self.beam_width, self.turned(self.axis)
        hit = first_return(self.scene(), origin, axis, half_angle, self.range_max)
        if hit is None or hit.distance < self.range_min:
            return [None]
        return [self.shown * hit.distance]


class Altimeter(EchoSounder):
    """Altimeter of an underwater vehicle: an `EchoSounder` with another data sheet.

    Defaults: Blue Robotics Ping, as its maker has it: beam width 25 degrees, to 100 m; from 0.5 m,
    10 Hz, noise and resolution of 2 cm (assumed).
    """

    period = Parameter(0.1, "s", "sample period", min=1e-6)
    beam_width = Parameter(25.0 * _DEG, "rad", "full angle of the cone", min=0.0, max=3.0)

    distance = Measured(
        "m",
        "distance of the first return from the transducer",
        span=(0.0, 100.0),
        noise=0.02,
        resolution=0.02,
    )
