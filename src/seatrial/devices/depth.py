"""Depth sensor."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, ClassVar

from ..model.component import Input, Parameter, seconds, terminal
from ..physics.craft.kinematics import to_ned
from ..physics.sea.parameters import MeetsWaves
from .sensor import ALWAYS_THERE, Measured, Sensor


class Depth(MeetsWaves, Sensor):
    """Depth from water pressure, at the sensor: m, positive down, from the surface at rest.

        depth = (density / assumed_density) max(0, z + (R place)_z + head)

    with the errors of `Sensor` on top: the pressure is density g d, and the instrument turns it
    into depth with the density it is set to. Out of the water it reads 0. ``place`` is the
    lever arm of the sensor from the body origin, body axes (x bow, y starboard, z down), m;
    z the depth of the body origin below the surface at rest. ``head`` is the dynamic pressure
    of the trial's waves over density g, as deep as the sensor is, with stretching
    (`Waves.motion`): it fades with depth, and at the surface it is the elevation.

    Defaults: Blue Robotics Bar30 (TE MS5837-30BA): resolution 0.2 mbar, 2 mm of water; noise of
    the same size; slow error 20 mm (assumed, after zeroing at the surface); 20 Hz, conversion
    time 20 ms. Its absolute accuracy before zeroing is +-200 mbar: set ``depth_bias``.
    Not modelled: pressure by the flow past the vehicle, temperature.
    """

    exercised: ClassVar = {"dropout": 0.2, "place": [0.2, 0.1, 0.3]}

    period = Parameter(0.05, "s", "sample period", min=1e-6)
    delay = Parameter(0.02, "s", "time from measurement to output", min=0.0)
    density = Parameter(1025.0, "kg/m3", "density of the water", min=0.0)
    assumed_density = Parameter(1025.0, "kg/m3", "density the instrument is set to", min=1e-6)
    place = Parameter(0.0, "m", "sensor from the body origin, body axes", axes="xyz")

    position = Input("m", "body origin in north-east-down", axes="xyz", frame="n")
    attitude = Input("rad", "Euler angles, ZYX", axes=("phi", "theta", "psi"))
    depth = Measured(
        "m",
        "depth of the sensor, positive down",
        span=(0.0, 300.0),
        noise=0.002,
        instability=0.02,
        resolution=0.002,
    )

    terminals: ClassVar = {
        "motion": terminal("position", "attitude"),
        "reading": terminal("depth", depth_valid="valid"),
    }
    feedthrough: ClassVar = ALWAYS_THERE

    transient = Sensor.transient | {"_waves"}

    def reset(self, t: float) -> None:
        """Start with nothing published. Raises InputError for a sea that cannot be."""
        self._waves = self.sea_state().waves()
        super().reset(t)

    def set_state(self, state: Mapping[str, Any]) -> None:
        """Restore what `get_state` returned."""
        super().set_state(state)
        self._waves = self.sea_state().waves()

    def measure(self) -> list[float]:
        """Return the depth that the pressure at the sensor is taken for."""
        arm = to_ned(self.attitude, self.place)
        at = [p + a for p, a in zip(self.position, arm, strict=True)]
        below = at[2]
        if self._waves is not None:
            below += float(self._waves.motion(seconds(self._instant_ns()), at).head)
        return [self.density / self.assumed_density * max(0.0, below)]
