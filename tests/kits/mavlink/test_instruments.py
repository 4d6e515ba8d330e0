"""Instruments of a ground station: throttle, satellites, filter, battery, outputs, channels."""

import math

import pytest
from pymavlink.dialects.v20 import all as mavlink

from seatrial.links.servos import read_servos
from seatrial_kits.mavlink.outputs import Outputs
from seatrial_kits.mavlink.telemetry.estimator import Innovation
from seatrial_kits.mavlink.vehicle import Receiver

from .bench import Bench

CATAMARAN = "1 port 1100 1500 1900; 3 starboard 1000 1500 2000 reversed"
ROV = "1 port 1100 1500 1900; 2 starboard 1100 1500 1900; 3 vertical 1200 1500 1700 reversed"


@pytest.mark.parametrize(
    ("pulses", "throttle"),
    [
        ((1700e-6, 0.0, 1250e-6), 0.5),
        ((1900e-6, 0.0, 2000e-6), 0.0),  # turns on the spot
        ((1300e-6, 0.0, 1750e-6), 0.5),  # astern
        ((0.0, 1900e-6, 0.0), None),  # no propelling output has a pulse
    ],
)
def test_throttle_is_that_of_the_outputs(pulses, throttle):
    assert Outputs(read_servos(CATAMARAN)).throttle(pulses) == pytest.approx(throttle)


def test_shares_of_thrust_are_shown_as_pulses():
    outputs = Outputs(read_servos(ROV))
    shares = {"port": 0.5, "starboard": -1.5, "vertical": -1.0}
    assert outputs.pulses((0.0,) * 16, shares)[:4] == pytest.approx((1.7e-3, 1.1e-3, 1.7e-3, 0.0))
    measured = (1.6e-3, *(0.0,) * 15)
    assert outputs.pulses(measured, shares) == measured


def test_throttle_shows_in_auto():
    bench = Bench()
    bench.measure(throttle=0.42)
    number = mavlink.MAVLINK_MSG_ID_VFR_HUD
    assert bench.one(number).throttle == 0  # disarmed
    bench.arm()
    assert bench.one(number).throttle == 42


def test_satellites_are_the_receivers():
    bench = Bench()
    bench.vehicle.receiver = Receiver(mavlink.GPS_FIX_TYPE_RTK_FIXED, 20, 0.7)
    m = bench.one(mavlink.MAVLINK_MSG_ID_GPS_RAW_INT)
    assert (m.fix_type, m.satellites_visible, m.eph) == (6, 20, 70)
    bench.measure(position_valid=False)
    m = bench.one(mavlink.MAVLINK_MSG_ID_GPS_RAW_INT)
    assert (m.fix_type, m.satellites_visible, m.eph) == (1, 0, 65535)


def filter_of(bench):
    return bench.one(mavlink.MAVLINK_MSG_ID_EKF_STATUS_REPORT)


def test_variances_grow_while_a_sensor_is_lost_and_fall_again():
    bench = Bench()
    bench.wait(1.0)
    assert filter_of(bench).pos_horiz_variance == 0.0
    bench.measure(position_valid=False)
    bench.wait(5.0)
    assert filter_of(bench).pos_horiz_variance == pytest.approx(0.5, abs=0.01)
    assert filter_of(bench).compass_variance == 0.0
    bench.measure(heading_valid=False)
    bench.wait(10.0)
    assert filter_of(bench).pos_horiz_variance == pytest.approx(1.5, abs=0.01)
    assert filter_of(bench).compass_variance == pytest.approx(1.0, abs=0.01)
    for k in range(50):
        bench.measure(position_valid=True, position_n=(0.2 * k, 0.0, 0.0), velocity_n=(1, 0, 0))
        bench.wait(0.2)
    assert filter_of(bench).pos_horiz_variance < 0.05


def test_an_innovation_is_what_the_rate_does_not_predict():
    steady, jumping, turning = Innovation(5.0), Innovation(5.0), Innovation(0.5, turns=True)
    for k in range(100):
        steady.update(0.2 * k, (0.3 * k, 1.0), (1.5, 0.0), valid=True)
        jumping.update(0.2 * k, (0.3 * k + 5.0 * (k % 2), 1.0), (1.5, 0.0), valid=True)
        turning.update(0.2 * k, (math.remainder(0.2 * k, math.tau),), (1.0,), valid=True)
    assert steady.ratio == pytest.approx(0.0, abs=1e-9)
    assert jumping.ratio == pytest.approx(1.0, abs=0.01)
    assert turning.ratio == pytest.approx(0.0, abs=1e-9)


def test_a_px4_reports_its_estimator():
    number = mavlink.MAVLINK_MSG_ID_ESTIMATOR_STATUS
    m = Bench(autopilot="px4").one(number)
    assert m.flags & mavlink.ESTIMATOR_POS_HORIZ_ABS
    assert m.flags & mavlink.ESTIMATOR_ATTITUDE
    assert Bench().request(number)[0] == mavlink.MAV_RESULT_DENIED


LOW = {"battery_capacity": 36000.0, "battery_low_voltage": 14.0, "battery_low_charge": 0.2}


@pytest.mark.parametrize("measured", [{"voltage": 13.9}, {"voltage": 15.0, "charge": 0.19}])
def test_a_low_battery_is_a_failsafe(measured):
    bench = Bench(**LOW, battery_action="return")
    bench.arm()
    bench.measure(voltage=13.0, charge=0.5)
    bench.wait(9.0)
    bench.measure(voltage=15.0)  # it was a short load
    bench.wait(2.0)
    assert bench.vehicle.mode.name == "hold"
    bench.measure(**measured)
    bench.wait(10.5)
    assert bench.vehicle.mode.name == "return"
    assert any("battery low, return" in text for text in bench.texts())
    bench.enter("manual")  # whoever takes over is left alone
    bench.wait(20.0)
    assert bench.vehicle.mode.name == "manual"


def test_battery_status_says_what_is_drawn_and_that_it_is_low():
    bench = Bench(**LOW)
    bench.measure(voltage=15.0, current=2.0, charge=0.75)
    number = mavlink.MAVLINK_MSG_ID_BATTERY_STATUS
    m = bench.one(number)
    assert (m.current_consumed, m.battery_remaining) == (2500, 75)  # of 10 A.h, mA.h
    assert m.charge_state == mavlink.MAV_BATTERY_CHARGE_STATE_OK
    bench.measure(charge=0.1)
    assert bench.one(number).charge_state == mavlink.MAV_BATTERY_CHARGE_STATE_LOW


def test_limits_of_the_battery_are_parameters():
    bench = Bench(battery_capacity=36000.0)
    assert bench.parameters["BATT_CAPACITY"] == 10_000
    assert bench.parameters.put("BATT_LOW_MAH", 2500.0) is None
    assert bench.parameters.put("BATT_FS_LOW_ACT", 1) is None
    assert bench.settings.battery_low_charge == 0.25
    assert bench.settings.battery_action == "return"
    assert Bench().parameters.put("BATT_LOW_MAH", 1.0) is not None


def test_axes_of_a_joystick_show_as_channels():
    rov = Bench(submerged=True)
    number = mavlink.MAVLINK_MSG_ID_RC_CHANNELS
    assert rov.one(number).chan5_raw == 65535
    rov.receive(mavlink.MAVLink_manual_control_message(7, 500, -1000, 750, 0, 0))
    m = rov.one(number)
    found = (m.chan1_raw, m.chan3_raw, m.chan4_raw, m.chan5_raw, m.chan6_raw)
    assert found == (65535, 1700, 1500, 1700, 1100)


def test_the_board_reports_inertia_vibration_and_distances():
    bench = Bench()
    bench.measure(ground_distance=4.5, specific_force=(0.0, 0.0, -9.80665))
    bench.wait(1.0)
    raw = bench.one(mavlink.MAVLINK_MSG_ID_RAW_IMU)
    assert (raw.xacc, raw.zacc) == (0, -1000)
    assert bench.one(mavlink.MAVLINK_MSG_ID_VIBRATION).vibration_z == pytest.approx(0.0, abs=1e-9)
    assert bench.one(mavlink.MAVLINK_MSG_ID_RANGEFINDER).distance == 4.5
    assert bench.one(mavlink.MAVLINK_MSG_ID_WATER_DEPTH).distance == 4.5
    assert bench.one(mavlink.MAVLINK_MSG_ID_POWER_STATUS).Vcc == 5000
    assert bench.one(mavlink.MAVLINK_MSG_ID_AHRS2).lat == -317800000
    for k in range(100):
        bench.measure(specific_force=(0.0, 0.0, -9.80665 + (3.0 if k % 2 else -3.0)))
        bench.tick()
    shaken = bench.one(mavlink.MAVLINK_MSG_ID_VIBRATION)
    assert shaken.vibration_z == pytest.approx(3.0, abs=0.5)
    assert shaken.vibration_x == pytest.approx(0.0, abs=1e-9)
    submarine = Bench(submerged=True)
    submarine.measure(ground_distance=4.5)
    assert submarine.request(mavlink.MAVLINK_MSG_ID_WATER_DEPTH)[0] == mavlink.MAV_RESULT_DENIED


def test_where_it_goes_is_a_position_target():
    bench = Bench()
    number = mavlink.MAVLINK_MSG_ID_POSITION_TARGET_GLOBAL_INT
    assert bench.request(number)[0] == mavlink.MAV_RESULT_DENIED
    bench.enter("return")
    m = bench.one(number)
    assert (m.lat_int, m.lon_int, m.type_mask) == (-317800000, -522600000, 0xFDF8)


def test_speed_controllers_report_speed_current_and_charge():
    bench, number = Bench(), mavlink.MAVLINK_MSG_ID_ESC_TELEMETRY_1_TO_4
    bench.measure(motor_speeds=(0.0,) * 4, motor_currents=(0.0,) * 4)
    bench.wait(1.0)
    result, none = bench.request(number)
    assert (result, none) == (mavlink.MAV_RESULT_DENIED, [])
    turns = 50.0 * math.tau  # 3000 rpm
    bench.measure(
        voltage=14.8, motor_speeds=(turns, -turns / 2, 0, 0), motor_currents=(7.2, 3.6, 0.0, 0.0)
    )
    bench.wait(10.0)
    m = bench.one(number)
    assert m.rpm == [3000, 1500, 0, 0]
    assert m.current == [720, 360, 0, 0]
    assert m.voltage == [1480] * 4
    # 7.2 A for 10 s are 20 mA.h.
    assert m.totalcurrent[0] == pytest.approx(20, abs=1)
    assert m.totalcurrent[2] == 0
    assert m.count[0] > 10
