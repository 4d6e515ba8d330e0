"""seatrial play, live, run --live: what is refused; a rig without a trial; reports that play."""

from __future__ import annotations

import base64
import os
import re
import socket
import threading
import time
from pathlib import Path

import pytest
import zstandard

from seatrial.trial.files.trial import load_trial
from seatrial.trial.records.run_folder import load_run
from seatrial.trial.reports.report import write_report
from seatrial.trial.running.hooks import Hooks
from seatrial.trial.running.supervision import run_supervised
from seatrial_kits.campaigns.results.campaign_report import VIEWER, write_case_report
from seatrial_kits.live.command import trial_of
from seatrial_kits.live.session import Session
from seatrial_kits.live.stage import played, viewer_js
from tests.command import seatrial


@pytest.mark.parametrize(
    ("arguments", "says"),
    [
        (("run", "hydrone-landing", "--live-control"), "go with --live"),
        (("run", "hydrone-landing", "--port", "8123"), "go with --live"),
        (("run", "hydrone-landing", "--live", "--live-control"), "goes with --hardware"),
        (("run", "hydrone-pads", "--live"), "--live works with a trial"),
        (("live", "hydrone-landing"), "hydrone-landing"),
        (("live", "landing", "--stop", "1 ms"), "shorter than a step"),
        (("play", "nowhere"), "is not a run folder"),
    ],
)
def test_what_does_not_fit_is_refused(arguments, says, tmp_path: Path) -> None:
    done = seatrial(*arguments, cwd=tmp_path)
    assert done.returncode == 2
    assert says in done.stderr
    assert not os.listdir(tmp_path)


@pytest.mark.parametrize("command", [("run", "hydrone-landing", "--live"), ("live", "landing")])
def test_a_port_that_is_taken_is_refused_before_the_run(command, tmp_path: Path) -> None:
    with socket.create_server(("127.0.0.1", 0)) as other:
        port = other.getsockname()[1]
        done = seatrial(*command, "--port", str(port), "--engine", "direct", cwd=tmp_path)
    assert done.returncode == 2
    assert f"--port: port {port} of 127.0.0.1 is taken" in done.stderr
    assert not os.listdir(tmp_path)


def test_a_run_without_a_craft_has_nothing_to_play(tmp_path: Path) -> None:
    trial = load_trial("can-load", changes={"stop": "20 ms"}, origin="test")
    run_supervised(trial, tmp_path / "run", engine="direct")
    done = seatrial("play", "run", cwd=tmp_path)
    assert done.returncode == 2
    assert "no craft to show" in done.stderr
    assert played(load_run(tmp_path / "run")) is None


def test_a_rig_runs_without_a_trial() -> None:
    trial = trial_of("square", "10.05 s", {"choices.vehicle": "otter"})
    assert trial.file.record.every == "0.1 s"
    assert trial.steps % trial.record_every == 0
    assert trial.stop_ns == 10_000_000_000
    assert trial.file.choices["vehicle"] == "otter"


@pytest.mark.slow
def test_a_page_is_there_while_the_run_is_and_no_longer(tmp_path: Path) -> None:
    """In processes of their own, as the command does it."""
    from urllib.request import HTTPCookieProcessor, build_opener

    urlopen = build_opener(HTTPCookieProcessor()).open
    seen: list[str] = []
    statuses: list[int] = []

    def look() -> None:
        until = time.monotonic() + 30.0
        while not seen and time.monotonic() < until:
            time.sleep(0.02)
        with urlopen(seen[0]) as answer:
            statuses.append(answer.status)
            assert b"<html" in answer.read()

    trial = load_trial("hydrone-landing", changes={"stop": "1 s"}, origin="test")
    session = Session(seen.append)
    looking = threading.Thread(target=look)
    with session.of(trial):
        looking.start()
        hooks = Hooks(observer=session.observer)
        result = run_supervised(trial, tmp_path / "run", engine="direct", hooks=hooks)
        looking.join(30)
    assert (result.status, statuses) == ("complete", [200])
    with pytest.raises(OSError, match="refused"):
        urlopen(seen[0])
    assert not (tmp_path / "run" / "by-hand.toml").exists()


def _recording(page: str) -> bytes:
    (data,) = re.findall(r'id="recording">([^<]*)</script>', page)
    packed = base64.b64decode(data)
    return zstandard.ZstdDecompressor().decompress(
        packed[8:], max_output_size=int.from_bytes(packed[:8], "little")
    )


@pytest.mark.slow
def test_a_report_plays_its_run(hydrone: Path, tmp_path: Path) -> None:
    text = write_report(hydrone, play=played).read_text("utf-8")
    content = _recording(text)
    assert b"craft0" in content
    assert b"durationSeconds" in content
    assert viewer_js() in text
    assert "</head>" not in viewer_js()  # it stands in a script
    assert len(base64.b64encode(content)) < 3e6


@pytest.mark.slow
def test_cases_share_the_viewer_and_stay_small(tmp_path: Path) -> None:
    trial = load_trial("hydrone-landing-waves", changes={"stop": "5 s"}, origin="test")
    result = run_supervised(trial, tmp_path / "case", engine="direct")
    page = write_case_report(result.folder, played)
    assert (tmp_path / VIEWER).read_text("utf-8") == viewer_js()
    assert f'src="../{VIEWER}"' in page.read_text("utf-8")
    recording = re.search(r'id="recording">([^<]*)</script>', page.read_text("utf-8"))
    assert recording is not None
    assert len(recording[1]) < 0.25e6


@pytest.mark.slow
def test_a_record_gives_the_same_recording(hydrone: Path) -> None:
    run = load_run(hydrone)
    first, second = played(run), played(run)
    assert first is not None
    assert first == second
