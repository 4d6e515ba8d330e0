"""Speed-up and pause: what goes on while simulated time stands still."""

import signal
import threading
import time

import pytest
from pymavlink.dialects.v20 import all as mavlink

from seatrial.errors import InputError
from seatrial.links.interruption import Interruption
from seatrial_kits.mavlink.parameters.file import ParameterFile
from seatrial_kits.mavlink.parameters.parameters import vehicle_parameters
from seatrial_kits.mavlink.pause import POLL_S, stand_still

from .bench import Bench
from .ground import WAYPOINT, item
from .test_component import connect, made, received, started, until  # noqa: F401  fixtures

SPEEDUP = "SIM_SPEEDUP"


def put(name, value):
    return mavlink.MAVLink_param_set_message(
        7, 1, name.encode(), value, mavlink.MAV_PARAM_TYPE_REAL32
    )


class Standing:
    """A bench that stands still; ``script`` has what arrives, by the wall time since, s."""

    def __init__(self, script, bench=None, **settings):
        self.bench = bench or Bench(**settings)
        self.script, self.wall = sorted(script, key=lambda each: each[0]), 0.0
        self.bench.receive(put(SPEEDUP, 0.0))
        self.table = next(s.table for s in self.bench.node.services if hasattr(s, "table"))
        self.sent = []

    def run(self):
        """Stand still, and return for how long."""
        stand_still(
            self._exchange,
            self.bench.node,
            self.bench.settings,
            self.table,
            clock=lambda: self.wall,
            sleep=self._sleep,
        )
        return self.wall

    def _sleep(self, seconds):
        self.wall += seconds
        assert self.wall < 1000.0, "it never ended"

    def _exchange(self):
        due = [message for at, message in self.script if at <= self.wall]
        self.script = [each for each in self.script if each[0] > self.wall]
        for message in due:
            self.bench.receive(message)
        self.bench.node.tick(self.bench.now)
        self.sent += [(self.wall, m) for m in self.bench.transport.take()]
        return bool(due)

    def received(self, kind):
        return [(at, m) for at, m in self.sent if m.get_type() == kind]

    def texts(self):
        return [m.text for _, m in self.received("STATUSTEXT")]


def beats(until_s):
    """Return a station's heartbeats, one a second."""
    beat = mavlink.MAVLink_heartbeat_message(mavlink.MAV_TYPE_GCS, 8, 0, 0, 4, 3)
    return [(float(t), beat) for t in range(int(until_s))]


def test_it_goes_on_when_a_station_says_so():
    standing = Standing([*beats(30), (30.0, put(SPEEDUP, 4.0))])
    assert standing.run() == pytest.approx(30.0, abs=2 * POLL_S)
    assert standing.bench.vehicle.paused_s == pytest.approx(30.0, abs=2 * POLL_S)
    assert (standing.bench.settings.speedup, standing.bench.settings.paused) == (4.0, False)
    assert standing.texts()[0] == "Paused: SIM_SPEEDUP above 0 goes on"
    assert standing.bench.texts() == ["Goes on at SIM_SPEEDUP 4"]


def test_the_last_one_that_could_end_it_is_gone():
    standing = Standing([(3.0, beats(1)[0][1])], speedup=2.0, station_timeout=7.0)
    assert standing.run() == pytest.approx(3.0 + 7.0, abs=3 * POLL_S)
    assert standing.bench.settings.speedup == 2.0
    assert standing.table[SPEEDUP] == 2.0
    texts = standing.bench.texts()
    assert texts == ["No station is left to end the pause", "Goes on at SIM_SPEEDUP 2"]


def test_two_pauses_add_up():
    bench = Bench()
    for k in (1, 2):
        Standing([*beats(10), (10.0, put(SPEEDUP, 1.0))], bench).run()
        assert bench.vehicle.paused_s == pytest.approx(10.0 * k, abs=4 * POLL_S)
        bench.wait(1.0)


def test_heartbeats_go_on_and_everything_else_stands_still():
    bench = Bench()
    bench.wait(10.0)
    bench.transport.take()
    standing = Standing([*beats(60), (60.0, put(SPEEDUP, 1.0))], bench)
    standing.run()
    ours = [at for at, _ in standing.received("HEARTBEAT")]
    # To both links.
    assert len(ours) == pytest.approx(2 * 60, abs=2)
    others = {m.get_type() for _, m in standing.sent} - {"HEARTBEAT"}
    assert others <= {"STATUSTEXT", "PARAM_VALUE"}
    bench.transport.take()
    bench.wait(1.0)
    attitudes = [m.time_boot_ms for m in bench.transport.take("ATTITUDE", 0)]
    assert 10_000 < attitudes[0] <= 10_110


def test_parameters_are_listed_read_and_set():
    request = mavlink.MAVLink_param_request_list_message(7, 1)
    script = [(1.0, request), (9.0, put("WP_RADIUS", 5.0)), *beats(20), (20.0, put(SPEEDUP, 1.0))]
    standing = Standing(script)
    standing.run()
    values = [(at, m) for at, m in standing.received("PARAM_VALUE") if at < 9.0 and at > 0.9]
    count = len(standing.table.names)
    assert [m.param_index for _, m in values] == list(range(count))
    # 100 a second.
    assert values[-1][0] == pytest.approx(1.0 + count / 100, abs=0.1)
    assert standing.bench.settings.waypoint_radius == 5.0


def test_commands_are_carried_out_and_time_sync_stands_still():
    bench = Bench()
    bench.wait(3.0)
    arm = mavlink.MAVLink_command_long_message(7, 1, 400, 0, 1, 0, 0, 0, 0, 0, 0)
    sync = mavlink.MAVLink_timesync_message(0, 123)
    script = [(1.0, arm), (2.0, sync), (5.0, sync), *beats(6), (6.0, put(SPEEDUP, 1.0))]
    standing = Standing(script, bench)
    standing.run()
    assert bench.vehicle.armed
    assert [m.result for _, m in standing.received("COMMAND_ACK")] == [mavlink.MAV_RESULT_ACCEPTED]
    assert [m.tc1 for _, m in standing.received("TIMESYNC")] == [3_000_000_000] * 2


def test_a_mission_is_uploaded_with_requests_again_where_one_was_lost():
    count = mavlink.MAVLink_mission_count_message(7, 1, 2, 0)
    # The item that was requested at 1 s comes after the second and the third time.
    items = [(3.5, item(0)), (3.8, item(1, WAYPOINT))]
    standing = Standing([(1.0, count), *items, *beats(6), (6.0, put(SPEEDUP, 1.0))])
    standing.run()
    asked = [(round(at), m.seq) for at, m in standing.received("MISSION_REQUEST_INT")]
    assert asked == [(1, 0), (2, 0), (3, 0), (4, 1)]
    assert [m.type for _, m in standing.received("MISSION_ACK")] == [0]


def test_nobody_is_missed_because_of_a_pause():
    bench = Bench()
    bench.heartbeat()
    bench.arm()
    bench.wait(1.0)
    standing = Standing([*beats(60), (60.0, put(SPEEDUP, 1.0))], bench)
    standing.run()
    bench.wait(1.0)
    assert not bench.vehicle.failsafe
    assert bench.vehicle.stations == 1


@pytest.mark.parametrize("autopilot", ["ardupilotmega", "px4"])
@pytest.mark.parametrize(
    ("value", "becomes"),
    [(4.0, 4.0), (0.1, 0.1), (1000.0, 1000.0), (0.01, 1.0), (-1.0, 1.0), (2000.0, 1.0)],
)
def test_speed_ups_that_links_stand(autopilot, value, becomes):
    bench = Bench(autopilot=autopilot)
    bench.receive(put(SPEEDUP, value))
    assert bench.settings.speedup == becomes
    (answer,) = bench.transport.take("PARAM_VALUE")
    assert answer.param_value == pytest.approx(becomes)
    if value != becomes:
        assert f"{SPEEDUP} stays 1: 0, or 0.1 to 1000 is allowed" in bench.texts()


def test_no_file_keeps_it(tmp_path):
    path = tmp_path / "boat.param"
    bench = Bench()
    table = vehicle_parameters(bench.vehicle, bench.settings, file=ParameterFile(path))
    assert table.put(SPEEDUP, 0.0) is None
    assert not path.exists()
    assert table.put("WP_RADIUS", 4.0) is None
    assert SPEEDUP not in path.read_text()
    path.write_text(f"{SPEEDUP} 2\n")
    with pytest.raises(InputError, match=f"{SPEEDUP} cannot be set: it ends with the run"):
        vehicle_parameters(bench.vehicle, bench.settings, file=ParameterFile(path))


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM])
def test_a_signal_ends_it_and_reaches_its_handler(number):
    asked = []
    before = signal.signal(number, lambda *_: asked.append(number))
    try:
        handler = signal.getsignal(number)
        bench = Bench()
        bench.receive(put(SPEEDUP, 0.0))
        table = next(s.table for s in bench.node.services if hasattr(s, "table"))
        timer = threading.Timer(0.3, lambda: signal.raise_signal(number))
        begun = time.monotonic()
        timer.start()
        # A station always sends something.
        stand_still(lambda: True, bench.node, bench.settings, table)
        assert time.monotonic() - begun >= 0.25
        assert asked == [number]
        assert signal.getsignal(number) is handler
        assert bench.settings.paused
    finally:
        signal.signal(number, before)


def test_handlers_of_the_host_stay_untouched_in_another_thread():
    found = []

    def enter():
        with Interruption() as interruption:
            found.append((signal.getsignal(signal.SIGTERM), interruption.requested))

    thread = threading.Thread(target=enter)
    thread.start()
    thread.join()
    assert found == [(signal.getsignal(signal.SIGTERM), False)]


@pytest.mark.slow
def test_the_component_waits_in_its_step_and_says_how_long(connect):  # noqa: F811
    boat = made(speedup_start=2.0)
    boat.initialise()
    boat.begin()
    assert (boat.get("speedup"), boat.get("paused")) == (2.0, 0.0)
    station, stop = connect(boat.urls[0]), threading.Event()

    def step():
        while not stop.is_set():
            boat.advance(boat.now, 0.01)
            time.sleep(0.001)

    def ask(value):
        station.mav.param_set_send(1, 1, SPEEDUP.encode(), value, mavlink.MAV_PARAM_TYPE_REAL32)
        return station.recv_match(
            type="PARAM_VALUE", condition=f"PARAM_VALUE.param_id == '{SPEEDUP}'", blocking=True,
            timeout=30,
        )  # fmt: skip

    thread = threading.Thread(target=step)
    thread.start()
    try:
        assert ask(0.0).param_value == 0.0
        paused_at, begun = boat.now, time.monotonic()
        assert station.recv_match(type="HEARTBEAT", blocking=True, timeout=30)
        station.mav.heartbeat_send(6, 8, 0, 0, 4)
        assert station.recv_match(type="HEARTBEAT", blocking=True, timeout=30)
        assert boat.now - paused_at <= 0.02
        waited = time.monotonic() - begun
        assert ask(3.0).param_value == 3.0
        end = time.monotonic() + 30
        while boat.now < paused_at + 0.05 and time.monotonic() < end:
            time.sleep(0.01)
    finally:
        stop.set()
        thread.join()
        speedup, paused = boat.get("speedup"), boat.get("paused")
        boat.close()
    assert speedup == 3.0
    assert paused >= 0.9 * waited
