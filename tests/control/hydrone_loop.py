"""The Hydrone under its autopilot: hull, thrusters, sensors and controller in one loop."""

import math

import numpy as np

from seatrial.control.station_keeping import StationKeeping
from seatrial.devices.actuators.propulsion import Propulsion
from seatrial.devices.actuators.thruster import Thruster
from seatrial.devices.compass import Compass
from seatrial.devices.gnss import Gnss
from seatrial.devices.imu import Imu
from seatrial.devices.sensor import Measured
from seatrial.physics.craft.marine_craft import MarineCraft
from seatrial.system.parameters import load_vehicle
from seatrial.system.profile.profile import load_profile

SENSORS = {"gnss": Gnss, "imu": Imu, "compass": Compass}
STEP_MS = 10
TRUTH = ("position", "attitude", "velocity", "rates")


def set_all(component, values):
    for name, value in values.items():
        component.set(name, value)
    return component


def hull(position, heading, current):
    entries = load_vehicle("hydrone").parameter_set("marine-craft", "physical").values
    craft = set_all(MarineCraft("hull"), {name: e.value for name, e in entries.items()})
    starts = {"position_start": [*position, 0.0], "attitude_start": [0.0, 0.0, heading]}
    return set_all(craft, {**starts, "current": current})


def sensors(ideal):
    """Return the sensors of the Hydrone's profile, each with noise of its own, or ideal."""
    profile, made = load_profile("hydrone"), {}
    for seed, (name, cls) in enumerate(SENSORS.items(), 1):
        sensor = set_all(cls(name), profile.parameters(f"sensors.{name}"))
        sensor.set("seed", seed)
        if ideal:
            errors = [f"{m.name}_{e}" for m in cls.measured for e in Measured.ERRORS]
            set_all(sensor, dict.fromkeys([*errors, "delay"], 0.0))
        made[name] = sensor
    if ideal:
        made["compass"].set("deviation", 0.0)
    return made


def held(
    seconds,
    *,
    position=(0, 0),
    heading=0.0,
    force=(0, 0),
    moment=0.0,
    current=(0, 0, 0),
    ideal=True,
):
    """Run the loop from rest; the station is the origin, heading north.

    ``force`` (north, east; N) and ``moment`` (N.m) push steadily. Returns rows of
    (t, north, east, heading wrapped to +-pi, mode).
    """
    craft = hull(position, heading, current)
    port, starboard = Thruster("port"), Thruster("starboard")
    at = {"position_1": [-0.45, -0.4, 0.15], "position_2": [-0.45, 0.4, 0.15]}
    ahead = {"direction_1": [1, 0, 0], "direction_2": [1, 0, 0]}
    pair = set_all(Propulsion("propulsion"), at | ahead)
    gnss, imu, compass = sensors(ideal).values()
    keeper = set_all(StationKeeping("keeper"), {"enabled": True})
    components = [craft, port, starboard, pair, gnss, imu, compass, keeper]

    def exchange():
        truth = {name: craft.get(name) for name in TRUTH}
        psi = truth["attitude"][2]
        c, s = math.cos(psi), math.sin(psi)
        north, east = force
        pair.set("thrust.t1", port.get("thrust"))
        pair.set("thrust.t2", starboard.get("thrust"))
        craft.set("force_1", pair.get("force"))
        craft.set("moment_1", pair.get("moment"))
        craft.set("force_2", [c * north + s * east, -s * north + c * east, 0])
        craft.set("moment_2", [0, 0, moment])
        set_all(gnss, truth)
        set_all(imu, {"attitude": truth["attitude"], "rates": truth["rates"]})
        imu.set("acceleration", craft.get("acceleration"))
        compass.set("attitude", truth["attitude"])
        received = {name: gnss.get(name) for name in ("position_n", "velocity_n")}
        valid = {"position_valid": gnss.get("valid"), "heading_valid": compass.get("valid")}
        set_all(keeper, received | valid | {"heading": compass.get("heading")})
        keeper.set("yaw_rate", imu.get("gyro.z"))
        port.set("pulse", keeper.get("pulse_port"))
        starboard.set("pulse", keeper.get("pulse_starboard"))

    for component in components:
        component.initialise()
        component.begin()
    rows = []
    for t_ms in range(0, round(seconds * 1000), STEP_MS):
        exchange()
        x, y, _ = craft.get("position")
        psi = math.remainder(craft.get("attitude.psi"), math.tau)
        rows.append([t_ms / 1000, x, y, psi, keeper.get("mode")])
        for component in components:
            component.advance(t_ms / 1000, STEP_MS / 1000)
    return np.array(rows)
