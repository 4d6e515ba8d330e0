"""The vehicle as a component: timing, measurements, control, watchdog, reboot, state."""

import json
import math

import pytest

from seatrial.errors import InputError
from seatrial.links.text import Inbox
from seatrial.links.videoray.frame import Frame, encode
from seatrial.links.videoray.half_duplex import byte_time
from seatrial.links.videoray.replies import read, read_memory
from seatrial.links.videoray.rov import Pro4Rov
from seatrial.links.videoray.station import Orders, manipulator_request
from seatrial.links.videoray.stream_file import read_stream

from .bench import PACKETS, STEP, Wired, frames, request

AT_ONCE = "port_slew_rate 1; starboard_slew_rate 1; vertical_slew_rate 1"


def drive(flags=0, **orders):
    return Frame(False, 1, flags, 0, Orders(**orders).block())


def reading(wired, number=5):
    (answer,) = wired.ask(request(flags=number))
    return read(number, answer.payload[1:]).values


# ------------------------------------------------------------------ time


def test_a_cycle_takes_the_half_duplex_time_and_the_answer_is_there_within_a_step():
    wired = Wired(Pro4Rov)
    wired.say(PACKETS[6])
    ((begin, data),) = wired.step()
    byte = byte_time(115_200)
    assert begin == 23 * byte
    assert begin + len(data) * byte == pytest.approx(65 * 10 / 115_200 * 1e9, abs=65)
    wired.step(9)
    wired.say(PACKETS[8])
    begun = wired.now
    ((begin, data),) = wired.step(2)
    assert begin - begun + len(data) * byte == pytest.approx(347 * 10 / 115_200 * 1e9, abs=347)


def test_an_answer_waits_until_the_line_is_free():
    wired = Wired(Pro4Rov, turnaround=0.001)
    wired.say(PACKETS[0] * 2)
    (first, data), (second, _) = wired.step(2)
    byte = byte_time(115_200)
    assert first == 16 * byte + 1_000_000  # not while the other request is still coming
    assert second == first + len(data) * byte + 1_000_000


@pytest.mark.parametrize("baud", [9600, 115_200])
def test_a_request_is_received_when_its_last_byte_is(baud):
    wired = Wired(Pro4Rov, baud=float(baud))
    wired.say(PACKETS[6])
    steps = math.ceil(23 * 10 / baud / STEP - 1e-9)
    assert wired.step(steps - 1) == []
    assert len(wired.step()) == 1


# ------------------------------------------------------------------ measurements


def test_measurements_at_their_scalings():
    wired = Wired(Pro4Rov)
    wired.component.set("attitude", [math.radians(-3.0), math.radians(3.7), math.radians(359.96)])
    wired.component.set("depth", 10.0)
    wired.component.set("specific_force", [0.615, 0.510, -9.035])
    wired.component.set("rates", [0.1, 0.2, -0.3])
    wired.component.set("magnetometer", [374.0, -699.0, 1937.0])
    wired.component.set("water_temperature", 284.25)
    wired.component.set("humidity", 0.48)
    values = reading(wired)
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
    wired = Wired(Pro4Rov, heading_range=how)
    wired.component.set("attitude", [0.0, 0.0, -math.pi / 2])
    assert reading(wired, 2)["heading"] == pytest.approx(expected)


def test_pressure_has_an_offset_and_a_density():
    wired = Wired(Pro4Rov, depth_offset=1.0, density=1025.0, surface_pressure=100_000.0)
    wired.component.set("depth", 4.0)
    assert reading(wired, 2)["pressure"] == round(1000 + 1025 * 9.80665 * 5 / 100)


def test_what_is_beyond_a_register_is_set_to_its_end():
    wired = Wired(Pro4Rov)
    wired.component.set("depth", 1e6)
    wired.component.set("specific_force", [1e3, -1e3, 0.0])
    (answer,) = wired.ask(request(flags=0x80))
    values = read_memory(0, answer.payload[1:]).values
    assert values["pressure"] == 65535
    assert values["surge_acceleration"] == pytest.approx(32.767)
    assert values["sway_acceleration"] == pytest.approx(-32.768)


def test_run_time_and_greatest_depth_outlive_a_reboot():
    wired = Wired(Pro4Rov, reboot_time=0.0)
    wired.component.set("depth", 20.0)
    wired.step(400)
    wired.component.set("depth", 1.0)
    wired.ask(request(address=0xFE, payload=b"\xde\xad"))
    wired.step(200)
    (answer,) = wired.ask(request(flags=0x80))
    values = read_memory(0, answer.payload[1:]).values
    assert values["run_time"] == 6
    assert values["max_depth"] == round(1013.25 + 98.0665 * 20)


# ------------------------------------------------------------------ lights, camera, gripper


def test_lights_and_camera():
    wired = Wired(Pro4Rov)
    wired.ask(
        drive(lights=0.7, camera_tilt=-45.0, camera_focus=0.3, camera_control=2, camera_buttons=5)
    )
    assert wired["lights"] == pytest.approx(0.7)
    assert wired["camera_tilt"] == pytest.approx(math.radians(-45))
    assert wired["camera_focus"] == pytest.approx(0.3)
    assert wired["camera_select"] is True
    assert wired["camera_buttons"] == 5


@pytest.mark.parametrize(("raw", "lights", "tilt"), [(b"\xff\x7f", 1.0, 90), (b"\0\x80", 0.0, -90)])
def test_lights_and_tilt_have_ends(raw, lights, tilt):
    wired = Wired(Pro4Rov)
    wired.ask(request(address=6, payload=raw))
    assert (wired["lights"], math.degrees(wired["camera_tilt"])) == pytest.approx((lights, tilt))


def test_the_gripper_and_what_is_passed_on():
    wired = Wired(Pro4Rov)
    asked = manipulator_request(1)
    assert encode(asked).hex() == "faaf4200f008ef35490000000003007f"
    assert wired.ask(asked) == []
    assert wired["manipulator"] == 1
    ((_, data),) = Inbox({}).take(wired["accessory_tx"])
    assert frames(data) == [asked]


# ------------------------------------------------------------------ thrusters


@pytest.mark.parametrize("target", [1.0, 0.5, 0.01, 0.0, -0.5, -1.0])
def test_dead_band_is_jumped_over_and_full_is_the_limit(target):
    wired = Wired(Pro4Rov, registers=AT_ONCE)
    wired.ask(drive(thrust=(target, -target, target)), steps=15)
    sign = math.copysign(1.0, target)
    expected = sign * (0.38 + abs(target) * (0.92 - 0.38)) if target else 0.0
    assert wired["duty"][0] == pytest.approx(expected)
    assert wired["duty"][1] == pytest.approx(-expected)
    share = sign * (abs(expected) - 0.38) / 0.62 if target else 0.0
    assert wired["command"][0] == pytest.approx(share)
    vertical = sign * abs(target) * (0.9 - 0.4) / 0.6 if target else 0.0
    assert wired["command"][2] == pytest.approx(-vertical)  # a positive number is upwards


def test_without_compensation_small_commands_do_nothing():
    wired = Wired(Pro4Rov, registers=AT_ONCE, compensation="off")
    wired.ask(drive(thrust=(0.4, 0.5, 0.0)), steps=15)
    assert wired["duty"][0] == 0.0
    assert wired["duty"][1] == pytest.approx(0.46)


def test_the_vertical_thruster_may_push_downwards():
    wired = Wired(Pro4Rov, registers=AT_ONCE, vertical_ahead="down")
    wired.ask(drive(thrust=(0.0, 0.0, 1.0)), steps=15)
    assert wired["command"][2] > 0.8


@pytest.mark.parametrize(
    ("unit", "rate", "after_a_second"),
    [("per-loop", 0.01, 0.1), ("per-second", 0.3, 0.3), ("per-millisecond", 0.0005, 0.5)],
)
def test_slew_rates(unit, rate, after_a_second):
    wired = Wired(Pro4Rov, slew_unit=unit, registers=f"port_slew_rate {rate}", watchdog=0.0)
    wired.step(5)
    wired.ask(drive(thrust=(1.0, 0.0, 0.0)), steps=100)
    duty = 0.38 + after_a_second * 0.54
    assert wired["duty"][0] == pytest.approx(duty)


def test_the_map_written_by_the_topside_counts():
    wired = Wired(Pro4Rov, registers=AT_ONCE)
    config = (0).to_bytes(2, "little"), (500).to_bytes(2, "little")
    wired.ask(request(address=0x14, payload=config[0]))
    wired.ask(request(address=0x1A, payload=config[1]))
    wired.ask(drive(thrust=(1.0, 0.0, 0.0)), steps=15)
    assert wired["duty"][0] == pytest.approx(0.5)


@pytest.mark.parametrize("raw", [150, 32767, -32768])
def test_targets_beyond_100_percent_are_full(raw):
    wired = Wired(Pro4Rov, registers=AT_ONCE)
    wired.ask(request(payload=raw.to_bytes(2, "little", signed=True)), steps=15)
    assert wired["duty"][0] == pytest.approx(math.copysign(0.92, raw))


def test_low_voltage_takes_power_away_and_gives_it_back():
    wired = Wired(
        Pro4Rov,
        registers=f"{AT_ONCE}; voltage_decrement 0.1; voltage_increment 0.1; current_increment 0.1",
        watchdog=0.0,
    )
    wired.component.set("tether_voltage", 30.0)
    wired.ask(drive(thrust=(1.0, 0.0, 0.0)), steps=100)
    assert wired["duty"][0] == pytest.approx(0.38 + 0.5 * 0.54)  # the least power is 50 %
    assert reading(wired)["total_power"] == pytest.approx(0.5)
    wired.component.set("tether_voltage", 75.0)
    wired.step(6000)
    assert wired["duty"][0] == pytest.approx(0.92)


# ------------------------------------------------------------------ auto depth and heading


def test_auto_heading_turns_the_short_way_with_the_captured_gains():
    wired = Wired(Pro4Rov, registers=AT_ONCE)
    wired.component.set("attitude", [0.0, 0.0, math.radians(350)])
    wired.ask(drive(auto_heading=10.0), steps=11)
    # K (P e + I e) = 0.1 (0.06 20 + 0.004 20), at the first loop
    assert wired["duty"][0] == pytest.approx(0.38 + 0.128 * 0.54)
    assert wired["duty"][1] == pytest.approx(-(0.38 + 0.128 * 0.54))
    assert wired["auto_heading"] is True
    (answer,) = wired.ask(request(flags=0x80))
    values = read_memory(0, answer.payload[1:]).values
    terms = [values[f"auto_heading_{x}"] for x in ("p_term", "i_term", "d_term", "output")]
    assert terms == pytest.approx([1.2, 0.08, 0.0, 1.28])


def test_auto_depth_with_the_captured_gains():
    wired = Wired(Pro4Rov, registers=AT_ONCE)
    wired.component.set("depth", 1.0)  # 1111 mbar
    wired.ask(drive(auto_depth=1116.0), steps=11)
    # P e + I e = -0.02 5 - 0.0004 5: downwards
    assert wired["duty"][2] == pytest.approx(-(0.4 + 0.102 * 0.5))
    assert wired["command"][2] == pytest.approx(0.102 * 0.5 / 0.6)
    assert wired["auto_depth"] is True


def test_sticks_and_auto_heading_add_up():
    wired = Wired(Pro4Rov, registers=AT_ONCE)
    wired.ask(drive(thrust=(0.5, 0.5, 0.0), auto_heading=20.0), steps=11)
    assert wired["duty"][0] == pytest.approx(0.38 + 0.628 * 0.54)
    assert wired["duty"][1] == pytest.approx(0.38 + 0.372 * 0.54)


def test_the_sum_does_not_grow_while_the_output_is_clipped():
    wired = Wired(Pro4Rov, registers=AT_ONCE, watchdog=0.0)
    wired.component.set("depth", 0.0)
    wired.ask(drive(auto_depth=3000.0), steps=1000)
    wired.component.set("depth", 21.0)  # beyond it: no sum is left to hold it down
    wired.step(20)
    assert wired["command"][2] < 0.0


# ------------------------------------------------------------------ watchdog, cut, reboot


@pytest.mark.parametrize("seconds", [0.5, 1.0])
def test_the_watchdog_stops_the_thrusters_within_its_time_and_recovers(seconds):
    wired = Wired(Pro4Rov, registers=AT_ONCE, watchdog=seconds)
    wired.ask(drive(thrust=(1.0, 1.0, 1.0), lights=0.5), steps=15)
    wired.step(round(seconds / STEP) - 15)
    assert wired["command"][0] > 0.8
    wired.step()  # the block itself took 2 ms
    assert wired["command"] == [0.0, 0.0, 0.0]
    assert wired["commanded"] is False
    assert wired["lights"] == 0.5
    wired.ask(request(flags=5), steps=30)  # a question is no command
    assert wired["command"][0] == 0.0
    wired.ask(drive(thrust=(1.0, 1.0, 1.0)), steps=15)
    assert wired["command"][0] > 0.8


def test_without_watchdog_it_goes_on():
    wired = Wired(Pro4Rov, registers=AT_ONCE, watchdog=0.0)
    wired.ask(drive(thrust=(1.0, 1.0, 1.0)), steps=1000)
    assert wired["command"][0] > 0.8


def test_a_cut_line_carries_nothing():
    wired = Wired(Pro4Rov)
    wired.component.set("cut", True)
    assert wired.ask(request(flags=1)) == []
    wired.component.set("cut", False)
    assert len(wired.ask(request(flags=1))) == 1


def test_during_a_reboot_it_is_deaf_and_still():
    wired = Wired(Pro4Rov, registers=AT_ONCE, reboot_time=0.5, watchdog=0.0)
    wired.ask(drive(thrust=(1.0, 1.0, 1.0), lights=1.0), steps=15)
    answers = wired.ask(request(flags=1, address=0xFE, payload=b"\xde\xad"))
    assert len(answers) == 1  # before it goes
    assert (wired["command"], wired["lights"]) == ([0.0, 0.0, 0.0], 0.0)
    assert wired.ask(request(flags=1), steps=40) == []
    wired.step(10)
    assert len(wired.ask(request(flags=1))) == 1


def test_errors_are_counted_in_their_register_until_a_reboot():
    wired = Wired(Pro4Rov, reboot_time=0.0)
    wrong = bytearray(PACKETS[6])
    wrong[-1] ^= 1
    for _ in range(3):
        wired.say(bytes(wrong))
        assert wired.step(10) == []
    wired.say(PACKETS[6][:12])  # broken off
    wired.step(10)
    (answer,) = wired.ask(request(flags=0x82, address=0x86))
    assert answer.payload[1:] == b"\4\0"
    assert wired["communication_errors"] == 4
    wired.ask(request(address=0xFE, payload=b"\xde\xad"))
    (answer,) = wired.ask(request(flags=0x82, address=0x86))
    assert answer.payload[1:] == b"\0\0"


# ------------------------------------------------------------------ state, record, mistakes


def test_restored_state_goes_on_identically():
    wired = Wired(Pro4Rov, gains="holding")
    wired.component.set("depth", 1.3)
    wired.ask(drive(flags=5, auto_depth=1200.0, auto_heading=30.0), steps=43)
    wired.say(PACKETS[6][:9])
    wired.step()

    def go_on(component):
        found = []
        for number in range(100):
            component.set("depth", 1.3 + 0.01 * number)
            component.advance((wired.now + number * 10_000_000) / 1e9, STEP)
            found.append([component.get(name) for name in ("tx", "command", "duty", "requests")])
        return found

    state = json.loads(json.dumps(wired.component.get_state()["parts"]))
    whole = {**wired.component.get_state(), "parts": state}
    first = go_on(wired.component)
    other = Pro4Rov("other")
    for name in ("gains",):
        other.set(name, "holding")
    other.set_state(whole)
    assert go_on(other) == first
    wired.component.set_state(whole)
    assert go_on(wired.component) == first
    assert first[0][1] != first[-1][1]


def test_the_record_has_both_ways(tmp_path):
    wired = Wired(Pro4Rov)
    wired.component.set("run_folder", str(tmp_path))
    wired.say(PACKETS[2])
    wired.step(3)
    wired.component.close()
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
def test_mistakes_are_told(parameters, message):
    with pytest.raises(InputError, match=message):
        Wired(Pro4Rov, **parameters)
