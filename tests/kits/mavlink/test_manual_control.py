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
    ("options", "message", "axes"),
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
def test_axes_of_manual_control(options, message, axes):
    bench = Bench(**options)
    bench.receive(message)
    assert bench.vehicle.manual == pytest.approx(axes)


@pytest.mark.parametrize(
    ("options", "message", "axes"),
    [
        ({}, override(c3=1900), (1.0, 0.0, 0.0, 0.0)),
        ({}, override(c1=1100, c3=1700), (0.5, 0.0, -1.0, 0.0)),
        ({}, override(c1=2200), (0.0, 0.0, 1.0, 0.0)),
        ({"submerged": True}, override(c5=1700), (0.5, 0.0, 0.0, 0.0)),
        ({"submerged": True}, override(c6=1300, c4=1600), (0.0, -0.5, 0.25, 0.0)),
        ({"submerged": True}, override(c3=1900), (0.0, 0.0, 0.0, -1.0)),
    ],
)
def test_channels(options, message, axes):
    bench = Bench(**options)
    bench.receive(message)
    assert bench.vehicle.manual == pytest.approx(axes)


def test_a_channel_is_left_changed_or_released():
    bench = Bench()
    bench.receive(override(c1=1900, c3=1900, c9=1700))
    bench.receive(override(c3=1500))
    assert bench.vehicle.manual == (0.0, 0.0, 1.0, 0.0)
    bench.receive(override(c1=0))
    assert bench.vehicle.manual == RELEASED
    channels = bench.one(mavlink.MAVLINK_MSG_ID_RC_CHANNELS)
    assert (channels.chan1_raw, channels.chan3_raw, channels.chan9_raw) == (65535, 1500, 1700)
    bench.receive(override(c9=65534))
    assert bench.one(mavlink.MAVLINK_MSG_ID_RC_CHANNELS).chan9_raw == 65535


def test_manual_control_for_another_vehicle_is_not_ours():
    bench = Bench()
    bench.receive(manual(z=1000, target=8))
    bench.receive(override(8, c3=1900))
    assert bench.vehicle.manual == RELEASED


@pytest.mark.parametrize("message", [manual(z=1000), override(c3=1900)])
def test_manual_control_that_stops_is_released_and_the_failsafe_acts(message):
    bench = Bench(manual_timeout=2.0)
    bench.enter("manual")
    bench.arm()
    for _ in range(5):
        bench.receive(message)
        bench.wait(1.9)
        assert bench.vehicle.manual == (1.0, 0.0, 0.0, 0.0)
    bench.wait(0.1)
    assert bench.vehicle.manual[0] == 1.0
    bench.tick()
    assert bench.vehicle.manual == RELEASED
    assert (bench.vehicle.mode.name, bench.vehicle.armed) == ("hold", True)
    assert bench.vehicle.failsafe
    bench.receive(message)
    assert not bench.vehicle.failsafe
    assert bench.vehicle.mode.name == "hold"  # it is not put back into manual


def test_what_is_reported_of_lost_manual_control():
    bench = Bench(manual_timeout=1.0)
    bench.enter("manual")
    bench.arm()
    bench.receive(manual(z=1))
    bench.texts()
    bench.wait(2.0)
    sent = [m.text for m in bench.transport.take("STATUSTEXT")]
    assert sent == ["Failsafe: manual control lost, hold", "Mode HOLD"]


def test_releasing_all_channels_is_on_purpose():
    bench = Bench()
    bench.enter("manual")
    bench.arm()
    bench.receive(override(c1=1900, c3=1900))
    bench.receive(override(c1=0, c3=0))
    assert bench.vehicle.manual == RELEASED
    bench.wait(10.0)
    assert (bench.vehicle.mode.name, bench.vehicle.failsafe) == ("manual", False)


def test_manual_control_lost_in_another_mode_is_nothing():
    bench = Bench()
    bench.arm()
    bench.receive(manual(z=1000))
    bench.wait(10.0)
    assert bench.vehicle.manual == RELEASED
    assert (bench.vehicle.mode.name, bench.vehicle.failsafe) == ("hold", False)


def test_the_newest_hand_wins():
    bench = Bench(autopilot="px4")  # an ArduPilot has one
    bench.receive(manual(z=1000))
    bench.receive(manual(z=0), OTHER_STATION)
    assert bench.vehicle.manual == (-1.0, 0.0, 0.0, 0.0)


def test_only_the_station_of_sysid_mygcs_steers_an_ardupilot():
    bench = Bench()
    for message in (manual(z=1000), override(c3=1900)):
        bench.receive(message, OTHER_STATION)
        assert bench.vehicle.manual == RELEASED
    assert [t for t in bench.texts() if "SYSID_MYGCS" in t] == [
        "System 250 may not steer: SYSID_MYGCS is 255"
    ]
    bench.parameters.put("SYSID_MYGCS", OTHER_STATION.system)
    bench.receive(manual(z=1000), OTHER_STATION)
    assert bench.vehicle.manual[0] == 1.0
    px4 = Bench(autopilot="px4")
    px4.receive(manual(z=1000), OTHER_STATION)
    assert px4.vehicle.manual[0] == 1.0


def press(bench, *buttons, **axes):
    """Press buttons, held with the message, and let go of them."""
    mask = sum(1 << button for button in buttons)
    for held in (mask, mask, 0):
        axis = {"x": 0, "y": 0, "z": 500, "r": 0, **axes}
        bench.receive(mavlink.MAVLink_manual_control_message(7, *axis.values(), held))


ARM, DISARM, SHIFT, MANUAL, DEPTH_HOLD = 6, 4, 5, 1, 2  # buttons, as ArduSub's defaults have them


def test_the_pad_of_a_submarine_arms_and_changes_modes():
    rov = Bench(submerged=True)
    press(rov, MANUAL)
    assert rov.vehicle.mode.name == "manual"
    press(rov, ARM)
    assert rov.vehicle.armed
    press(rov, DEPTH_HOLD)
    assert rov.vehicle.mode.name == "depth-hold"
    press(rov, DISARM)
    assert not rov.vehicle.armed


def test_checks_and_refusals_are_those_of_commands():
    rov = Bench(submerged=True)
    rov.measure(heading_valid=False)
    press(rov, ARM)
    assert not rov.vehicle.armed
    assert any("no heading" in text for text in rov.texts())
    rov.parameters.put("BTN0_FUNCTION", 9)  # auto, without a mission
    press(rov, 0)
    assert any("no mission" in text for text in rov.texts())


def test_a_button_has_another_function_with_the_shift_button():
    rov = Bench(submerged=True)
    rov.parameters.put("BTN2_SFUNCTION", 2)  # arms and disarms
    mode = rov.vehicle.mode
    press(rov, SHIFT, DEPTH_HOLD)
    assert (rov.vehicle.armed, rov.vehicle.mode) == (True, mode)
    press(rov, SHIFT, DEPTH_HOLD)
    assert not rov.vehicle.armed


def test_gain_goes_in_steps_and_stays_within_its_limits():
    rov = Bench(submerged=True)
    less, more = 12, 11
    gains = []
    for button in (less, less, less, less, more):
        press(rov, button, x=1000)
        gains.append(rov.vehicle.manual[0])
    assert gains == pytest.approx([0.75, 0.5, 0.25, 0.25, 0.5])
    assert "#Gain is 50%" in rov.texts()
    assert rov.parameters.put("JS_GAIN_STEPS", 1) is None
    press(rov, less, x=1000)
    assert rov.vehicle.manual[0] == pytest.approx(0.5)


def test_a_function_that_there_is_not_is_refused():
    rov = Bench(submerged=True)
    assert rov.parameters.put("BTN7_FUNCTION", 31).reason.startswith("one of 0, 1, 2")  # lights
    assert "BTN0_FUNCTION" not in Bench().parameters
