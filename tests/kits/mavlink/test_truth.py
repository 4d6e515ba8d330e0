"""Every measured field of every message of every vehicle, in motion, against the truth."""

import math

import pytest
from pymavlink.dialects.v20 import all as mavlink

from .moving import LINK, VEHICLES, Moving

G = 9.80665
U16, I16 = 0xFFFF, 0x7FFF
NAN = math.nan


def angle(name, unit=1.0, turn=math.tau):
    """Return what an angle is in a unit per rad; whole turns are the same."""
    return lambda t: t[name] * unit, turn


def value(name, unit=1.0):
    return lambda t: t[name] * unit, None


def exactly(number):
    """Return a field that has the same number in every message."""
    return lambda t: number, None


def of(function, turn=None):
    return function, turn


DEG = math.degrees(1.0)
ANY = None
"""Of a field that measures nothing: counts, times, states, identities, settings."""
TIME_MS, TIME_US = value("time", 1e3), value("time", 1e6)
RATES = {"p": value("p"), "q": value("q"), "r": value("r")}
EULER = {"roll": angle("roll"), "pitch": angle("pitch"), "yaw": angle("yaw")}
SPEEDS = {"rollspeed": RATES["p"], "pitchspeed": RATES["q"], "yawspeed": RATES["r"]}
PLACE = {"lat": value("lat", 1e7), "lon": value("lon", 1e7)}
MG = {f"{a}acc": value(f"f{a}", 1e3 / G) for a in "xyz"}
MRAD = {"xgyro": value("p", 1e3), "ygyro": value("q", 1e3), "zgyro": value("r", 1e3)}
NO_FIELD = {f"{a}mag": exactly(0) for a in "xyz"}
"""No magnetometer of three axes is modelled: 0."""
NED = {"x": value("north"), "y": value("east"), "z": value("down")}
IMU = {"time_boot_ms": TIME_MS, **MG, **MRAD, **NO_FIELD, "temperature": exactly(0)}


def quaternion(index):
    """Return an element of the quaternion, w not negative, by pymavlink's matrix."""

    def element(t):
        from pymavlink.quaternion import Quaternion

        q = Quaternion(t["matrix"]).q
        return (q if q[0] >= 0 else -q)[index]

    return of(element)


def unpack(message):
    """Return the fields, arrays element by element, quaternions with w not negative."""
    fields = message.to_dict()
    del fields["mavpackettype"]
    found = {}
    for name, given in fields.items():
        many = isinstance(given, list | tuple)
        found |= {f"{name}{i}": x for i, x in enumerate(given)} if many else {name: given}
    for names in ([f"q{i}" for i in range(1, 5)], [f"q{i}" for i in range(4)], *_HIL):
        if set(names) <= set(found) and found[names[0]] < 0.0:
            found |= {name: -found[name] for name in names}
    return found


_HIL = ([f"attitude_quaternion{i}" for i in range(4)],)


def sky(t):
    return math.hypot(t["vn"], t["ve"])


def course(t):
    return math.degrees(math.atan2(t["ve"], t["vn"])) * 100


TABLE = {
    "ATTITUDE": {"time_boot_ms": TIME_MS, **EULER, **SPEEDS},
    "ATTITUDE_QUATERNION": {
        "time_boot_ms": TIME_MS,
        **{f"q{i + 1}": quaternion(i) for i in range(4)},
        **SPEEDS,
        **{f"repr_offset_q{i}": exactly(0) for i in range(4)},
    },
    "LOCAL_POSITION_NED": {
        "time_boot_ms": TIME_MS,
        **NED,
        "vx": value("vn"),
        "vy": value("ve"),
        "vz": value("vd"),
    },
    "GLOBAL_POSITION_INT": {
        "time_boot_ms": TIME_MS,
        **PLACE,
        "alt": value("altitude", 1e3),
        "relative_alt": value("down", -1e3),
        "vx": value("vn", 100),
        "vy": value("ve", 100),
        "vz": value("vd", 100),
        "hdg": angle("yaw", 100 * DEG, 36000),
    },
    "VFR_HUD": {
        "airspeed": of(lambda t: t["apparent"] if t["windy"] else sky(t)),
        "groundspeed": of(sky),
        "heading": angle("yaw", DEG, 360),
        "alt": value("altitude"),
        "climb": value("vd", -1.0),
        "throttle": ANY,
    },
    "ALTITUDE": {
        "time_usec": TIME_US,
        "altitude_monotonic": value("altitude"),
        "altitude_amsl": value("altitude"),
        "altitude_local": value("down", -1.0),
        "altitude_relative": value("down", -1.0),
        "altitude_terrain": exactly(NAN),
        "bottom_clearance": exactly(NAN),
    },
    "SIM_STATE": {
        **{f"q{i + 1}": quaternion(i) for i in range(4)},
        **EULER,
        **{f"{a}acc": value(f"f{a}") for a in "xyz"},
        "xgyro": value("p"),
        "ygyro": value("q"),
        "zgyro": value("r"),
        "lat": value("lat"),
        "lon": value("lon"),
        "alt": value("altitude"),
        "std_dev_horz": exactly(0),
        "std_dev_vert": exactly(0),
        "vn": value("vn"),
        "ve": value("ve"),
        "vd": value("vd"),
        "lat_int": value("lat", 1e7),
        "lon_int": value("lon", 1e7),
    },
    "HIL_STATE_QUATERNION": {
        "time_usec": TIME_US,
        **{f"attitude_quaternion{i}": quaternion(i) for i in range(4)},
        **SPEEDS,
        **PLACE,
        "alt": value("altitude", 1e3),
        "vx": value("vn", 100),
        "vy": value("ve", 100),
        "vz": value("vd", 100),
        "ind_airspeed": exactly(0),
        "true_airspeed": exactly(0),
        **MG,
    },
    "ODOMETRY": {
        "time_usec": TIME_US,
        "frame_id": exactly(mavlink.MAV_FRAME_LOCAL_NED),
        "child_frame_id": exactly(mavlink.MAV_FRAME_BODY_FRD),
        **NED,
        **{f"q{i}": quaternion(i) for i in range(4)},
        **{f"v{a}": of(lambda t, a=a: getattr(t["body"], a)) for a in "xyz"},
        **SPEEDS,
        **{
            f"{what}_covariance{i}": exactly(NAN)
            for what in ("pose", "velocity")
            for i in range(21)
        },
        **dict.fromkeys(("reset_counter", "estimator_type", "quality"), exactly(0)),
    },
    "SCALED_IMU": IMU,
    "RAW_IMU": {
        **{name: spec for name, spec in IMU.items() if name != "time_boot_ms"},
        "time_usec": TIME_US,
        "id": exactly(0),
    },
    "HIGHRES_IMU": {
        "time_usec": TIME_US,
        **{f"{a}acc": value(f"f{a}") for a in "xyz"},
        "xgyro": value("p"),
        "ygyro": value("q"),
        "zgyro": value("r"),
        **NO_FIELD,
        "abs_pressure": of(lambda t: t["pressure"] if t["dives"] else 0.0),
        **dict.fromkeys(("diff_pressure", "pressure_alt", "temperature", "id"), exactly(0)),
        "fields_updated": of(lambda t: 0x3F | (0x200 if t["dives"] else 0)),
    },
    "SCALED_PRESSURE2": {
        "time_boot_ms": TIME_MS,
        "press_abs": value("pressure"),
        "press_diff": exactly(0),
        "temperature": exactly(I16),
        "temperature_press_diff": exactly(0),
    },
    "GPS_RAW_INT": {
        "time_usec": TIME_US,
        "fix_type": ANY,
        **PLACE,
        "alt": value("altitude", 1e3),
        "eph": ANY,
        "epv": exactly(U16),
        "vel": of(lambda t: sky(t) * 100),
        "cog": of(course, 36000),
        "satellites_visible": ANY,
        **dict.fromkeys(
            ("alt_ellipsoid", "h_acc", "v_acc", "vel_acc", "hdg_acc", "yaw"), exactly(0)
        ),
    },
    "AHRS2": {
        **EULER,
        "altitude": value("altitude"),
        "lat": value("lat", 1e7),
        "lng": value("lon", 1e7),
    },
    "WIND": {
        "direction": of(lambda t: math.degrees(math.atan2(-t["wind_e"], -t["wind_n"])), 360),
        "speed": of(lambda t: math.hypot(t["wind_n"], t["wind_e"])),
        "speed_z": exactly(0),
    },
    "WIND_COV": {
        "time_usec": TIME_US,
        "wind_x": value("wind_n"),
        "wind_y": value("wind_e"),
        "wind_z": exactly(0),
        **dict.fromkeys(
            ("var_horiz", "var_vert", "wind_alt", "horiz_accuracy", "vert_accuracy"), exactly(NAN)
        ),
    },
    "SYS_STATUS": {
        "voltage_battery": exactly(U16),
        "current_battery": exactly(-1),
        "battery_remaining": exactly(-1),
        **{
            f"onboard_control_sensors_{what}": of(lambda t: t["sensors"])
            for what in ("present", "enabled")
        },
        "onboard_control_sensors_health": of(lambda t: t["sensors"]),
        **dict.fromkeys(
            ("load", "drop_rate_comm", "errors_comm", *(f"errors_count{i}" for i in range(1, 5))),
            exactly(0),
        ),
        **{
            f"onboard_control_sensors_{what}_extended": exactly(0)
            for what in ("present", "enabled", "health")
        },
    },
    "SERVO_OUTPUT_RAW": {
        "time_usec": TIME_US,
        "port": exactly(0),
        **{f"servo{n}_raw": of(lambda t, n=n: t["shown_pulses"][n - 1]) for n in range(1, 17)},
    },
    "EKF_STATUS_REPORT": {
        "flags": of(lambda t: 0x1 | 0x2 | 0x4 | 0x8 | 0x10 | 0x20 | 0x100 | 0x200),
        **dict.fromkeys(
            ("velocity_variance", "pos_horiz_variance", "pos_vert_variance", "compass_variance"),
            ANY,
        ),
        **dict.fromkeys(("terrain_alt_variance", "airspeed_variance"), exactly(0)),
    },
    "ESC_TELEMETRY_1_TO_4": {
        **{
            f"rpm{i}": of(lambda t, i=i: abs(t["motor_speed"][i]) * 60 / math.tau) for i in range(4)
        },
        **{f"current{i}": of(lambda t, i=i: abs(t["motor_current"][i]) * 100) for i in range(4)},
        **{f"{what}{i}": exactly(0) for what in ("temperature", "voltage") for i in range(4)},
        **{f"{what}{i}": ANY for what in ("totalcurrent", "count") for i in range(4)},
    },
    "VIBRATION": {
        "time_usec": TIME_US,
        **{name: ANY for a in "xyz" for name in (f"vibration_{a}",)},
        **{f"clipping_{i}": exactly(0) for i in range(3)},
    },
    "HOME_POSITION": {
        "latitude": value("home_lat", 1e7),
        "longitude": value("home_lon", 1e7),
        "altitude": value("home_altitude", 1e3),
        **dict.fromkeys("xyz", exactly(0)),
        "q0": exactly(1),
        **{f"q{i}": exactly(0) for i in range(1, 4)},
        **{f"approach_{a}": exactly(0) for a in "xyz"},
        "time_usec": TIME_US,
    },
    "SYSTEM_TIME": {"time_unix_usec": ANY, "time_boot_ms": TIME_MS},
}
MEASURE_NOTHING = {
    "HEARTBEAT", "STATUSTEXT", "COMMAND_ACK", "MISSION_CURRENT", "CURRENT_MODE", "AVAILABLE_MODES_MONITOR",
    "EXTENDED_SYS_STATE", "FENCE_STATUS", "POWER_STATUS", "RC_CHANNELS", "AUTOPILOT_VERSION", "NAMED_VALUE_FLOAT",
}  # fmt: skip
HEELED = {"direction": 1.5, "speed": 0.1, "wind_x": 0.1, "wind_y": 0.1}
"""A vane heels with the boat: of 0.15 rad, 1 % of the speed is lost, and degrees are turned."""
EVERY = {
    "ATTITUDE", "ATTITUDE_QUATERNION", "LOCAL_POSITION_NED", "GLOBAL_POSITION_INT", "VFR_HUD", "ALTITUDE", "SIM_STATE",
    "ODOMETRY", "HIL_STATE_QUATERNION", "SCALED_IMU", "RAW_IMU", "HIGHRES_IMU", "GPS_RAW_INT", "AHRS2", "SYS_STATUS",
    "SERVO_OUTPUT_RAW", "EKF_STATUS_REPORT", "VIBRATION", "HOME_POSITION", "SYSTEM_TIME",
}  # fmt: skip
"""Messages that all vehicles send."""
ONLY = {
    "bluerov2": {"SCALED_PRESSURE2"},
    "videoray": {"SCALED_PRESSURE2"},
    "gloria": {"WIND", "WIND_COV"},
    "hydrone": {"ESC_TELEMETRY_1_TO_4"},
    "otter": {"ESC_TELEMETRY_1_TO_4"},
    "mariner": set(),
}


def completed(t, moving):
    """Return the truth with what follows from it, by formulas of the standards."""
    get = moving.sim.get
    latitude, longitude, altitude = (
        get(f"{LINK}.{name}") for name in ("latitude", "longitude", "altitude")
    )
    # WGS 84: radii of curvature of the meridian and of the prime vertical.
    a, e2 = 6378137.0, 6.69437999014e-3
    w = math.sqrt(1.0 - e2 * math.sin(latitude) ** 2)
    north, east = a * (1.0 - e2) / w**3, a / w * math.cos(latitude)
    submerged = moving.vehicle in ("bluerov2", "videoray")
    windy = moving.vehicle == "gloria"
    bit = mavlink
    sensors = (
        bit.MAV_SYS_STATUS_SENSOR_3D_GYRO
        | bit.MAV_SYS_STATUS_SENSOR_3D_ACCEL
        | bit.MAV_SYS_STATUS_SENSOR_3D_MAG
        | bit.MAV_SYS_STATUS_AHRS
        | bit.MAV_SYS_STATUS_SENSOR_GPS
        | bit.MAV_SYS_STATUS_GEOFENCE
        | bit.MAV_SYS_STATUS_PREARM_CHECK
        | (bit.MAV_SYS_STATUS_SENSOR_ABSOLUTE_PRESSURE if submerged else 0)
    )
    pulses = [round(p * 1e6) for p in t["pulses"]]
    if moving.vehicle == "videoray":  # shares of full thrust: 400 us about 1500
        pulses[:3] = [1500 + 400 * x for x in t["share"]] if any(t["share"]) else [0, 0, 0]
    wind = get("vehicle.wind.velocity") if windy else (0.0, 0.0)
    return t | {
        "altitude": altitude - t["down"],
        "home_lat": math.degrees(latitude),
        "home_lon": math.degrees(longitude),
        "home_altitude": altitude,
        "lat": math.degrees(latitude + t["north"] / north),
        "lon": math.degrees(longitude + t["east"] / east),
        "dives": submerged,
        "pressure": 1013.25 + 98.0665 * t["down"],
        "windy": windy,
        "wind_n": wind[0],
        "wind_e": wind[1],
        "sensors": sensors,
        "shown_pulses": pulses,
    }


def differs(given, spec, truth, slack):
    """Return what is wrong with a field, empty if nothing is."""
    function, turn = spec
    wanted = function(truth)
    if math.isnan(wanted):
        return "" if math.isnan(given) else f"{given}, not NaN"
    away = given - wanted
    if turn is not None:
        away = math.remainder(away, turn)
    # Integers are rounded; floats have 24 bits; heights over a plane of some 10 m are exact to 1e-5 m.
    whole = 0.51 if isinstance(given, int) else 0.0
    if abs(away) <= slack + whole + 2e-5 + 2e-7 * abs(wanted):
        return ""
    return f"{given}, {wanted} is true"


ON_REQUEST = ("ODOMETRY", "HIL_STATE_QUATERNION")


@pytest.mark.sampled(3)
@pytest.mark.parametrize("vehicle", VEHICLES)
def test_every_field_is_the_truth(vehicle):
    """Driven by a station while it drifts, heels and pitches; messages are of the step's start."""
    seen, wrong = {}, {}
    with Moving(vehicle) as moving:
        moving.step()
        moving.send(mavlink.MAVLink_heartbeat_message(6, 8, 0, 0, 4, 3))
        for name in ON_REQUEST:
            number = getattr(mavlink, f"MAVLINK_MSG_ID_{name}")
            moving.command(mavlink.MAV_CMD_SET_MESSAGE_INTERVAL, number, 2e5)
        moving.command(mavlink.MAV_CMD_COMPONENT_ARM_DISARM, 1, 21196)
        custom = 19 if vehicle in ("bluerov2", "videoray") else 0
        moving.command(mavlink.MAV_CMD_DO_SET_MODE, 1, custom)
        for k in range(260):
            if k % 20 == 0:
                moving.send(
                    mavlink.MAVLink_manual_control_message(moving.system, 300, 200, 600, 250, 0)
                )
            truth, messages = moving.step()
            truth = completed(truth, moving)
            for message in messages:
                check(message, truth, seen, wrong)
        turning = max(abs(moving.truth()[rate]) for rate in "pqr")
    assert turning > 1e-3
    assert not wrong, "\n".join(f"{place}: {what}" for place, what in wrong.items())
    assert set(seen) - MEASURE_NOTHING == EVERY | ONLY[vehicle]


def check(message, truth, seen, wrong):
    """Note the first mistake of each field."""
    kind = message.get_type()
    seen[kind] = seen.get(kind, 0) + 1
    if kind in MEASURE_NOTHING or truth["time"] < 0.05:
        return
    fields = unpack(message)
    for name in fields.keys() ^ TABLE.get(kind, {}).keys():
        wrong[f"{kind}.{name}"] = "is not in both, message and table"
    for name, spec in TABLE.get(kind, {}).items():
        if spec is not ANY and name in fields:
            slack = HEELED.get(name, 0.0) if kind.startswith("WIND") else 0.0
            found = differs(fields[name], spec, truth, slack)
            if found:
                wrong.setdefault(f"{kind}.{name}", f"{found} at {truth['time']:.2f} s")
