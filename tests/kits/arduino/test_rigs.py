"""Sketches that sail, dive and hold a station: the boats by their own electronics."""

import csv
import math
import re
from dataclasses import replace
from pathlib import Path

import pytest

from seatrial.links.text import decode
from seatrial.trial.files.trial import load_trial
from seatrial.trial.running.run import Hooks, run_trial

from .bench import need, write_sketch

pytestmark = pytest.mark.interop

HEADING = "vehicle.boat.eta.psi"


def board(name: str) -> str:
    """Return the board's component."""
    if name.startswith("gloria"):
        return "autopilot.main.mega"
    return "autopilot.esp32" if name.endswith("esp32") else "autopilot.mega"


def sailed(name: str, folder: Path, backend: str = "host", **changes: object):
    need(backend)
    trial = load_trial(name).changed({f"{board(name)}.backend": backend, **changes}, "test")
    result = run_trial(trial, folder, engine="direct")
    assert result.status == "complete", result.error
    return result


def rows(result) -> list[dict[str, str]]:
    with (result.folder / "signals.csv").open(encoding="utf-8") as file:
        return list(csv.DictReader(file))


def apart(one, other) -> float:
    """Return the greatest difference of the headings, deg."""
    return max(
        abs(math.degrees(float(a[HEADING]) - float(b[HEADING])))
        for a, b in zip(rows(one), rows(other), strict=True)
    )


def passes(result) -> None:
    assert [name for name, _, verdict in result.verdicts if not verdict.passed] == []


def test_both_back_ends_steer_alike(tmp_path):
    host, simavr = (
        sailed("gloria-sketch", tmp_path / each, each, stop="4 s") for each in ("host", "simavr")
    )
    assert apart(host, simavr) < 1.0
    pulses = [f"{board('gloria')}.pulse.s{n}" for n in (1, 3)]
    ends = [[float(rows(each)[-1][pulse]) for pulse in pulses] for each in (host, simavr)]
    assert ends[1] == pytest.approx(ends[0], abs=15e-6)


@pytest.mark.long
def test_both_back_ends_turn_alike_by_90_degrees(tmp_path):
    host, simavr, again = (
        sailed("gloria-sketch-step", tmp_path / str(i), each)
        for i, each in enumerate(("host", "simavr", "simavr"))
    )
    assert apart(host, simavr) < 1.0
    passes(host)
    passes(simavr)
    signals = [(each.folder / "signals.csv").read_bytes() for each in (simavr, again)]
    assert signals[0] == signals[1]


def test_a_second_run_is_the_same_to_the_bit(tmp_path):
    runs = [sailed("gloria-sketch", tmp_path / str(i), stop="6 s") for i in range(2)]
    signals = [(each.folder / "signals.csv").read_bytes() for each in runs]
    assert signals[0] == signals[1]


@pytest.mark.long
@pytest.mark.parametrize("name", ["gloria-sketch", "hydrone-sketch", "hydrone-esp32"])
def test_the_shipped_trials_hold(tmp_path, name):
    passes(sailed(name, tmp_path / "run"))


@pytest.mark.long
def test_the_rov_obeys_its_serial_port_and_stops_without(tmp_path):
    passes(sailed("videoray-sketch", tmp_path / "run"))


def test_a_run_lists_links_that_there_are(tmp_path):
    need("host")
    place, reported = f"{tmp_path}/radio", []
    trial = load_trial("gloria-sketch")
    trial = trial.changed(
        {"autopilot.main.mega.monitors": f"2=pty:{place}", "stop": "0.2 s"}, "test"
    )
    trial = trial.in_real_time({}, "test")
    hooks = Hooks(reachable=lambda name, where: reported.append((name, where)))
    assert run_trial(trial, tmp_path / "run", engine="direct", hooks=hooks).status == "complete"
    assert reported == [
        ("autopilot.main.mega", place)
    ]  # and not of instruments that nothing outside reads


def test_the_station_keeper_drives(tmp_path):
    result = sailed("hydrone-sketch", tmp_path / "run", stop="3 s")
    pulse = f"{board('hydrone-sketch')}.pulse.s1"
    assert rows(result)[-1][pulse] != rows(result)[0][pulse]


def test_a_sketch_that_crashes_leaves_the_record_whole(tmp_path):
    need("host")
    source = "void setup() {}\nvoid loop() { delay(1005); *(volatile byte *)0 = 1; }\n"
    sketch = write_sketch(tmp_path, source)
    trial = load_trial("gloria-sketch")
    trial = trial.changed({"autopilot.main.mega.sketch": str(sketch), "stop": "5 s"}, "test")
    result = run_trial(trial, tmp_path / "run", engine="direct")
    assert result.status != "complete"
    assert "Segmentation fault" in str(result.error)
    assert float(rows(result)[-1]["time"]) == pytest.approx(1.0, abs=0.21)


@pytest.mark.long
def test_two_hours_of_gusts_and_no_drift(tmp_path):
    """The sketch's clock, in its telemetry, and the trial's."""
    need("host")
    trial = load_trial("gloria-sketch").changed({"stop": "7200 s"}, "test")
    # The radio's line: a report takes 8 ms there, so a step of 20 ms has it whole.
    record = trial.file.record.model_copy(
        update={"signals": ["autopilot.main.mega.tx.uart2"], "every": "1 s"}
    )
    trial = replace(trial, file=trial.file.model_copy(update={"record": record}))
    result = run_trial(trial, tmp_path / "run", engine="direct")
    assert result.status == "complete", result.error
    found = []
    for row in rows(result):
        for when, data in decode(row["autopilot.main.mega.tx.uart2"])[1]:
            found += [(when, match) for match in re.findall(rb"\$GLO,(\d+),", data)]
    assert len(found) > 7000
    assert max(abs(int(clock) / 1e3 - when / 1e9) for when, clock in found) < 0.05
