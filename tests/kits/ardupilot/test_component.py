"""ArduPilot as a component: what the firmware reads, and what its pulses do."""

import logging
import math
import os
import signal
import threading
import time

import pymap3d
import pytest

from seatrial.errors import InputError, SimulationError
from seatrial.links import watchdog
from seatrial_kits.ardupilot.component import ArduPilot
from seatrial_kits.ardupilot.reply import FIELDS

from .peer import Peer

SERVOS = "1 port 1100 1500 1900; 3 starboard 1100 1520 1900"


@pytest.fixture
def made():
    components = []

    def make(**values):
        component = ArduPilot("autopilot")
        components.append(component)
        for name, value in {"link": "udpin:127.0.0.1:0", "actuators": SERVOS, **values}.items():
            component.set(name, value)
        component.setup(0.0)
        component.initialise()
        component.begin()
        return component

    yield make
    for component in components:
        component.close()


class Flight:
    """A component that a peer flies with, in a thread; ``answers`` has what it got."""

    def __init__(self, component, frames, **options):
        port = int(component.get("reached_at").rpartition(":")[2])
        self.peer, self.frames, self.answers = Peer(port, **options), frames, []
        self.thread = threading.Thread(target=self._fly)
        self.thread.start()

    def _fly(self):
        for pwm in self.frames:
            self.answers.append(self.peer.exchange(*pwm))
        self.peer.send()  # what the last step waits for

    def end(self):
        self.thread.join(20.0)
        self.peer.close()
        return self.answers


def one_answer(component, t=0.0, **options):
    flight = Flight(component, [()], **options)
    component.advance(t, 0.01)
    (answer,) = flight.end()
    return answer


def test_the_required_fields_are_what_the_firmware_reads(made):
    component = made()
    component.set("true_position", (1.5, -2.0, 0.25))
    component.set("true_velocity", (1.0, 0.5, 0.0))
    component.set("true_attitude", (0.0, 0.0, math.pi / 2))
    component.set("true_rates", (0.01, 1e-7, 0.03))
    answer = one_answer(component)
    assert answer.number("timestamp") == 0.0
    assert answer.vector("gyro", "imu") == (0.01, 1e-7, 0.03)
    assert answer.vector("accel_body", "imu") == pytest.approx((0.0, 0.0, -9.81))
    assert answer.vector("position") == pytest.approx((1.5, -2.0, 0.25), rel=0.01)
    assert answer.vector("attitude") == pytest.approx((0.0, 0.0, math.pi / 2))
    # Heading east: ahead is east, starboard is south.
    assert answer.vector("velocity") == pytest.approx((-0.5, 1.0, 0.0))


@pytest.mark.parametrize("latitude", [0.0, -22.8, 59.0])
@pytest.mark.parametrize("place", [(5000.0, 5000.0), (-3000.0, 4000.0), (40.0, -40.0)])
def test_the_firmware_is_where_everybody_else_takes_the_vehicle_to_be(made, latitude, place):
    """ArduPilot's arithmetic on what it is sent, and WGS 84."""
    component = made(latitude=math.radians(latitude), longitude=math.radians(10.0))
    component.set("true_position", (*place, 0.25))
    north, east, down = one_answer(component).vector("position")
    lat = latitude + north / 1.1131884502145034e-2 * 1e-7
    middle = math.cos(math.radians((latitude + lat) / 2.0))
    lon = 10.0 + east / 1.1131884502145034e-2 * 1e-7 / middle
    expected = pymap3d.ned2geodetic(*place, 0.0, latitude, 10.0, 0.0)
    metres = 111_000.0
    third_order = (
        2 * math.hypot(*place) ** 3 / 6.37e6**2 * (1 + 3 * math.tan(math.radians(latitude)) ** 2)
    )
    assert (lat - expected[0]) * metres == pytest.approx(0.0, abs=1e-4 + third_order)
    assert (lon - expected[1]) * metres * middle == pytest.approx(0.0, abs=1e-4 + third_order)
    assert down == 0.25


def test_a_craft_that_circles_is_sent_its_heading(made):
    """Its yaw counts turns: a ship whose rudder is stuck went beyond 10 rad."""
    component = made()
    component.set("true_attitude", (0.1, -0.2, 7 * math.pi / 2))
    assert one_answer(component).vector("attitude") == pytest.approx((0.1, -0.2, -math.pi / 2))


def test_nothing_else_is_sent_unless_it_is_named(made):
    answer = one_answer(made())
    assert not any(answer.has(name) for name in FIELDS)


def test_all_other_fields_are_where_the_firmware_looks_for_them(made):
    component = made(fields=" ".join(reversed(FIELDS)))
    component.set("wind", (3.0, -1.0, 0.5))
    component.set("wind_valid", True)
    component.set("wind_speed", 4.5)
    component.set("wind_angle", math.pi)
    component.set("airspeed", 6.5)
    component.set("true_velocity", (7.0, 8.0, 9.0))
    component.set("distance", [1.0, 2.0, 3.0, 4.0, 5.0, 6.0])
    component.set("rc", [1e-3 + 1e-5 * n for n in range(1, 13)])
    component.set("voltage", 15.5)
    component.set("current", 7.25)
    answer = one_answer(component)
    assert answer.vector("velocity") == (7.0, 8.0, 9.0)
    assert answer.vector("velocity_wind") == (3.0, -1.0, 0.5)
    assert answer.number("speed", "windvane") == 4.5
    assert answer.number("airspeed") == 6.5
    assert [answer.number(f"rng_{n}") for n in range(1, 7)] == [1.0, 2.0, 3.0, 4.0, 5.0, 6.0]
    assert [answer.number(f"rc_{n}", "rc") for n in (1, 9, 10, 12)] == [1010, 1090, 1100, 1120]
    assert answer.number("voltage", "battery") == 15.5
    assert answer.number("current", "battery") == 7.25


@pytest.mark.parametrize(
    ("blows_to", "comes_from"),
    [(math.pi, 0.0), (-math.pi / 2, math.pi / 2), (math.pi / 2, 1.5 * math.pi), (0.0, math.pi)],
    ids=["head to wind", "from starboard", "from port", "from astern"],
)
def test_the_vane_says_where_the_wind_comes_from(made, blows_to, comes_from):
    component = made(fields="windvane")
    component.set("wind_valid", True)
    component.set("wind_angle", blows_to)
    answer = one_answer(component)
    assert answer.number("direction", "windvane") == pytest.approx(comes_from)


def test_a_vane_that_measures_nothing_is_not_sent(made):
    assert not one_answer(made(fields="windvane")).has("windvane")


@pytest.mark.parametrize("channels", [16, 32])
def test_pulses_act_one_step_later_and_no_pulse_is_neutral(made, channels):
    component = made()
    assert component.get("pulse")[:4] == pytest.approx([1500e-6, 0.0, 1520e-6, 0.0])
    frames = [(), (1600, 1200, 0, 1100), (0, 0, 1700)]
    flight = Flight(component, frames, channels=channels, rate=400)
    seen = []
    for k in range(len(frames)):
        component.advance(0.0025 * k, 0.0025)
        seen.append([round(1e6 * each) for each in component.get("pulse")[:4]])
    answers = flight.end()
    assert seen == [[1600, 1200, 1520, 1100], [1500, 0, 1700, 0], [1500, 0, 1520, 0]]
    assert [answer.number("timestamp") for answer in answers] == [0.0, 0.0025, 0.005]
    assert component.get("frame_rate") == 400.0
    assert component.get("repeated") == component.get("lost") == 0


def test_a_step_of_a_tenth_of_a_second_is_refused(made):
    with pytest.raises(SimulationError, match=r"step is 0\.1 s, less than 0\.1 s is needed"):
        made().advance(0.0, 0.1)


@pytest.mark.parametrize(
    ("firmware", "step"), [("rover", 0.02), ("sub", 0.0025), ("copter", 0.0025)]
)
def test_a_step_slower_than_the_firmware_is_warned_of(made, caplog, firmware, step):
    for slower in (1.0, 2.0):
        caplog.clear()
        component = made(firmware=firmware)
        flight = Flight(component, [()])
        component.advance(0.0, slower * step)
        flight.end()
        warned = "main loop every" in caplog.text
        assert warned is (slower > 1.0)


def test_a_motion_that_cannot_be_is_not_sent(made):
    component = made()
    component.set("true_rates", (0.0, 1e3, 0.0))
    port = int(component.get("reached_at").rpartition(":")[2])
    peer = Peer(port)
    peer.send()
    with pytest.raises(SimulationError, match=r"autopilot: the rates is 1000\.0 rad/s"):
        component.advance(0.0, 0.01)
    assert peer.receive(0.05) is None
    peer.close()


@pytest.mark.parametrize(
    ("name", "value", "said"),
    [
        ("link", "tcpin:127.0.0.1:0", "one udpin:HOST:PORT is needed"),
        ("link", "udpin:127.0.0.1:0 udpin:127.0.0.1:0", "one udpin:HOST:PORT is needed"),
        ("fields", "windwane", "windvane"),
        ("actuators", "1 port 1900 1500 1100", "rising pulses"),
        ("program", "/nowhere/ardurover", "there is no file /nowhere/ardurover"),
        ("program", "/etc/passwd", "is not executable"),
        ("link", "udpin:192.0.2.1:9002", "network"),
    ],
)
def test_what_cannot_be_is_refused_at_the_start(made, name, value, said):
    with pytest.raises(InputError, match=said):
        made(**{name: value})


def test_it_says_what_to_start_and_who_is_being_waited_for(made, caplog, monkeypatch):
    monkeypatch.setattr(watchdog, "FIRST_S", 0.1)
    component = made(latitude=math.radians(-31.78), longitude=math.radians(-52.26))
    component.set("true_attitude", (0.0, 0.0, -math.pi / 2))
    port = component.get("reached_at").rpartition(":")[2]
    with caplog.at_level(logging.WARNING):
        step = threading.Thread(target=component.advance, args=(0.0, 0.01))
        step.start()
        time.sleep(0.3)
        peer = Peer(int(port))
        peer.exchange()
        peer.send()
        step.join(10.0)
        peer.close()
    said = caplog.text
    assert f"ardurover --model JSON:127.0.0.1 --sim-port-out {port} " in said
    assert "--home -31.780000000,-52.260000000,0,270.000 --rate 100 --speedup 1" in said
    assert f"waiting for ArduPilot, which is to send to 127.0.0.1:{port}, since " in said


def test_a_copter_gets_the_mean_of_what_it_felt_since_the_frame_before(made):
    component = made(firmware="copter")
    flight = Flight(component, [()] * 2)
    component.set("true_attitude", (0.0, 0.3, 0.0))
    component.advance(0.0, 0.002)
    # From rest to 0.1 m/s upwards along its own z, in a step of which the end has no acceleration.
    component.set("true_velocity", (0.0, 0.0, -0.1))
    component.advance(0.002, 0.002)
    first, second = flight.end()
    level = 9.81 * math.sin(0.3), 0.0, -9.81 * math.cos(0.3)
    assert first.vector("accel_body", "imu") == pytest.approx(level)
    expected = level[0], 0.0, level[2] - 50.0
    assert second.vector("accel_body", "imu") == pytest.approx(expected)


def test_a_second_firmware_has_ports_and_a_number_of_its_own(made, caplog):
    component = made(instance=1.0)
    with caplog.at_level(logging.WARNING):
        flight = Flight(component, [()])
        component.advance(0.0, 0.01)
        flight.end()
    assert "--instance 1 --sysid 2" in caplog.text


def test_a_request_to_end_ends_the_wait(made):
    component = made()
    noticed = []
    before = signal.signal(signal.SIGINT, lambda *_: noticed.append(1))
    try:
        threading.Timer(0.2, os.kill, (os.getpid(), signal.SIGINT)).start()
        component.advance(0.0, 0.01)  # without anybody there
    finally:
        signal.signal(signal.SIGINT, before)
    assert noticed
    assert component.get("connected") is False
    flight = Flight(component, [(1600,)])  # and it goes on if the run does
    component.advance(0.01, 0.01)
    (answer,) = flight.end()
    assert answer.number("timestamp") == 0.01


def test_nobody_waits_without_end_for_a_firmware_that_does_not_come(made):
    component = made(wait_limit=0.2)
    begun = time.monotonic()
    with pytest.raises(SimulationError, match=r"autopilot: nothing came .* within 0\.2 s"):
        component.advance(0.0, 0.01)
    assert time.monotonic() - begun < 5.0


def test_each_wait_has_the_whole_limit(made):
    component = made(wait_limit=0.3)
    one_answer(component)
    with pytest.raises(SimulationError, match="wait_limit"):
        component.advance(0.01, 0.01)
