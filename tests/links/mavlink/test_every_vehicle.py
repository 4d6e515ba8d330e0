"""Telemetry of every vehicle in motion, field by field, against the truth of its time.

`FIELDS` says of each field which true quantity it is, in which unit; `OTHERS` names the messages
without a motion. A message in neither, and a field that is wrong in sign, unit or frame, fails.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from pymavlink import mavutil
from scipy.spatial.transform import Rotation

from seatrial.cosim.profile import load_profile
from seatrial.links.geodesy import Origin
from seatrial.trials.run import run_trial
from seatrial.trials.run_folder import load_run
from seatrial.trials.trial import load_trial

pytestmark = pytest.mark.interop

STOPS = {"hydrone": 60, "otter": 60, "mariner": 120, "bluerov2": 40, "videoray": 40, "gloria": 60}
TRIAL = """
rig     = "square"
choices = {{ vehicle = "{vehicle}", autopilot = "mavlink" }}
stop    = "{stop} s"
current = {{ speed = "0.2 m/s", direction = "70 deg" }}
sea     = {{ spectrum = "jonswap", height = "{height}", period = "{period}", direction = "110 deg" }}
[set]
"autopilot.mavlink.links" = "tcpin:127.0.0.1:0 udpout:127.0.0.1:9"
[record]
signals = ["vehicle.motion.*"]
every   = "{every}"
"""
G = 9.80665

Truth = dict[str, Any]
Field = tuple[Callable[[Truth], Any], float, float]
"""The true quantity in the unit of the field, its tolerance there, its period if it is an angle."""


def plain(name: str, axis: int, scale: float = 1.0, tolerance: float = 0.05) -> Field:
    return lambda t: scale * t[name][axis], scale * tolerance, 0.0


def _compass(t: Truth) -> float:
    return math.degrees(t["attitude"][2]) % 360.0


def _course(t: Truth) -> float:
    return math.degrees(math.atan2(t["velocity_n"][1], t["velocity_n"][0])) % 360.0


def _quaternion(t: Truth, number: int) -> float:
    x, y, z, w = Rotation.from_euler("ZYX", t["attitude"][::-1]).as_quat()
    return (w, x, y, z)[number]


RATES = [plain("rates", axis, 1.0, 0.02) for axis in range(3)]
PLACE: list[Field] = [
    (lambda t: t["geodetic"][0] * 1e7, 300.0, 0.0),  # 1e-7 degrees: 3 m of a receiver's wander
    (lambda t: t["geodetic"][1] * 1e7, 600.0, 0.0),
]
IMU_MG = [plain("force", axis, 1e3 / G, 0.3) for axis in range(3)]
IMU_MRAD = [plain("rates", axis, 1e3, 0.02) for axis in range(3)]
HEADING: Field = (_compass, 4.0, 360.0)
SPEED: Field = (lambda t: math.hypot(*t["velocity_n"][:2]), 0.3, 0.0)
FIELDS: dict[str, dict[str, Field]] = {
    "ATTITUDE": {
        "roll": plain("attitude", 0), "pitch": plain("attitude", 1),
        "yaw": (lambda t: t["attitude"][2], 0.07, math.tau),
        **dict(zip(("rollspeed", "pitchspeed", "yawspeed"), RATES, strict=True)),
    },
    "ATTITUDE_QUATERNION": {
        **dict(zip(("rollspeed", "pitchspeed", "yawspeed"), RATES, strict=True)),
    },
    "LOCAL_POSITION_NED": {
        **{axis: plain("position", i, 1.0, 4.0) for i, axis in enumerate("xy")},
        "z": plain("position", 2, 1.0, 8.0),  # of a receiver that wanders by 3 m
        **{f"v{axis}": plain("velocity_n", i, 1.0, 0.3) for i, axis in enumerate("xyz")},
    },
    "GLOBAL_POSITION_INT": {
        "lat": PLACE[0], "lon": PLACE[1],
        **{f"v{axis}": plain("velocity_n", i, 100.0, 0.3) for i, axis in enumerate("xyz")},
        "hdg": (lambda t: 100.0 * _compass(t), 400.0, 36_000.0),
    },
    "VFR_HUD": {
        "groundspeed": SPEED, "heading": HEADING,
        "alt": (lambda t: t["altitude"] - t["position"][2], 6.0, 0.0),
        "climb": (lambda t: -t["velocity_n"][2], 0.3, 0.0),
    },
    "GPS_RAW_INT": {"lat": PLACE[0], "lon": PLACE[1], "vel": plain("speed", 0, 100.0, 0.3)},
    "SCALED_IMU": {
        **dict(zip(("xacc", "yacc", "zacc"), IMU_MG, strict=True)),
        **dict(zip(("xgyro", "ygyro", "zgyro"), IMU_MRAD, strict=True)),
    },
    "RAW_IMU": {
        **dict(zip(("xacc", "yacc", "zacc"), IMU_MG, strict=True)),
        **dict(zip(("xgyro", "ygyro", "zgyro"), IMU_MRAD, strict=True)),
    },
    "HIGHRES_IMU": {
        **{f"{axis}acc": plain("force", i, 1.0, 0.3) for i, axis in enumerate("xyz")},
        **{f"{axis}gyro": plain("rates", i, 1.0, 0.02) for i, axis in enumerate("xyz")},
    },
    "ALTITUDE": {"altitude_local": (lambda t: -t["position"][2], 6.0, 0.0)},
    "AHRS2": {
        "roll": plain("attitude", 0), "pitch": plain("attitude", 1),
        "yaw": (lambda t: t["attitude"][2], 0.07, math.tau), "lat": PLACE[0], "lng": PLACE[1],
    },
    "SIM_STATE": {
        **{f"q{n + 1}": (lambda t, n=n: _quaternion(t, n), 1e-3, 0.0) for n in range(4)},
        "roll": plain("attitude", 0, 1.0, 1e-3), "pitch": plain("attitude", 1, 1.0, 1e-3),
        "yaw": (lambda t: t["attitude"][2], 1e-3, math.tau),
        **{f"{axis}acc": plain("force", i, 1.0, 1e-2) for i, axis in enumerate("xyz")},
        **{f"{axis}gyro": plain("rates", i, 1.0, 1e-3) for i, axis in enumerate("xyz")},
        **{f"v{axis}": plain("velocity_n", i, 1.0, 1e-2) for i, axis in enumerate("ned")},
    },
}  # fmt: skip
OTHERS = {
    *("HEARTBEAT", "SYS_STATUS", "SYSTEM_TIME", "EXTENDED_SYS_STATE", "SERVO_OUTPUT_RAW"),
    *("RC_CHANNELS", "EKF_STATUS_REPORT", "VIBRATION", "POWER_STATUS", "NAV_CONTROLLER_OUTPUT"),
    *("POSITION_TARGET_GLOBAL_INT", "MISSION_CURRENT", "HOME_POSITION", "GPS_GLOBAL_ORIGIN"),
    *("COMMAND_ACK", "STATUSTEXT", "MISSION_REQUEST", "MISSION_REQUEST_INT", "MISSION_ACK"),
    *("MISSION_ITEM_REACHED", "SCALED_PRESSURE2", "ESC_TELEMETRY_1_TO_4", "BATTERY_STATUS"),
    *("WIND", "WIND_COV", "PARAM_VALUE", "TIMESYNC", "FENCE_STATUS", "NAMED_VALUE_FLOAT"),
    *(
        "CURRENT_MODE",
        "AVAILABLE_MODES_MONITOR",
        "CURRENT_EVENT_SEQUENCE",
        "MISSION_COUNT",
        "MISSION_ITEM_INT",
        "BAD_DATA",
    ),
}
SENSORS = {
    "rates": mavutil.mavlink.MAV_SYS_STATUS_SENSOR_3D_GYRO,
    "force": mavutil.mavlink.MAV_SYS_STATUS_SENSOR_3D_ACCEL,
}


def sailed(vehicle: str, folder: Path) -> Path:
    """Send a vehicle on its square in current, waves and wind, and return the run's folder."""
    waves = ("3 m", "9 s") if vehicle == "mariner" else ("15 cm", "2.5 s")
    (folder / "trial.toml").write_text(
        TRIAL.format(
            vehicle=vehicle, stop=STOPS[vehicle], height=waves[0], period=waves[1],
            every="100 ms" if vehicle == "mariner" else "10 ms",
        )
    )  # fmt: skip
    result = run_trial(load_trial(str(folder / "trial.toml")), folder / "run", engine="direct")
    assert result.error is None, result.error
    return result.folder


def truths(folder: Path, vehicle: str) -> Callable[[float], Truth]:
    """Return what gives the truth at a time, s."""
    run, home = load_run(folder), load_profile(vehicle).file.home
    origin = Origin(home.latitude, home.longitude, home.altitude)

    def columns(port: str) -> np.ndarray:
        return np.transpose([run.signals[n] for n in run.signals if f".{port}." in n])

    recorded = {p: columns(p) for p in ("position", "velocity", "attitude", "rates")}
    moved = columns("acceleration")
    turns = Rotation.from_euler("ZYX", recorded["attitude"][:, ::-1])
    recorded["velocity_n"] = turns.apply(recorded["velocity"])
    recorded["force"] = moved - turns.inv().apply([[0.0, 0.0, 9.81]] * len(moved))

    def at(t: float) -> Truth:
        row = int(np.argmin(np.abs(run.time - t)))
        now = {name: values[row] for name, values in recorded.items()}
        now["speed"] = [math.hypot(*now["velocity_n"][:2])]
        return {**now, "geodetic": origin.geodetic(now["position"]), "altitude": home.altitude}

    return at


def time_of(m: Any) -> float | None:
    if hasattr(m, "time_boot_ms"):
        return m.time_boot_ms / 1e3
    return m.time_usec / 1e6 if hasattr(m, "time_usec") else None


@pytest.mark.parametrize("vehicle", STOPS)
def test_every_field_is_the_truth_in_its_unit_and_frame(vehicle: str, tmp_path: Path) -> None:
    folder = sailed(vehicle, tmp_path)
    truth = truths(folder, vehicle)
    log = mavutil.mavlink_connection(str(folder / "autopilot.mavlink.tlog"), dialect="all")
    begun, found, present = None, {}, 0
    unknown: set[str] = set()
    while (m := log.recv_match()) is not None:
        name = m.get_type()
        if m.get_srcComponent() != 1:
            continue
        begun = m._timestamp if begun is None else begun
        if name == "SYS_STATUS":
            present = m.onboard_control_sensors_present
        if name not in FIELDS:
            unknown |= {name} - OTHERS
            continue
        stamp = time_of(m)
        t = m._timestamp - begun if stamp is None else stamp
        if t > 8.0:  # the sensors have begun
            found.setdefault(name, []).append((truth(t), m))
    assert not unknown
    assert {"ATTITUDE", "GLOBAL_POSITION_INT", "VFR_HUD", "SIM_STATE"} <= found.keys()
    wrong = []
    for name, came in found.items():
        for field, (quantity, tolerance, period) in FIELDS[name].items():
            off = np.array([getattr(m, field) - quantity(t) for t, m in came])
            if period:
                off = (off + period / 2) % period - period / 2
            if not (worst := np.sqrt(np.nanmean(off**2))) <= tolerance:
                wrong.append(f"{name}.{field} is off by {worst:.4g} of {tolerance:.4g}")
    assert not wrong, wrong
    measured = {"rates": "xgyro", "force": "xacc"}
    for quantity, bit in SENSORS.items():
        is_sent = any(
            math.isfinite(getattr(m, measured[quantity])) for _, m in found.get("HIGHRES_IMU", ())
        )
        assert bool(present & bit) == is_sent
