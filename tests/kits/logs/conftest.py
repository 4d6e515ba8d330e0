"""Runs with signals of all types, and their records as the csv module reads them."""

from __future__ import annotations

import base64
import csv
import json
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

from seatrial.trial.files.trial import load_trial
from seatrial.trial.records.run_folder import Run, load_run
from seatrial.trial.running.run import run_trial

BUOY = '''
"""A buoy that publishes all there is."""
from seatrial.model.component import Output
from seatrial.model.sampled import Sampled


class Buoy(Sampled):
    """Numbers that are no round ones, counts, flags, and texts that look like something else."""

    position = Output("m", "position, 100 % made up", axes=("x", "y"))
    count = Output("1", "instants", type=int)
    wet = Output("1", "whether wet", type=bool)
    label = Output("1", "what it says", type=str)
    number = Output("1", "a text of digits", type=str)

    def sample(self, t, k):
        self.position = (0.1 * k / 3.0, -1e-300 * k)
        self.count, self.wet = -k, k % 2 == 1
        self.label = f'é "{k}",\\n%s \\\\ {{x}}'
        self.number = f"0{k}"
'''
TRIAL = """
rig = "rig.toml"
stop = "{stop}"
start = "{start}"
"""
RIG = """
step = "10 ms"
[components]
red = { fmu = "buoy.py:Buoy" }
green = { fmu = "buoy.py:Buoy" }
"""
READ: dict[str, Callable[[str], Any]] = {
    "Real": float,
    "Integer": int,
    "Boolean": lambda cell: bool(int(cell)),
    "String": str,
    "Binary": base64.b64decode,
}


@pytest.fixture
def make_run(write, tmp_path: Path) -> Callable[..., Run]:
    write("buoy.py", BUOY)
    write("rig.toml", RIG)

    def make(start: str = "0 s", stop: str = "1 s") -> Run:
        trial = write("trial.toml", TRIAL.format(start=start, stop=stop))
        return load_run(run_trial(load_trial(str(trial)), tmp_path / "run", engine="direct").folder)

    return make


@pytest.fixture
def foreign(tmp_path: Path) -> Run:
    """Return a run with bytes, arrays and a signal below another, as other makers' FMUs have."""
    signals = {
        "box.raw": ("Binary", ""),
        "box.a[1]": ("Real", "m"),
        "box.a[2]": ("Real", "m"),
        "box.b": ("Real", "kg"),
        "box.b.c": ("Real", "kg"),
        "box.b.c.d": ("Integer", ""),
        "box.e.f.g": ("Boolean", ""),
    }
    raw = base64.b64encode(b"\0\xff%s").decode()
    rows = [[0.0, raw, 1.5, 2.5, 3.5, 4.5, 5, 1], [0.1, "", -0.0, 5e-324, 1e300, 0.1, -(2**31), 0]]
    folder = tmp_path / "foreign"
    folder.mkdir()
    with (folder / "signals.csv").open("w", newline="") as file:
        csv.writer(file, lineterminator="\n").writerows([["time", *signals], *rows])
    manifest = {
        "format": 1,
        "trial": {"name": "foreign", "file": "foreign.toml", "sha256": ""},
        "rig": {"name": "foreign", "file": "foreign.toml", "sha256": ""},
        "components": {"box": {"fmu": "box.fmu", "sha256": "", "step": 0.1, "parameters": {}}},
        "connections": [],
        "signals": {
            name: {"type": kind, "unit": unit, "description": f"about {name}"}
            for name, (kind, unit) in signals.items()
        },
        "criteria": [],
        "status": "complete",
    }
    (folder / "manifest.json").write_text(json.dumps(manifest))
    return load_run(folder)


def recorded(run: Run) -> tuple[list[int], dict[str, list[Any]]]:
    """Return the times, ns, and the columns of the record, each cell read by its type."""
    with (run.folder / "signals.csv").open(newline="", encoding="utf-8") as file:
        header, *rows = csv.reader(file)
    kinds = {name: run.manifest["signals"][name]["type"] for name in header[1:]}
    columns = {
        name: [READ[kinds[name]](row[i]) for row in rows]
        for i, name in enumerate(header[1:], 1)
    }  # fmt: skip
    return [round(float(row[0]) * 1e9) for row in rows], columns
