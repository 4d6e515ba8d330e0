"""MAVProxy at a running trial: what its user types, and what happens then."""

from __future__ import annotations

import math
import re
import time
from pathlib import Path

import pytest
from pymavlink import mavparm, mavutil, mavwp

from .mavproxy import MavProxy, mavproxy
from .running import HOST, RunningTrial, free_port, running, wait_for

HOME = (-31.78, -52.26)
PLACES = [HOME, (-31.7798, -52.26), (-31.7798, -52.2597), (-31.7802, -52.2597)]
FENCE = [(-31.779, -52.261), (-31.779, -52.259), (-31.781, -52.259), (-31.781, -52.261)]
RALLY = [(-31.7795, -52.2605)]
E7 = 1.01e-7
"""What an integer coordinate may be off, degrees."""


def plan(path: Path, command: int, places: list[tuple[float, float]], count: int = 0) -> Path:
    """Write a file of items as ground stations do; ``count`` is parameter 1."""
    rows = [
        f"{n}\t0\t3\t{command}\t{count}\t0\t0\t0\t{lat:.8f}\t{lon:.8f}\t0\t1\n"
        for n, (lat, lon) in enumerate(places)
    ]
    path.write_text("QGC WPL 110\n" + "".join(rows), "utf-8")
    return path


def places(path: Path) -> list[tuple[int, float, float]]:
    """Return command and place of the items of a file, as pymavlink reads it."""
    loader = mavwp.MAVWPLoader()
    loader.load(str(path))
    return [(w.command, w.x, w.y) for w in loader.wpoints]


def same(found: list[tuple[int, float, float]], wanted: list[tuple[int, float, float]]) -> bool:
    return [c for c, *_ in found] == [c for c, *_ in wanted] and all(
        abs(a - b) <= E7
        for one, other in zip(found, wanted, strict=True)
        for a, b in zip(one[1:], other[1:], strict=True)
    )


def all_parameters(port: int) -> dict[str, float]:
    """Return what the vehicle offers, fetched by pymavlink over a link of its own."""
    station = mavutil.mavlink_connection(f"udpout:{HOST}:{port}", source_system=250)
    loader, found = mavparm.MAVParmDict(), {}
    station.mav.param_request_list_send(1, 1)
    while (m := station.recv_match(type="PARAM_VALUE", blocking=True, timeout=20.0)) is not None:
        found[m.param_id] = m.param_value
        if len(found) == m.param_count:
            break
    station.close()
    loader.update(found)
    return dict(loader)


def moved(trial: RunningTrial, craft: str, axes: str = "xy") -> float:
    """Return how far the vehicle is from where it began, m, by its true position."""
    run = trial.signals()
    found = [run.signals[f"{craft}.position.{axis}"] for axis in axes]
    return math.hypot(*(x[-1] - x[0] for x in found if len(x)))


def connected(proxy: MavProxy) -> int:
    """Wait until it knows the vehicle and its parameters; return their number."""
    proxy.expect(r"online system 1$")
    count = int(proxy.expect(r"Received (\d+) parameters")[1])
    proxy.expect(r"Saved \d+ parameters to \./mav\.parm")
    return count


def fetch_and_set_parameters(proxy: MavProxy, home: Path, port: int, count: int) -> None:
    offered = all_parameters(port)
    assert len(offered) == count
    kept = mavparm.MAVParmDict()
    kept.load(str(home / "mav.parm"))
    assert {name: kept[name] for name in offered} == pytest.approx(offered, abs=1e-6)
    proxy.type("param set FS_TIMEOUT 4.5")
    wait_for(lambda: all_parameters(port)["FS_TIMEOUT"] == 4.5, "the parameter")
    proxy.ask("param fetch", rf"Received {count} parameters")
    assert float(proxy.ask("param show FS_TIMEOUT", r"FS_TIMEOUT +(\S+)$")[1]) == 4.5
    assert all_parameters(port)["FS_TIMEOUT"] == 4.5


def exchange_plans(proxy: MavProxy, folder: Path) -> None:
    """Load, list and save mission, fence and rally points, and see that they come back."""
    for name, kind, file, save in (
        ("wp", "waypoints", plan(folder / "wp.txt", 16, PLACES), "wp save back.txt"),
        ("fence", "fence items", plan(folder / "f.txt", 5001, FENCE, 4), "fence save back.txt"),
        ("rally", "rally items", plan(folder / "r.txt", 5100, RALLY), "rally save back.txt"),
    ):
        wanted = places(file)
        proxy.ask(f"{name} load {file}", rf"Loaded {len(wanted)} {kind} in")
        proxy.expect(r"Got MISSION_ACK: TYPE_\w+: ACCEPTED")
        proxy.ask(f"{name} list", rf"Saved {len(wanted)} {kind} to")
        back = folder / "home" / "back.txt"
        proxy.ask(save, rf"Saved {len(wanted)} {kind} to back.txt")
        assert same(places(back), wanted)
        back.unlink()


def drive_and_arm(proxy: MavProxy, trial: RunningTrial) -> None:
    """Enter manual mode, arm, drive by overridden channels until it is elsewhere, and disarm."""
    proxy.ask("mode MANUAL", r"Mode MANUAL$")
    proxy.ask("arm throttle", r"\bARMED$")
    proxy.type("rc 3 1800")
    proxy.type("rc 1 1550")
    wait_for(lambda: moved(trial, "vehicle.hull") > 1.0, "1 m by overridden channels")
    proxy.type("rc all 0")
    proxy.ask("disarm", r"DISARMED$")


@pytest.mark.parametrize("factor", [1.0, pytest.param(5.0, marks=pytest.mark.long)])
def test_a_session_with_a_boat(tmp_path: Path, factor: float) -> None:
    port, folder = free_port(), tmp_path
    with (
        running(
            "hydrone-mission",
            folder,
            factor=factor,
            autopilot__mavlink__links=f"udpin:{HOST}:{port}",
        ) as trial,
        mavproxy(folder / "home", f"udpout:{HOST}:{port}") as proxy,
    ):
        wait_for(lambda: trial.is_running, "the trial's first step")
        count = connected(proxy)
        fetch_and_set_parameters(proxy, folder / "home", port, count)
        modes = set(re.findall(r"\w+", proxy.ask("mode", r"Available modes: (.*)$")[1]))
        for name in ("MANUAL", "HOLD", "LOITER", "GUIDED"):
            assert name in modes
            proxy.ask(f"mode {name}", rf"Mode {name}$")
        exchange_plans(proxy, folder)
        proxy.ask("wp set 2", r"waypoint 2$")
        proxy.ask("fence disable", r"AP: Fence off")
        proxy.ask("fence enable", r"AP: Fence on")
        drive_and_arm(proxy, trial)
        proxy.ask("arm throttle", r"\bARMED$")
        proxy.ask("mode AUTO", r"AP: Mode AUTO$")
        assert proxy.newest("NAV_CONTROLLER_OUTPUT", "wp_dist") < 100.0
        proxy.ask("mode RTL", r"AP: Mode RTL$")
        proxy.ask("disarm", r"DISARMED$")
        for kind in ("wp", "fence", "rally"):
            proxy.ask(f"{kind} clear", r"Got MISSION_ACK: TYPE_\w+: ACCEPTED")
        proxy.type("version")
        assert proxy.newest("AUTOPILOT_VERSION", "flight_sw_version") == 0x040600FF
        proxy.ask("ping", r"ping response: .* from=1/1")
        proxy.ask("status", r"MAV Errors: 0$")
        assert proxy.complaints("online system 1") == []
        assert "stopped" not in trial.transcript
        trial.stop()


def test_a_session_with_signatures(tmp_path: Path) -> None:
    port, folder = free_port(), tmp_path
    (folder / "key.txt").write_text("battery staple\n")
    given = {
        "autopilot__mavlink__links": f"udpin:{HOST}:{port}",
        "autopilot__mavlink__signing_key_file": "key.txt",
        "autopilot__mavlink__state_file": "state.json",
    }
    with (
        running("hydrone-mission", folder, factor=5.0, **given) as trial,
        mavproxy(folder / "home", f"udpout:{HOST}:{port}") as proxy,
    ):
        wait_for(lambda: trial.is_running, "the trial's first step")
        proxy.type("arm throttle")
        proxy.expect(r"link 1 down$")  # nobody obeys it, and nothing is sent to it
        proxy.ask("signing setup battery-horse", r"Setup signing key$")
        proxy.type("arm throttle")
        time.sleep(3.0)
        proxy.ask("signing disable", r"Disabled signing$")
        assert "ACK" not in proxy.transcript
        assert "online system" not in proxy.transcript
        proxy.ask('signing setup "battery staple"', r"Setup signing key$")
        proxy.expect(r"online system 1$")
        assert int(proxy.ask("param fetch", r"Received (\d+) parameters( \(ftp\))?$")[1]) > 100
        proxy.ask("mode MANUAL", r"Mode MANUAL$")
        # Signed commands count at once, but a vehicle arms only once a signed heartbeat has come.
        wait_for(lambda: "AP: Ground station 255:230" in proxy.transcript, "its heartbeat")
        proxy.ask("arm throttle", r"\bARMED$")
        proxy.ask('signing setup "battery staple"', r"AP: No key is taken over a link")


DIVE = """
rig  = "sil"
choices = { vehicle = "videoray", autopilot = "mavlink" }
stop = "3600 s"
[set]
"vehicle.hull.eta_start.z" = "1 m"
[real_time]
[record]
signals = ["vehicle.hull.position.*"]
every   = "1 s"
"""
DEEP = "QGC WPL 110\n0\t1\t0\t16\t0\t0\t0\t0\t{0:.8f}\t{1:.8f}\t0\t1\n1\t0\t3\t16\t0\t0\t0\t0\t{2:.8f}\t{1:.8f}\t-3\t1\n"


@pytest.mark.long
def test_a_session_with_a_submarine(tmp_path: Path) -> None:
    port, folder = free_port(), tmp_path
    trial_file = folder / "dive.toml"
    trial_file.write_text(DIVE)
    with (
        running(
            str(trial_file), folder, factor=5.0, autopilot__mavlink__links=f"udpin:{HOST}:{port}"
        ) as trial,
        mavproxy(folder / "home", f"udpout:{HOST}:{port}") as proxy,
    ):
        wait_for(lambda: trial.is_running, "the trial's first step")
        proxy.expect(r"online system \d+$")
        proxy.expect(r"Received \d+ parameters")
        modes = set(re.findall(r"\w+", proxy.ask("mode", r"Available modes: (.*)$")[1]))
        for name in ("MANUAL", "STABILIZE", "POSHOLD", "ALT_HOLD"):
            assert name in modes
            proxy.ask(f"mode {name}", rf"Mode {name}$")
        proxy.ask("arm throttle", r"\bARMED$")
        proxy.type("rc 3 1300")  # downwards; the depth is held when the control is released
        wait_for(lambda: moved(trial, "vehicle.hull", "z") > 1.0, "1 m down by overridden channels")
        proxy.type("rc 3 1500")
        station = mavutil.mavlink_connection(f"udpout:{HOST}:{port}", source_system=250)
        station.mav.heartbeat_send(6, 8, 0, 0, 4)
        origin = station.recv_match(type="HOME_POSITION", blocking=True, timeout=60.0)
        station.close()
        latitude, longitude = origin.latitude * 1e-7, origin.longitude * 1e-7
        (folder / "deep.txt").write_text(DEEP.format(latitude, longitude, latitude + 4e-5))
        proxy.ask(f"wp load {folder / 'deep.txt'}", r"Got MISSION_ACK: TYPE_MISSION: ACCEPTED")
        proxy.ask("wp list", r"16 3 -?[\d.]+ -?[\d.]+ -3.0+ ")
        proxy.ask("mode AUTO", r"AP: Mode AUTO$")
        proxy.type("rc all 0")
        proxy.expect(r"AP: Mission complete", 120.0)
        assert proxy.newest("GLOBAL_POSITION_INT", "relative_alt") == pytest.approx(-3000, abs=400)
        proxy.ask("mode SURFACE", r"AP: Mode SURFACE$")
        depth = lambda: trial.signals().signals["vehicle.hull.position.z"]  # noqa: E731
        wait_for(lambda: depth()[-1] < 0.5, "the surface", 120.0)
        proxy.ask("disarm", r"DISARMED$")
        # The parameters come as a file: MAVProxy may see the first status before it.
        early = "Arming checks disabled"
        assert [c for c in proxy.complaints("online system") if c != early] == []
