"""Whatever a station sets stays within bounds, and the vehicle goes on."""

import math

import pytest
from hypothesis import Phase, example, given, settings
from hypothesis import strategies as st
from pymavlink.dialects.v20 import all as mavlink

from seatrial.model.units import quantity
from seatrial.system.profile.profile import load_profile
from seatrial_kits.mavlink.parameters.definition import REAL32

from .bench import Bench
from .moving import VEHICLES, Moving

EXTREMES = (
    0.0,
    -1.0,
    1.0,
    1e-45,
    -1e-40,
    99.0,
    1e5,
    -1e9,
    1e30,
    -3e38,
    math.inf,
    -math.inf,
    math.nan,
)
"""The smallest is a denormal number of 32 bits."""
PHASES = (Phase.explicit, Phase.generate)
"""A run takes seconds: none is made simpler."""
FAULTS = ["gps", "mag", "gyro", "baro", "motor1", "motor2"]
KINDS = [(False, "ardupilotmega"), (True, "ardupilotmega"), (False, "px4"), (True, "px4")]


@pytest.mark.parametrize(("submerged", "autopilot"), KINDS)
def test_every_parameter_that_can_be_set_has_bounds(submerged, autopilot):
    """What is beyond them, and no number at all, is refused as an ArduPilot refuses it."""
    bench = Bench(submerged=submerged, autopilot=autopilot, failures=FAULTS, battery_capacity=3.6e5)
    unset = 0
    for name in bench.parameters.names:
        if bench.parameters.kind(name) != REAL32:
            continue
        before = bench.parameters[name]
        for value in (math.nan, math.inf, -math.inf, 1e30, -1e30):
            bench.transport.take()
            message = mavlink.MAVLink_param_set_message(7, 1, name.encode(), value, REAL32)
            bench.receive(message)
            error, answer = (
                bench.transport.take("PARAM_ERROR")[0],
                bench.transport.take("PARAM_VALUE"),
            )
            assert [one.param_value for one in answer] == [pytest.approx(before)], name
            read_only = error.error == mavlink.MAV_PARAM_ERROR_READ_ONLY
            assert read_only or error.error == mavlink.MAV_PARAM_ERROR_VALUE_OUT_OF_RANGE
            unset += not read_only
        assert bench.parameters[name] == before
    assert unset > 20


number = st.sampled_from(EXTREMES) | st.floats(width=32)
three = st.tuples(number, number, number)
int16, uint16 = st.integers(-(2**15), 2**15 - 1), st.integers(0, 2**16 - 1)
COMMANDS = (
    *(
        mavlink.MAV_CMD_DO_CHANGE_SPEED,
        mavlink.MAV_CMD_DO_REPOSITION,
        mavlink.MAV_CMD_CONDITION_YAW,
    ),
    *(
        mavlink.MAV_CMD_DO_SET_HOME,
        mavlink.MAV_CMD_NAV_RETURN_TO_LAUNCH,
        mavlink.MAV_CMD_NAV_LOITER_UNLIM,
    ),
    *(mavlink.MAV_CMD_DO_SET_MISSION_CURRENT, mavlink.MAV_CMD_MISSION_START),
)
orders = st.one_of(
    st.tuples(st.just("parameter"), st.integers(0, 63), st.sampled_from(("low", "high")) | number),
    st.tuples(st.just("setting"), st.sampled_from(("WPNAV_SPEED", "WPNAV_RADIUS", "CIRCLE_RADIUS", "WP_SPEED", "WP_RADIUS", "CIRC_RADIUS", "CRUISE_SPEED", "FENCE_DEPTH_MAX", "SIM_GPS1_GLTCH_X", "SIM_GPS1_GLTCH_Z", "SIM_GYR1_BIAS_Z", "SIM_BARO_GLITCH")), number),
    st.tuples(st.just("local"), st.sampled_from((1, 7, 8, 9, 12)), st.sampled_from((0xDF8, 0xDC7, 0x5C7, 0x9FF, 0xBFF, 0)), three, three, number, number),
    st.tuples(st.just("attitude"), st.tuples(number, number, number, number), number),
    st.tuples(st.just("manual"), st.tuples(int16, int16, int16, int16)),
    st.tuples(st.just("rc"), st.lists(uint16, min_size=8, max_size=8)),
    st.tuples(st.just("command"), st.sampled_from(COMMANDS), st.lists(number, min_size=7, max_size=7)),
    st.tuples(st.just("mode"), st.sampled_from((0, 2, 3, 4, 5, 7, 10, 15, 16, 19))),
)  # fmt: skip


def carry_out(moving, tunables, order):
    """Send an order as a station does."""
    kind, *given = order
    system = moving.system
    match kind:
        case "parameter" | "setting":
            name, value = given
            if kind == "parameter":
                tunable = tunables[name % len(tunables)]
                name = tunable.name
                value = {"low": tunable.min, "high": tunable.max}.get(value, value)
            moving.send(mavlink.MAVLink_param_set_message(system, 1, name.encode(), value, REAL32))
        case "local":
            frame, mask, place, velocity, yaw, rate = given
            moving.send(
                mavlink.MAVLink_set_position_target_local_ned_message(
                    0, system, 1, frame, mask, *place, *velocity, 0, 0, 0, yaw, rate
                )
            )
        case "attitude":
            q, thrust = given
            moving.send(
                mavlink.MAVLink_set_attitude_target_message(0, system, 1, 0, q, 0, 0, 0, thrust)
            )
        case "manual":
            moving.send(mavlink.MAVLink_manual_control_message(system, *given[0], 0))
        case "rc":
            moving.send(mavlink.MAVLink_rc_channels_override_message(system, 1, *given[0]))
        case "command":
            moving.command(given[0], *given[1])
        case "mode":
            moving.command(mavlink.MAV_CMD_DO_SET_MODE, 1, given[0])


MISSION = """QGC WPL 110
0\t1\t0\t16\t0\t0\t0\t0\t{lat}\t{lon}\t0\t1
1\t0\t3\t16\t0\t0\t0\t0\t{north}\t{lon}\t-5\t1
2\t0\t3\t16\t0\t0\t0\t0\t{lat}\t{lon}\t-2\t1
"""


def under(vehicle, folder, given):
    """Run a short mission of a vehicle under orders; return its true motion in the end."""
    profile = load_profile(vehicle)
    with Moving(vehicle, plan_folder=str(folder)) as moving:
        moving.step()
        moving.send(mavlink.MAVLink_heartbeat_message(6, 8, 0, 0, 4, 3))
        moving.command(mavlink.MAV_CMD_COMPONENT_ARM_DISARM, 1, 21196)
        moving.command(mavlink.MAV_CMD_MISSION_START)
        for order in given:
            carry_out(moving, profile.tunables("links.ground"), order)
            for _ in range(8):
                moving.step()
        for _ in range(100):
            moving.step()
        return moving.truth()


def planned(vehicle, folder):
    home = load_profile(vehicle).file.home
    latitude, longitude = (
        math.degrees(quantity(one, "rad")) for one in (home.latitude, home.longitude)
    )
    text = MISSION.format(lat=latitude, lon=longitude, north=latitude + 2e-4)
    (folder / "mission.waypoints").write_text(text)


@pytest.mark.slow
@pytest.mark.parametrize("examples", [1, pytest.param(20, marks=pytest.mark.long)])
@pytest.mark.parametrize("vehicle", VEHICLES)
def test_a_short_mission_under_extreme_orders_goes_on(vehicle, examples, tmp_path):
    """First with what ended a mission once, and all tunables at either end."""
    planned(vehicle, tmp_path)
    count = len(load_profile(vehicle).tunables("links.ground"))
    huge = [("setting", name, 1e30) for name in ("WPNAV_SPEED", "CRUISE_SPEED", "WP_SPEED")]
    ends = [("parameter", n, ("low", "high")[n % 2]) for n in range(count)]

    @settings(max_examples=examples, deadline=None, derandomize=True, phases=PHASES)
    @example([*huge, *ends])
    @given(st.lists(orders, min_size=20, max_size=40))
    def goes_on(given):
        truth = under(vehicle, tmp_path, given)
        assert all(math.isfinite(truth[name]) for name in ("north", "east", "down", "p", "q", "r"))

    goes_on()
