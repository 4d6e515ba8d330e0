"""The simulation's end of a live page, without a page: what it sends, heeds and refuses."""

from __future__ import annotations

import socket
import threading
import time
from collections.abc import Iterator
from contextlib import contextmanager
from multiprocessing import Pipe
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from seatrial.trial.files.trial import Trial, load_trial
from seatrial.trial.records.run_folder import load_run
from seatrial.trial.running.hooks import Hooks
from seatrial.trial.running.run import Result, run_trial
from seatrial_kits.live.by_hand import ByHand
from seatrial_kits.live.live_page import History
from seatrial_kits.live.tap import Tap

KEEPER = "autopilot.keeper.station"


class Page:
    """The other end of a tap, in the place of a page."""

    def __init__(self, trial: Trial, folder: Path, *, may: bool = True, factor: Any = None) -> None:
        self.pipe, theirs = Pipe()
        self.tap = Tap(theirs, may, factor)
        self.done = ByHand(trial)
        self.results: list[Result] = []
        hooks = Hooks(observer=self.tap)
        self._thread = threading.Thread(
            target=lambda: self.results.append(
                run_trial(trial, folder, engine="direct", hooks=hooks)
            )
        )
        self.asked = 0

    def __enter__(self) -> Page:
        self._thread.start()
        self.send("viewers", 1)
        self.described = self.next("begin")[0]
        return self

    def __exit__(self, *_: object) -> None:
        self.send("pause", False)
        self._thread.join(60)
        assert not self._thread.is_alive()

    def send(self, *message: Any) -> None:
        self.pipe.send(message)

    def next(self, wanted: str) -> list[Any]:
        """Return the next message of a kind; frames are taken."""
        while self.pipe.poll(10):
            what, *content = self.pipe.recv()
            if what == "frame":
                self.send("taken")
            if what == "done":
                self.done.add(*content)
            if what == wanted:
                return content
            assert what != "refused", content
        raise AssertionError(f"no {wanted}")

    def frame(self) -> tuple[float, dict[str, float]]:
        now, values = self.next("frame")
        return now, dict(zip(self.described["signals"], np.frombuffer(values), strict=True))


@contextmanager
def paused(trial: Trial, folder: Path, **how: Any) -> Iterator[Page]:
    """Run a trial that stands at its start until the page lets it go on."""
    page = Page(trial, folder, **how)
    page.tap._paused = True
    with page:
        yield page


def landing(stop: str = "1 s") -> Trial:
    return load_trial("hydrone-landing", changes={"stop": stop}, origin="test")


def test_pause_stops_time_and_a_step_is_one_step(tmp_path: Path) -> None:
    with paused(landing(), tmp_path / "run") as page:
        assert page.described["step"] == 0.01
        assert page.frame()[0] == 0.0
        times = []
        for _ in range(3):
            page.send("step")
            while (now := page.frame()[0]) in [0.0, *times]:
                pass
            times.append(now)
        assert times == pytest.approx([0.01, 0.02, 0.03], abs=1e-12)
        time.sleep(0.2)
        page.send("step")
        assert page.frame()[0] <= 0.04
    (result,) = page.results
    assert result.status == "complete"


@pytest.mark.slow
def test_what_is_done_by_hand_is_a_trial_with_the_same_bytes(tmp_path: Path) -> None:
    with paused(landing("4 s"), tmp_path / "live") as page:
        for _ in range(5):
            page.send("step")
        page.send("set", KEEPER, ["3 m", "0 m"])
        page.next("done")
        page.send(
            "fault", 7, {"what": "bias", "where": "vehicle.compass.heading", "value": "0.3 rad"}
        )
        page.next("done")
        for _ in range(40):
            page.send("step")
        page.send("set", "autopilot.keeper.station.east", "-2 m")
        page.next("done")
        page.send("clear", 7)
        page.next("done")
    text = page.done.text()
    assert text.count("[[events]]") == 2
    assert 'for = "' in text
    path = tmp_path / "by-hand.toml"
    path.write_text(text, "utf-8")
    again = load_trial(str(path), changes={"stop": "4 s"}, origin="test")
    run_trial(again, tmp_path / "again", engine="direct")
    signals = [(tmp_path / name / "signals.csv").read_bytes() for name in ("live", "again")]
    assert signals[0] == signals[1]
    plain = run_trial(landing("4 s"), tmp_path / "plain", engine="direct")
    assert (plain.folder / "signals.csv").read_bytes() != signals[0]


def test_a_run_that_is_watched_has_the_same_bytes(tmp_path: Path) -> None:
    with Page(landing(), tmp_path / "live") as page:
        page.frame()
    run_trial(landing(), tmp_path / "plain", engine="direct")
    signals = [(tmp_path / name / "signals.csv").read_bytes() for name in ("live", "plain")]
    assert signals[0] == signals[1]


def test_frames_wait_for_the_page_and_the_simulation_does_not(tmp_path: Path) -> None:
    page = Page(landing("3 s"), tmp_path / "run")
    page.send("viewers", 1)
    page._thread.start()  # nobody takes a frame
    page._thread.join(60)
    frames = 0
    while page.pipe.poll(0):
        frames += page.pipe.recv()[0] == "frame"
    assert frames == 1
    assert page.results[0].status == "complete"


def test_nothing_is_sent_while_nobody_looks(tmp_path: Path) -> None:
    page = Page(landing("3 s"), tmp_path / "run")
    page._thread.start()
    page._thread.join(60)
    sent = []
    while page.pipe.poll(0):
        sent.append(page.pipe.recv()[0])
    assert sent == ["begin"]


def test_who_comes_late_sees_what_was_before(tmp_path: Path) -> None:
    folder = run_trial(landing("3 s"), tmp_path / "run", engine="direct").folder
    run = load_run(folder)
    position, heading = "vehicle.hull.position.x", "vehicle.hull.attitude.psi"
    history = History(run.manifest, folder, [position, heading])
    history.add(1.0, np.array([7.0, 8.0]))
    del run.signals[heading]
    history.fill(run)
    times, columns = history.columns([position, heading])
    after = run.time > 1.0
    assert times.tolist() == [1.0, *run.time[after]]
    assert columns[position].tolist() == [7.0, *run.signals[position][after]]
    assert np.isnan(columns[heading][1:]).all()


@pytest.mark.slow
def test_at_most_thirty_frames_a_second(tmp_path: Path) -> None:
    with Page(landing("1 s"), tmp_path / "run", factor=1.0) as page:
        begun, frames = time.monotonic(), 0
        while page._thread.is_alive():
            if page.pipe.poll(0.01) and page.pipe.recv()[0] == "frame":
                frames += 1
                page.send("taken")
        wall = time.monotonic() - begun
    assert frames <= 30.0 * wall + 3


@pytest.mark.parametrize(
    ("message", "says"),
    [
        (("set", "autopilot.keeper.nothing", 1), "nothing"),
        (("set", KEEPER, ["3 s", "0 m"]), "m"),
        (("set", "vehicle.hull.mass", "30 kg"), "fixed"),
        (("fault", 1, {"what": "explode", "where": "vehicle.hull"}), "explode"),
        (("fault", 1, {"what": "bias", "where": "vehicle.hull.nowhere", "value": 1}), "nowhere"),
        (("fault", 1, {"what": "bias", "where": "vehicle.compass.heading", "valve": 1}), "valve"),
    ],
)
def test_what_does_not_fit_is_refused_and_the_run_goes_on(tmp_path, message, says) -> None:
    with paused(landing("50 ms"), tmp_path / "run") as page:
        page.send(*message)
        assert says in page.next("refused")[0]
    assert page.results[0].status == "complete"


def test_a_page_that_only_watches_commands_nothing(tmp_path: Path) -> None:
    with Page(landing("1 s"), tmp_path / "run", may=False, factor=2.0) as page:
        for message in (("pause", True), ("set", KEEPER, ["3 m", "0 m"]), ("stop",), ("step",)):
            page.send(*message)
            assert page.next("refused") == ["this page only watches"]
    assert page.results[0].status == "complete"


def test_a_page_that_goes_lets_a_paused_run_go_on(tmp_path: Path) -> None:
    page = Page(landing("50 ms"), tmp_path / "run")
    page.tap._paused = True
    page._thread.start()
    page.next("begin")
    page.pipe.close()
    page._thread.join(30)
    assert page.results[0].status == "complete"


def test_what_can_be_set_is_named_with_unit_and_limits(tmp_path: Path) -> None:
    with paused(landing("50 ms"), tmp_path / "run") as page:
        keys = {one["key"]: one for one in page.described["settables"]}
        station = keys["autopilot.keeper.station.north"]
        assert (station["unit"], station["value"]) == ("m", 0.0)
        assert "vehicle.hull.mass" not in keys  # it is fixed
        assert "vehicle.port_thruster.pulse" not in keys  # the autopilot feeds it


@pytest.mark.slow
def test_the_page_gets_a_lost_link(write, tmp_path: Path) -> None:
    with socket.create_server(("127.0.0.1", 0)) as server:
        link = f"tcpout:127.0.0.1:{server.getsockname()[1]}"
        port = f'{{ fmu = "serial-gateway", set = {{ links = "{link}" }} }}'
        write("rig.toml", f'step = "10 ms"\n[components]\nport = {port}\n')
        trial = load_trial(str(write("trial.toml", 'rig = "rig.toml"\nstop = "1000 s"\n')))
        page = Page(trial, tmp_path / "run", factor=1.0)
        with page:
            server.accept()[0].close()
            now, lost = page.next("links")
            assert (now > 0.0, lost) == (True, ["port"])
            server.accept()
            assert page.next("links")[1] == []
            page.send("stop")
