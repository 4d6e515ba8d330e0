"""A long run: the exact number of steps and rows, and no growth of memory."""

from __future__ import annotations

import csv
import os
from pathlib import Path

import pytest

from seatrial.trial.files.trial import load_trial
from seatrial.trial.running.run import Hooks, run_trial

pytestmark = pytest.mark.interop

RIG = """
step = "10 ms"

[components]
hull       = { fmu = "marine-craft", parameters = "hydrone" }
thruster   = { fmu = "thruster", set = { pulse = "1600 us" } }
propulsion = { fmu = "propulsion", parameters = "hydrone" }

[connections]
"thruster.thrust"   = ["propulsion.thrust.t1", "propulsion.thrust.t2"]
"propulsion.force"  = "hull.force_1"
"propulsion.moment" = "hull.moment_1"
"""
TRIAL = 'rig = "soak.toml"\nstop = "{hours} h"\n[record]\nevery = "1 s"\n'


def resident() -> int:
    """Resident memory of this process, bytes."""
    pages = int(Path("/proc/self/statm").read_text().split()[1])
    return pages * os.sysconf("SC_PAGE_SIZE")


@pytest.mark.parametrize("hours", [0.25, pytest.param(24.0, marks=pytest.mark.long)])
def test_hours_of_simulated_time(hours: float, tmp_path: Path) -> None:
    (tmp_path / "soak.toml").write_text(RIG, "utf-8")
    path = tmp_path / "long.toml"
    path.write_text(TRIAL.format(hours=hours), "utf-8")
    peak = [0, 0, 0, 0, 0, 0]  # in each fifth; a list of all samples would itself grow

    def watch(passed: float, whole: float) -> None:
        fifth = int(5 * passed / whole)
        peak[fifth] = max(peak[fifth], resident())

    result = run_trial(load_trial(str(path)), tmp_path / "run", hooks=Hooks(progress=watch))
    assert result.status == "complete"
    with (tmp_path / "run" / "signals.csv").open(newline="") as file:
        rows = csv.reader(file)
        next(rows)
        count, last = 0, -1.0
        for row in rows:
            assert float(row[0]) == last + 1.0  # a row each second, at the second exactly
            count, last = count + 1, float(row[0])
    assert (count, last) == (round(hours * 3600) + 1, hours * 3600.0)
    assert peak[4] - peak[0] < 500_000
    print(f"{hours} h: resident memory grew by {peak[4] - peak[0]} bytes from the first fifth on")
