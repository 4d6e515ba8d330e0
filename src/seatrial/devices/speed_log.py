"""Speed log: velocity through the water."""

from __future__ import annotations

from typing import ClassVar

from ..model.component import Input, Parameter, terminal
from ..physics.craft.kinematics import cross
from .sensor import ALWAYS_THERE, Measured, Sensor


class SpeedLog(Sensor):
    """Velocity of the transducer through the water, ahead and to starboard, body axes.

        water_velocity = (1 + scale) (v_r + omega x place) of nu_r = (v_r, omega)

    with the errors of `Sensor`. ``place`` is the lever arm of the transducer from the body origin,
    body axes (x bow, y starboard, z down), m. A paddle wheel has one axis, and is read by ``u``
    alone. A current leaves the speed as it is: the log moves in the same water as its hull.

    Defaults: an electromagnetic or paddle-wheel log for yachts: 1 Hz, 0.01 kn resolution, noise of
    1 cm/s; ``scale``, by the boundary layer and the hull's flow, some percent until it is
    calibrated (0 here).

    Not modelled: shear of the current between body origin and transducer, the hull's own
    flow beyond ``scale``, air under the hull, a wheel that does not turn below 0.1 m/s.
    """

    exercised: ClassVar = {"dropout": 0.2, "place": [0.4, 0.1, 0.3], "scale": 0.02}

    period = Parameter(1.0, "s", "sample period", min=1e-6)
    place = Parameter(0.0, "m", "transducer from the body origin, body axes", axes="xyz")
    scale = Parameter(0.0, "1", "error of the calibration, a share of the speed", min=-0.9, max=9.0)

    nu_r = Input(
        ("m/s", "m/s", "m/s", "rad/s", "rad/s", "rad/s"),
        "velocity of the body origin through the water and angular velocity, body axes",
        axes=("u", "v", "w", "p", "q", "r"),
    )

    water_velocity = Measured(
        "m/s",
        "velocity through the water, ahead and to starboard, body axes",
        axes="uv",
        span=(-10.0, 20.0),
        noise=0.01,
        resolution=0.00514,
    )

    terminals: ClassVar = {
        "water": terminal("nu_r"),
        "reading": terminal(water_speed="water_velocity__u", water_speed_valid="valid"),
    }
    feedthrough: ClassVar = ALWAYS_THERE

    def measure(self) -> list[float]:
        """Return the velocity of the transducer."""
        u, v, _w, *rates = self.nu_r
        by_turning = cross(rates, self.place)
        factor = 1.0 + self.scale
        return [factor * (u + by_turning[0]), factor * (v + by_turning[1])]
