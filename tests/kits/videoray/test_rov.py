"""The vehicle as a component: timing, measurements, control, watchdog, reboot, state."""

import json
import math

import pytest

from seatrial.errors import InputError
from seatrial.links.text import Inbox
from seatrial_kits.videoray.frame import Frame, encode
from seatrial_kits.videoray.half_duplex import byte_time
from seatrial_kits.videoray.replies import read, read_memory
from seatrial_kits.videoray.rov import Pro4Rov
from seatrial_kits.videoray.station import Commands, manipulator_request
from seatrial_kits.videoray.stream_file import read_stream

from .bench import PACKETS, STEP, Line, frames, request

AT_ONCE = "port_slew_rate 1; starboard_slew_rate 1; vertical_slew_rate 1"


def drive(flags=0, **commands):
    return Frame(False, 1, flags, 0, Commands(**commands).block())


def reading(line, number=5):
    (answer,) = line.exchange(request(flags=number))
    return read(number, answer.payload[1:]).values


# ------------------------------------------------------------------ time


def test_a_cycle_takes_the_half_duplex_time_and_the_answer_is_there_within_a_step():
    line = Line(Pro4Rov)
    line.send(PACKETS[6])
    ((begin, data),) = line.step()
    byte = byte_time(115_200)
    assert begin == 23 * byte
    assert begin + len(data) * byte == pytest.approx(65 * 10 / 115_200 * 1e9, abs=65)
    line.step(9)
    line.send(PACKETS[8])
    begun = line.now
    ((begin, data),) = line.step(2)
    assert begin - begun + len(data) * byte == pytest.approx(347 * 10 / 115_200 * 1e9, abs=347)


def test_an_answer_waits_until_the_line_is_free():
    line = Line(Pro4Rov, turnaround=0.001)
    line.send(PACKETS[0] * 2)
    (first, data), (second, _) = line.step(2)
    byte = byte_time(115_200)
    assert first == 16 * byte + 1_000_000  # not while the other request is still coming
    assert second == first + len(data) * byte + 1_000_000


@pytest.mark.parametrize("baud", [9600, 115_200])
def test_a_request_is_received_when_its_last_byte_is(baud):
    line = Line(Pro4Rov, baud=float(baud))
    line.send(PACKETS[6])
    steps = math.ceil(23 * 10 / baud / STEP - 1e-9)
    assert line.step(steps - 1) == []
    assert len(line.step()) == 1


# ------------------------------------------------------------------ measurements


def test_measurements_at_their_scalings():
    line = Line(Pro4Rov)
    line.component.set("attitude", [math.radians(-3.0), math.radians(3.7), math.radians(359.96)])
    line.component.set("depth", 10.0)
    line.component.set("specific_force", [0.615, 0.510, -9.035])
    line.component.set("rates", [0.1, 0.2, -0.3])
    line.component.set("magnetometer", [374.0, -699.0, 1937.0])
    line.component.set("water_temperature", 284.25)
    line.component.set("humidity", 0.48)
    values = reading(line)
    expected = {
        "heading": 0.0,
        "pitch": 3.7,
        "roll": -3.0,
        "pressure": round(1013.25 + 1000 * 9.80665 * 10 / 100),
        "roll_acceleration": 100,
        "pitch_acceleration": 200,
        "yaw_acceleration": -300,
        "surge_acceleration": 0.615,
        "sway_acceleration": 0.51,
        "heave_acceleration": -9.035,
        "magnetometer_x": 374,
        "magnetometer_y": -699,
        "magnetometer_z": 1937,
        "water_temperature": 11.1,
        "humidity": 0.48,
        "total_power": 1.0,
    }
    assert {name: values[name] for name in expected} == pytest.approx(expected)


@pytest.mark.parametrize(("how", "expected"), [("full", 270.0), ("half", -90.0)])
def test_both_ways_to_count_headings(how, expected):
    line = Line(Pro4Rov, heading_range=how)
    line.component.set("attitude", [0.0, 0.0, -math.pi / 2])
    assert reading(line, 2)["heading"] == pytest.approx(expected)


def test_pressure_has_an_offset_and_a_density():
    line = Line(Pro4Rov, depth_offset=1.0, density=1025.0, surface_pressure=100_000.0)
    line.component.set("depth", 4.0)
    assert reading(line, 2)["pressure"] == round(1000 + 1025 * 9.80665 * 5 / 100)


def test_what_is_beyond_a_register_is_set_to_its_end():
    line = Line(Pro4Rov)
    line.component.set("depth", 1e6)
    line.component.set("specific_force", [1e3, -1e3, 0.0])
    (answer,) = line.exchange(request(flags=0x80))
    values = read_memory(0, answer.payload[1:]).values
    assert values["pressure"] == 65535
    assert values["surge_acceleration"] == pytest.approx(32.767)
    assert values["sway_acceleration"] == pytest.approx(-32.768)


def test_run_time_and_greatest_depth_outlive_a_reboot():
    line = Line(Pro4Rov, reboot_time=0.0)
    line.component.set("depth", 20.0)
    line.step(400)
    line.component.set("depth", 1.0)
    line.exchange(request(address=0xFE, payload=b"\xde\xad"))
    line.step(200)
    (answer,) = line.exchange(request(flags=0x80))
    values = read_memory(0, answer.payload[1:]).values
    assert values["run_time"] == 6
    assert values["max_depth"] == round(1013.25 + 98.0665 * 20)


# ------------------------------------------------------------------ lights, camera, gripper


def test_lights_and_camera():
    line = Line(Pro4Rov)
    line.exchange(
        drive(lights=0.7, camera_tilt=-45.0, camera_focus=0.3, camera_control=2, camera_buttons=5)
    )
    assert line["lights"] == pytest.approx(0.7)
    assert line["camera_tilt"] == pytest.approx(math.radians(-45))
    assert line["camera_focus"] == pytest.approx(0.3)
    assert line["camera_select"] is True
    assert line["camera_buttons"] == 5


@pytest.mark.parametrize(("raw", "lights", "tilt"), [(b"\xff\x7f", 1.0, 90), (b"\0\x80", 0.0, -90)])
def test_lights_and_tilt_have_ends(raw, lights, tilt):
    line = Line(Pro4Rov)
    line.exchange(request(address=6, payload=raw))
    assert (line["lights"], math.degrees(line["camera_tilt"])) == pytest.approx((lights, tilt))


def test_the_gripper_and_what_is_passed_on():
    line = Line(Pro4Rov)
    asked = manipulator_request(1)
    assert encode(asked).hex() == "faaf4200f008ef35490000000003007f"
    assert line.exchange(asked) == []
    assert line["manipulator"] == 1
    ((_, data),) = Inbox({}).take(line["accessory_tx"])
    assert frames(data) == [asked]


# ------------------------------------------------------------------ thrusters


@pytest.mark.parametrize("target", [1.0, 0.5, 0.01, 0.0, -0.5, -1.0])
def test_dead_band_is_jumped_over_and_full_is_the_limit(target):
    line = Line(Pro4Rov, registers=AT_ONCE)
    line.exchange(drive(thrust=(target, -target, target)), steps=15)
    sign = math.copysign(1.0, target)
    expected = sign * (0.38 + abs(target) * (0.92 - 0.38)) if target else 0.0
    assert line["duty"][0] == pytest.approx(expected)
    assert line["duty"][1] == pytest.approx(-expected)
    share = sign * (abs(expected) - 0.38) / 0.62 if target else 0.0
    assert line["command"][0] == pytest.approx(share)
    vertical = sign * abs(target) * (0.9 - 0.4) / 0.6 if target else 0.0
    assert line["command"][2] == pytest.approx(-vertical)  # a positive number is upwards


def test_without_compensation_small_commands_do_nothing():
    line = Line(Pro4Rov, registers=AT_ONCE, compensation="off")
    line.exchange(drive(thrust=(0.4, 0.5, 0.0)), steps=15)
    assert line["duty"][0] == 0.0
    assert line["duty"][1] == pytest.approx(0.46)


def test_the_vertical_thruster_may_push_downwards():
    line = Line(Pro4Rov, registers=AT_ONCE, vertical_ahead="down")
    line.exchange(drive(thrust=(0.0, 0.0, 1.0)), steps=15)
    assert line["command"][2] > 0.8


@pytest.mark.parametrize(
    ("unit", "rate", "after_a_second"),
    [("per-loop", 0.01, 0.1), ("per-second", 0.3, 0.3), ("per-millisecond", 0.0005, 0.5)],
)
def test_slew_rates(unit, rate, after_a_second):
    line = Line(Pro4Rov, slew_unit=unit, registers=f"port_slew_rate {rate}", watchdog=0.0)
    line.step(5)
    line.exchange(drive(thrust=(1.0, 0.0, 0.0)), steps=100)
    duty = 0.38 + after_a_second * 0.54
    assert line["duty"][0] == pytest.approx(duty)


def test_the_map_written_by_the_topside_applies():
    line = Line(Pro4Rov, registers=AT_ONCE)
    config = (0).to_bytes(2, "little"), (500).to_bytes(2, "little")
    line.exchange(request(address=0x14, payload=config[0]))
    line.exchange(request(address=0x1A, payload=config[1]))
    line.exchange(drive(thrust=(1.0, 0.0, 0.0)), steps=15)
    assert line["duty"][0] == pytest.approx(0.5)


@pytest.mark.parametrize("raw", [150, 32767, -32768])
def test_targets_beyond_100_percent_are_full(raw):
    line = Line(Pro4Rov, registers=AT_ONCE)
    line.exchange(request(payload=raw.to_bytes(2, "little", signed=True)), steps=15)
    assert line["duty"][0] == pytest.approx(math.copysign(0.92, raw))


def test_low_voltage_takes_power_away_and_gives_it_back():
    line = Line(
        Pro4Rov,
        registers=f"{AT_ONCE}; voltage_decrement 0.1; voltage_increment 0.1; current_increment 0.1",
        watchdog=0.0,
    )
    line.component.set("tether_voltage", 30.0)
    line.exchange(drive(thrust=(1.0, 0.0, 0.0)), steps=100)
    assert line["duty"][0] == pytest.approx(0.38 + 0.5 * 0.54)  # the least power is 50 %
    assert reading(line)["total_power"] == pytest.approx(0.5)
    line.component.set("tether_voltage", 75.0)
    line.step(6000)
    assert line["duty"][0] == pytest.approx(0.92)


# ------------------------------------------------------------------ auto depth and heading


def test_auto_heading_turns_the_short_way_with_the_captured_gains():
    line = Line(Pro4Rov, registers=AT_ONCE)
    line.component.set("attitude", [0.0, 0.0, math.radians(350)])
    line.exchange(drive(auto_heading=10.0), steps=11)
    # K (P e + I e) = 0.1 (0.06 20 + 0.004 20), at the first loop
    assert line["duty"][0] == pytest.approx(0.38 + 0.128 * 0.54)
    assert line["duty"][1] == pytest.approx(-(0.38 + 0.128 * 0.54))
    assert line["auto_heading"] is True
    (answer,) = line.exchange(request(flags=0x80))
    values = read_memory(0, answer.payload[1:]).values
    terms = [values[f"auto_heading_{x}"] for x in ("p_term", "i_term", "d_term", "output")]
    assert terms == pytest.approx([1.2, 0.08, 0.0, 1.28])


def test_auto_depth_with_the_captured_gains():
    line = Line(Pro4Rov, registers=AT_ONCE)
    line.component.set("depth", 1.0)  # 1111 mbar
    line.exchange(drive(auto_depth=1116.0), steps=11)
    # P e + I e = -0.02 5 - 0.0004 5: downwards
    assert line["duty"][2] == pytest.approx(-(0.4 + 0.102 * 0.5))
    assert line["command"][2] == pytest.approx(0.102 * 0.5 / 0.6)
    assert line["auto_depth"] is True


def test_manual_control_and_auto_heading_add_up():
    line = Line(Pro4Rov, registers=AT_ONCE)
    line.exchange(drive(thrust=(0.5, 0.5, 0.0), auto_heading=20.0), steps=11)
    assert line["duty"][0] == pytest.approx(0.38 + 0.628 * 0.54)
    assert line["duty"][1] == pytest.approx(0.38 + 0.372 * 0.54)


def test_the_sum_does_not_grow_while_the_output_is_clipped():
    line = Line(Pro4Rov, registers=AT_ONCE, watchdog=0.0)
    line.component.set("depth", 0.0)
    line.exchange(drive(auto_depth=3000.0), steps=1000)
    line.component.set("depth", 21.0)  # beyond it: no sum is left to hold it down
    line.step(20)
    assert line["command"][2] < 0.0


# ------------------------------------------------------------------ watchdog, cut, reboot


@pytest.mark.parametrize("seconds", [0.5, 1.0])
def test_the_watchdog_stops_the_thrusters_within_its_time_and_recovers(seconds):
    line = Line(Pro4Rov, registers=AT_ONCE, watchdog=seconds)
    line.exchange(drive(thrust=(1.0, 1.0, 1.0), lights=0.5), steps=15)
    line.step(round(seconds / STEP) - 15)
    assert line["command"][0] > 0.8
    line.step()  # the block itself took 2 ms
    assert line["command"] == [0.0, 0.0, 0.0]
    assert line["commanded"] is False
    assert line["lights"] == 0.5
    line.exchange(request(flags=5), steps=30)  # a question is no command
    assert line["command"][0] == 0.0
    line.exchange(drive(thrust=(1.0, 1.0, 1.0)), steps=15)
    assert line["command"][0] > 0.8


def test_without_watchdog_it_goes_on():
    line = Line(Pro4Rov, registers=AT_ONCE, watchdog=0.0)
    line.exchange(drive(thrust=(1.0, 1.0, 1.0)), steps=1000)
    assert line["command"][0] > 0.8


def test_a_cut_line_carries_nothing():
    line = Line(Pro4Rov)
    line.component.set("cut", True)
    assert line.exchange(request(flags=1)) == []
    line.component.set("cut", False)
    assert len(line.exchange(request(flags=1))) == 1


def test_during_a_reboot_it_receives_and_sends_nothing():
    line = Line(Pro4Rov, registers=AT_ONCE, reboot_time=0.5, watchdog=0.0)
    line.exchange(drive(thrust=(1.0, 1.0, 1.0), lights=1.0), steps=15)
    answers = line.exchange(request(flags=1, address=0xFE, payload=b"\xde\xad"))
    assert len(answers) == 1  # before it goes
    assert (line["command"], line["lights"]) == ([0.0, 0.0, 0.0], 0.0)
    assert line.exchange(request(flags=1), steps=40) == []
    line.step(10)
    assert len(line.exchange(request(flags=1))) == 1


def test_errors_are_counted_in_their_register_until_a_reboot():
    line = Line(Pro4Rov, reboot_time=0.0)
    wrong = bytearray(PACKETS[6])
    wrong[-1] ^= 1
    for _ in range(3):
        line.send(bytes(wrong))
        assert line.step(10) == []
    line.send(PACKETS[6][:12])  # broken off
    line.step(10)
    (answer,) = line.exchange(request(flags=0x82, address=0x86))
    assert answer.payload[1:] == b"\4\0"
    assert line["communication_errors"] == 4
    line.exchange(request(address=0xFE, payload=b"\xde\xad"))
    (answer,) = line.exchange(request(flags=0x82, address=0x86))
    assert answer.payload[1:] == b"\0\0"


# ------------------------------------------------------------------ state, record, mistakes


def test_restored_state_goes_on_identically():
    line = Line(Pro4Rov, gains="holding")
    line.component.set("depth", 1.3)
    line.exchange(drive(flags=5, auto_depth=1200.0, auto_heading=30.0), steps=43)
    line.send(PACKETS[6][:9])
    line.step()

    def go_on(component):
        found = []
        for number in range(100):
            component.set("depth", 1.3 + 0.01 * number)
            component.advance((line.now + number * 10_000_000) / 1e9, STEP)
            found.append([component.get(name) for name in ("tx", "command", "duty", "requests")])
        return found

    state = json.loads(json.dumps(line.component.get_state()["parts"]))
    whole = {**line.component.get_state(), "parts": state}
    first = go_on(line.component)
    other = Pro4Rov("other")
    for name in ("gains",):
        other.set(name, "holding")
    other.set_state(whole)
    assert go_on(other) == first
    line.component.set_state(whole)
    assert go_on(line.component) == first
    assert first[0][1] != first[-1][1]


def test_the_record_has_both_ways(tmp_path):
    line = Line(Pro4Rov)
    line.component.set("run_folder", str(tmp_path))
    line.send(PACKETS[2])
    line.step(3)
    line.component.close()
    (path,) = tmp_path.iterdir()
    assert path.name == "Pro4Rov.stream"
    byte = byte_time(115_200)
    assert list(read_stream(path)) == [(0, ">", PACKETS[2]), (8 * byte, "<", PACKETS[3])]


@pytest.mark.parametrize(
    ("parameters", "message"),
    [
        ({"serial_number": "J" * 17}, "Pro4Rov: serial_number"),
        ({"firmware": "two"}, "Pro4Rov: firmware"),
        ({"registers": "auto_dept_p 1"}, "did you mean 'auto_depth_p'"),
        ({"gains": "held"}, "captured, holding"),
    ],
)
def test_mistakes_are_reported(parameters, message):
    with pytest.raises(InputError, match=message):
        Line(Pro4Rov, **parameters)
