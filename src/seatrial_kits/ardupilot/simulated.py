"""ArduPilot's simulated instruments as the profile's sensors: a file of ``SIM_`` parameters.

ArduPilot makes its measurements of the true motion, with errors of its own. Its noise is uniform
between -a and a, so that a standard deviation s is a = sqrt(3) s. Of the sensors of a profile, the
first of each kind:

==========================  =====================================================================
gnss: period, delay         SIM_GPS1_HZ, SIM_GPS1_LAG_MS; the firmware knows it by GPS1_DELAY_MS
gnss: antenna               SIM_GPS1_POS_X, _Y, _Z, m; the firmware knows it by GPS1_POS_X, _Y, _Z
gnss: velocity_n_noise      SIM_GPS1_VERR_X, _Y, _Z, m/s
gnss: position_n_noise,     SIM_GPS1_ACC, m: the accuracy that the receiver states, the root of the
position_n_instability      sum of both squares; ArduPilot has no noise of the horizontal position
imu: gyro_bias,             SIM_GYR1_BIAS_X ..., rad/s, and SIM_ACC1_BIAS_X ..., m/s2, of all three
accelerometer_bias          units; ArduPilot's own noise is 0.04 deg/s and 0.01 m/s2, as it comes
compass, ahrs: noise of     SIM_MAG_RND, mG: the field across a horizontal field B turned by s,
the heading; delay          a = sqrt(3) B s; SIM_MAG_DELAY, ms
depth: depth_noise, delay   SIM_BARO_RND, m, and SIM_BARO_DELAY, ms, of all three, of ArduSub alone
==========================  =====================================================================

``B`` is that of the World Magnetic Model at the home. Outages of the sensors of the vehicle reach
the firmware while it runs, by the ground station (`GroundStation`).
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any, NamedTuple

from seatrial.links.earth_field import earth_field
from seatrial.links.vehicle_sensors import Sensors, axis, first_of, three

FILE = "instruments.parm"
_MILLIGAUSS = 1e7
"""In one tesla."""
_UNIFORM = math.sqrt(3.0)


class Simulated(NamedTuple):
    """One parameter of the firmware: its name, its value, and the sensor's key it is from."""

    name: str
    value: float
    source: str


Home = tuple[float, float, float]


def simulated(sensors: Sensors, firmware: str, home: Home, unix_s: float) -> list[Simulated]:
    """Return ArduPilot's parameters for a profile's ``sensors``; see the module.

    ``home`` is latitude, longitude, rad, and altitude, m.
    """
    found: list[Simulated] = []
    for kind, made in (
        ("gnss", _gnss),
        ("imu", _imu),
        ("compass", lambda s: _heading(s, "heading_noise", s["heading_noise"], home, unix_s)),
        ("ahrs", lambda s: _heading(s, "euler_noise", axis(s["euler_noise"], 2), home, unix_s)),
        ("depth", _depth if firmware == "sub" else lambda _: iter(())),
    ):
        name, sensor = first_of(sensors, kind)
        if sensor is not None:
            found += [
                Simulated(key, value, f"sensors.{name}.{source}")
                for key, value, source in made(sensor)
            ]
    return found


def write_parameters(folder: Path, parameters: list[Simulated]) -> Path:
    """Write a file of parameters into ``folder``, each with the key it is from."""
    folder.mkdir(parents=True, exist_ok=True)
    path = folder / FILE
    lines = [f"{one.name:<18} {one.value:<12.6g} # {one.source}\n" for one in parameters]
    path.write_text("# Of the sensors of the profile\n" + "".join(lines), "utf-8")
    return path.resolve()


def _gnss(sensor: Mapping[str, Any]) -> Iterator[Simulated]:
    yield Simulated("SIM_GPS1_HZ", max(1.0, round(1.0 / axis(sensor["period"]))), "period")
    lag = round(1e3 * axis(sensor["delay"]))
    yield Simulated("SIM_GPS1_LAG_MS", lag, "delay")
    yield Simulated("GPS1_DELAY_MS", max(lag, 1), "delay")  # 0 is that of the receiver's type
    for letter, place, noise in zip(
        "XYZ", three(sensor["antenna"]), three(sensor["velocity_n_noise"]), strict=True
    ):
        yield Simulated(f"SIM_GPS1_POS_{letter}", place, "antenna")
        yield Simulated(f"GPS1_POS_{letter}", place, "antenna")
        yield Simulated(f"SIM_GPS1_VERR_{letter}", _UNIFORM * noise, "velocity_n_noise")
    parts = (axis(sensor[f"position_n_{part}"], 0) for part in ("noise", "instability"))
    yield Simulated("SIM_GPS1_ACC", max(math.hypot(*parts), 0.01), "position_n_noise")


def _imu(sensor: Mapping[str, Any]) -> Iterator[Simulated]:
    for of, key in (("GYR", "gyro_bias"), ("ACC", "accelerometer_bias")):
        for letter, bias in zip("XYZ", three(sensor[key]), strict=True):
            if bias:
                yield from (Simulated(f"SIM_{of}{n}_BIAS_{letter}", bias, key) for n in (1, 2, 3))


def _heading(
    sensor: Mapping[str, Any], key: str, noise: Any, home: Home, unix_s: float
) -> Iterator[Simulated]:
    across = math.hypot(*earth_field(*home, unix_s)[:2]) * axis(noise, 0)
    yield Simulated("SIM_MAG_RND", _UNIFORM * _MILLIGAUSS * across, key)
    yield Simulated("SIM_MAG_DELAY", round(1e3 * axis(sensor["delay"])), "delay")


def _depth(sensor: Mapping[str, Any]) -> Iterator[Simulated]:
    for of in ("BARO", "BAR2", "BAR3"):
        yield Simulated(f"SIM_{of}_RND", _UNIFORM * axis(sensor["depth_noise"], 0), "depth_noise")
        yield Simulated(f"SIM_{of}_DELAY", round(1e3 * axis(sensor["delay"])), "delay")
