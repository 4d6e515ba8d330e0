"""The VideoRay through its serial protocol: the shipped trials, replay, speed, a MAVLink pilot."""

import re
import sys
import threading
import time
from dataclasses import replace

import numpy as np
import pytest
from pymavlink import mavutil

from seatrial.links.serial_gateway import SerialGateway
from seatrial.trial.files.trial import load_trial
from seatrial.trial.records.run_folder import load_run
from seatrial.trial.running.run import Hooks, run_trial
from seatrial_kits.videoray.topside import Pro4Topside
from tests.interop.running import running, wait_for

pytestmark = pytest.mark.interop

WAIT_S = 120.0
REPLAY = """
title = "again"
rig = "sil"
choices = {{ vehicle = "videoray", autopilot = "pro4", topside = "replay", step = "20 ms" }}
stop = "{stop}"

[set]
"vehicle.hull.eta_start.z" = "2 m"
"autopilot.topside.player.file" = "{file}"

[record]
signals = ["vehicle.hull.*", "autopilot.board.command.*"]
every = "20 ms"
"""


def run(name, folder, engine="direct", **settings):
    trial = load_trial(name).changed(settings, "test")
    return load_run(run_trial(trial, folder, engine=engine).folder)


def failed(found):
    assert found.verdicts
    return [f"{v['name']}: {v}" for v in found.verdicts if not v["passed"]]


def test_a_cut_stream_stops_the_thrusters_and_all_goes_on(tmp_path):
    assert failed(run("videoray-stream-cut", tmp_path / "run")) == []


@pytest.mark.long
@pytest.mark.parametrize("seed", range(1, 8))
def test_depth_and_heading_are_held_on_a_tether_with_the_named_gains(seed, tmp_path):
    assert failed(run("videoray-stream-tether", tmp_path / "run", seed=seed)) == []


def test_the_captured_gains_oscillate(tmp_path):
    found = run("videoray-stream-captured", tmp_path / "run")
    late = found.time > 20
    heading = np.degrees(found.signals["vehicle.hull.attitude.psi"][late])
    assert np.ptp(heading) > 30
    assert np.ptp(found.signals["vehicle.hull.position.z"][late]) > 3
    assert failed(found) == []


def test_a_recorded_stream_drives_the_vehicle_the_same_way_again(tmp_path):
    recorded = ["vehicle.hull.*", "autopilot.board.command.*"]
    trial = load_trial("videoray-stream-manual")
    record = trial.file.record.model_copy(update={"signals": recorded})
    trial = replace(trial, file=trial.file.model_copy(update={"record": record}))
    first = run_trial(trial, tmp_path / "first", engine="direct").folder
    again = run_trial(trial, tmp_path / "again", engine="direct").folder
    assert (first / "signals.csv").read_bytes() == (again / "signals.csv").read_bytes()
    assert (first / "autopilot.topside.box.stream").read_bytes() == (
        again / "autopilot.topside.box.stream"
    ).read_bytes()
    # What one end sends, the other receives: but for the last step's, at the same times.
    received, sent = (
        [line for line in (first / f"{name}.stream").read_text().splitlines() if " > " in line]
        for name in ("autopilot.board", "autopilot.topside.box")
    )
    assert received == sent
    (tmp_path / "replay.toml").write_text(
        REPLAY.format(stop="30 s", file=(first / "autopilot.topside.box.stream").as_posix())
    )
    replayed = run_trial(
        load_trial(str(tmp_path / "replay.toml")), tmp_path / "replay", engine="direct"
    )
    assert replayed.status == "complete"
    one, other = load_run(first), load_run(replayed.folder)
    assert failed(one) == []
    assert set(one.signals) == set(other.signals)
    assert np.ptp(one.signals["vehicle.hull.position.x"]) > 1
    for name, values in one.signals.items():
        np.testing.assert_array_equal(values, other.signals[name], err_msg=name)


@pytest.mark.long
def test_the_loop_is_twenty_times_faster_than_real_time(tmp_path):
    """Processor time of the run without its assembly: other programs disturb it little."""
    marks = []
    hooks = Hooks(progress=lambda passed, _: marks.append((passed, time.process_time())))
    trial = load_trial("videoray-stream-captured")
    assert run_trial(trial, tmp_path / "run", engine="direct", hooks=hooks).status == "complete"
    (begun, first), (ended, last) = marks[0], marks[-1]
    assert ended - begun > 50
    assert (ended - begun) / (last - first) > 20


@pytest.mark.long
@pytest.mark.skipif(sys.platform == "win32", reason="pseudo-terminals")
@pytest.mark.parametrize("seconds", [20, pytest.param(600, marks=pytest.mark.long)])
def test_a_topside_over_a_terminal_in_real_time(seconds, tmp_path):
    """No cycle is missed, the vehicle holds, and stops when the topside dies; then recovers."""
    place, stop = tmp_path / "rov", f"{6 * seconds + 120} s"
    with running(
        "videoray-stream-live",
        tmp_path,
        autopilot__topside__gateway__links=f"pty:{place}",
        stop=stop,
    ) as live:
        wait_for(lambda: live.is_running and place.exists(), "the trial runs", WAIT_S)
        # Six times at most: other programs on a busy machine may take a cycle, but not each time.
        for _ in range(6):
            trips, missed = drive(f"serial:{place}:115200", seconds)
            if not missed:
                break
        time.sleep(3.0)  # dead: the watchdog acts
        drive(f"serial:{place}:115200", 3.0)
        found = live.stop()
    print(f"round trips: {np.percentile(trips, [50, 90, 99, 100]) * 1e3} ms, missed {missed}")
    assert missed == 0
    commanded = found.signals["autopilot.board.commanded"]
    changes = np.flatnonzero(np.diff(commanded.astype(int)))
    assert len(changes) >= 3  # on, off, on again
    stopped, again = changes[-2:]
    assert commanded[again + 1]
    silent = (found.time > found.time[stopped]) & (found.time <= found.time[again])
    for thruster in ("port", "starboard", "vertical"):
        assert not np.any(found.signals[f"autopilot.board.command.{thruster}"][silent])
    held = (found.time > found.time[stopped] - 5) & (found.time <= found.time[stopped])
    depth, heading = (
        found.signals["vehicle.hull.position.z"],
        found.signals["vehicle.hull.attitude.psi"],
    )
    assert np.abs(depth[held] - 2.5).max() < 0.05
    assert np.degrees(np.abs(heading[held])).max() < 2.0


def drive(links, seconds):
    """Hold 2.5 m and north for a time in real time; return round trips, s, and missed cycles."""
    topside, gateway = Pro4Topside("topside"), SerialGateway("gateway")
    topside.set("timeout", 10.0)
    gateway.set("links", links)
    for component in (topside, gateway):
        component.setup(0.0)
        component.initialise()
        component.begin()
    topside.set("armed", True)
    topside.set("hold_depth", True)
    topside.set("hold_heading", True)
    topside.set("depth_wanted", 2.5)
    begun, steps, trips = time.monotonic(), 0, []
    asked, answered = 0.0, 0
    while time.monotonic() < begun + seconds:
        sent, received = topside.get("tx"), gateway.get("tx")
        topside.set("rx", received)
        gateway.set("rx", sent)
        if topside.get("cycles") > answered:
            asked, answered = time.monotonic(), topside.get("cycles")
        before = gateway.get("received")
        for component in (topside, gateway):
            component.advance(steps * 0.01, 0.01)
        if gateway.get("received") > before:
            trips.append(time.monotonic() - asked)
        steps += 1
        time.sleep(max(begun + steps * 0.01 - time.monotonic(), 0.0))
    missed = topside.get("missed")
    gateway.close()  # as if it had died: without safe-state bytes
    return trips, missed


def test_a_mavlink_pilot_drives_the_vehicle_through_the_stream(tmp_path):
    trial = load_trial("videoray-stream-pilot").changed(
        {"autopilot.topside.mavlink.links": "tcpin:127.0.0.1:0", "stop": "60 s"}, "test"
    )
    reached, stop = [], threading.Event()
    hooks = Hooks(stop_requested=stop.is_set, reachable=lambda *places: reached.append(places))
    done = []
    thread = threading.Thread(
        target=lambda: done.append(run_trial(trial, tmp_path / "run", engine="direct", hooks=hooks))
    )
    thread.start()
    try:
        deadline = time.monotonic() + WAIT_S
        while not reached:
            assert time.monotonic() < deadline
            assert thread.is_alive()
            time.sleep(0.05)
        place = re.search(r"tcp:127\.0\.0\.1:\d+", str(reached))[0]
        pilot(place)
    finally:
        stop.set()
        thread.join(WAIT_S)
    found = load_run(done[0].folder)
    port, starboard = (
        found.signals[f"autopilot.board.command.{side}"] for side in ("port", "starboard")
    )
    assert port.max() > 0.05
    assert starboard[np.argmax(port)] < port.max()  # it turned to starboard
    assert found.signals["vehicle.hull.position.x"].max() > 0.05


def pilot(place):
    """Arm in MANUAL and deflect the controls, ahead and to starboard, until the vehicle reports it."""
    link = mavutil.mavlink_connection(place, source_system=255)
    try:
        assert link.wait_heartbeat(timeout=WAIT_S)
        link.set_mode("MANUAL")
        deadline = time.monotonic() + WAIT_S
        pushed = 0
        while pushed < 40:
            assert time.monotonic() < deadline
            link.mav.heartbeat_send(6, 8, 0, 0, 4)
            link.mav.command_long_send(3, 1, 400, 0, 1, 0, 0, 0, 0, 0, 0)
            link.mav.manual_control_send(3, 100, 0, 500, 50, 0)
            link.recv_match(blocking=False)
            pushed += link.motors_armed() != 0
            time.sleep(0.1)
    finally:
        link.close()
