"""Records of which not every row, or not every signal, is looked at."""

import json
from dataclasses import replace

import numpy as np
import pytest

from seatrial.trial.records.run_folder import load_run
from seatrial.trial.reports.thinning import thinned


@pytest.fixture
def run(tmp_path):
    """1000 rows of two signals, in which one row of each is far out; and no number."""
    rows = np.arange(1000.0)
    wave, step = np.sin(rows), np.where(rows < 500.0, 0.0, 1.0)
    wave[321], step[654], wave[100:200] = 99.0, -99.0, np.nan
    lines = [f"{t!r},{a!r},{b!r}" for t, a, b in zip(*map(np.ndarray.tolist, (rows, wave, step)),
                                                      strict=True)]  # fmt: skip
    (tmp_path / "signals.csv").write_text("time,a.wave,a.step\n" + "\n".join(lines) + "\n")
    signals = {name: {"type": "Real", "unit": "m", "description": name}
               for name in ("a.wave", "a.step")}  # fmt: skip
    (tmp_path / "manifest.json").write_text(
        json.dumps(
            {
                "format": 1,
                "trial": {"name": "long", "file": "long.toml", "sha256": ""},
                "rig": {"name": "long", "file": "long.toml", "sha256": ""},
                "components": {"a": {"fmu": "a.fmu", "sha256": "", "step": 1.0, "parameters": {}}},
                "connections": [],
                "signals": signals,
                "criteria": [],
                "status": "complete",
            }
        )
    )
    return load_run(tmp_path)


def test_a_thinned_record_has_the_extremes_and_the_ends(run):
    found = thinned(run, 82)
    assert len(found.time) <= 82
    assert (found.time[0], found.time[-1]) == (0.0, 999.0)
    assert {321.0, 654.0} <= {*found.time}
    rows = found.time.astype(int)
    for name, values in found.signals.items():
        np.testing.assert_array_equal(values, run.signals[name][rows])
        stretches = np.array_split(run.signals[name], 20)
        for part, first in zip(stretches, np.cumsum([0, *map(len, stretches)]), strict=False):
            inside = values[(rows >= first) & (rows < first + len(part))]
            if np.isfinite(part).any():
                assert (np.nanmin(inside), np.nanmax(inside)) == (np.nanmin(part), np.nanmax(part))


def test_a_short_record_stays(run):
    assert thinned(run, 1000) is run


def test_a_record_of_the_time_alone_stays(run):
    alone = replace(run, signals={})
    assert thinned(alone, 82) is alone


def test_signals_that_are_not_wanted_are_not_read(run):
    found = load_run(run.folder, ["a.step"])
    assert list(found.signals) == ["a.step"]
    np.testing.assert_array_equal(found.signals["a.step"], run.signals["a.step"])
    np.testing.assert_array_equal(found.time, run.time)
