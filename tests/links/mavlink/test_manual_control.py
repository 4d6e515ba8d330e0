import pytest
from pymavlink.dialects.v20 import all as mavlink

from .bench import OTHER_STATION, Bench

RELEASED = (0.0, 0.0, 0.0, 0.0)


def manual(x=0, y=0, z=0, r=0, target=7):
    return mavlink.MAVLink_manual_control_message(target, x, y, z, r, 0)


def override(system=7, **channels):
    """Return an override of channels ``c1``...; all others are left as they are."""
    ignored = [0xFFFF] * 8 + [0] * 10
    for name, width in channels.items():
        ignored[int(name[1:]) - 1] = width
    return mavlink.MAVLink_rc_channels_override_message(system, 1, *ignored)


@pytest.mark.parametrize(
    ("options", "message", "manual"),
    [
        ({}, manual(z=1000), (1.0, 0.0, 0.0, 0.0)),
        ({}, manual(z=-500, y=250), (-0.5, 0.0, 0.25, 0.0)),
        ({}, manual(x=900, r=900, z=0), RELEASED),  # a boat has neither
        ({}, manual(z=30000, y=-30000), (1.0, 0.0, -1.0, 0.0)),
        ({}, manual(z=0x7FFF, y=500), (0.0, 0.0, 0.5, 0.0)),  # an axis that is not there
        ({"autopilot": "px4"}, manual(z=1000, y=-1000), (1.0, 0.0, -1.0, 0.0)),
        ({"autopilot": "px4"}, manual(z=500), RELEASED),
        ({"submerged": True}, manual(x=300, y=-200, z=500, r=100), (0.3, -0.2, 0.1, 0.0)),
        ({"submerged": True}, manual(z=1000), (0.0, 0.0, 0.0, -1.0)),  # up
        ({"submerged": True}, manual(z=250), (0.0, 0.0, 0.0, 0.5)),
    ],
)
def test_axes_of_manual_control(options, message, sticks):
    bench = Bench(**options)
    bench.hear(message)
    assert bench.vehicle.sticks == pytest.approx(sticks)


@pytest.mark.parametrize(
    ("options", "message", "manual"),
    [
        ({}, override(c3=1900), (1.0, 0.0, 0.0, 0.0)),
        ({}, override(c1=1100, c3=1700), (0.5, 0.0, -1.0, 0.0)),
        ({}, override(c1=2200), (0.0, 0.0, 1.0, 0.0)),
        ({"submerged": True}, override(c5=1700), (0.5, 0.0, 0.0, 0.0)),
        ({"submerged": True}, override(c6=1300, c4=1600), (0.0, -0.5, 0.25, 0.0)),
        ({"submerged": True}, override(c3=1900), (0.0, 0.0, 0.0, -1.0)),
    ],
)
def test_channels(options, message, sticks):
    bench = Bench(**options)
    bench.hear(message)
    assert bench.vehicle.sticks == pytest.approx(sticks)


def test_a_channel_is_left_changed_or_released():
    bench = Bench()
    bench.hear(override(c1=1900, c3=1900, c9=1700))
    bench.hear(override(c3=1500))
    assert bench.vehicle.sticks == (0.0, 0.0, 1.0, 0.0)
    bench.hear(override(c1=0))
    assert bench.vehicle.sticks == RELEASED
    channels = bench.one(mavlink.MAVLINK_MSG_ID_RC_CHANNELS)
    assert (channels.chan1_raw, channels.chan3_raw, channels.chan9_raw) == (65535, 1500, 1700)
    bench.hear(override(c9=65534))
    assert bench.one(mavlink.MAVLINK_MSG_ID_RC_CHANNELS).chan9_raw == 65535


def test_sticks_for_another_vehicle_are_not_ours():
    bench = Bench()
    bench.hear(manual(z=1000, target=8))
    bench.hear(override(8, c3=1900))
    assert bench.vehicle.sticks == RELEASED


@pytest.mark.parametrize("message", [manual(z=1000), override(c3=1900)])
def test_sticks_that_nobody_holds_let_go_and_the_failsafe_acts(message):
    bench = Bench(manual_timeout=2.0)
    bench.enter("manual")
    bench.arm()
    for _ in range(5):
        bench.hear(message)
        bench.wait(1.9)
        assert bench.vehicle.sticks == (1.0, 0.0, 0.0, 0.0)
    bench.wait(0.1)
    assert bench.vehicle.sticks[0] == 1.0
    bench.tick()
    assert bench.vehicle.sticks == RELEASED
    assert (bench.vehicle.mode.name, bench.vehicle.armed) == ("hold", True)
    assert bench.vehicle.failsafe
    bench.hear(message)
    assert not bench.vehicle.failsafe
    assert bench.vehicle.mode.name == "hold"  # nobody is thrown back into manual


def test_what_is_said_of_lost_sticks():
    bench = Bench(manual_timeout=1.0)
    bench.enter("manual")
    bench.arm()
    bench.hear(manual(z=1))
    bench.texts()
    bench.wait(2.0)
    said = [m.text for m in bench.air.take("STATUSTEXT")]
    assert said == ["Failsafe: sticks lost, hold", "Mode HOLD"]


def test_who_releases_all_channels_has_let_go_on_purpose():
    bench = Bench()
    bench.enter("manual")
    bench.arm()
    bench.hear(override(c1=1900, c3=1900))
    bench.hear(override(c1=0, c3=0))
    assert bench.vehicle.sticks == RELEASED
    bench.wait(10.0)
    assert (bench.vehicle.mode.name, bench.vehicle.failsafe) == ("manual", False)


def test_sticks_lost_in_another_mode_are_nothing():
    bench = Bench()
    bench.arm()
    bench.hear(manual(z=1000))
    bench.wait(10.0)
    assert bench.vehicle.sticks == RELEASED
    assert (bench.vehicle.mode.name, bench.vehicle.failsafe) == ("hold", False)


def test_the_newest_hand_wins():
    bench = Bench()
    bench.hear(manual(z=1000))
    bench.hear(manual(z=-1000), OTHER_STATION)
    assert bench.vehicle.sticks == (-1.0, 0.0, 0.0, 0.0)
