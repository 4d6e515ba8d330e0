"""A user's experiment: a log of their own and the file that describes it."""

import csv

import numpy as np
import pytest

from benchmarks.identification import CASES, PERIOD, synthetic

EXPERIMENT = """
title = "Surge in the pool"
axis = "surge"
log = "pool.csv"

[columns]
time = { name = "t", unit = "s" }
command = { name = "beta", unit = "%" }
acceleration = { name = "ax", unit = "cm/s2" }
roll = { name = "roll", unit = "deg" }
pitch = { name = "pitch", unit = "deg" }

[known]
mass = "6.5 kg"
thrust = "93.41 N"
source = "weighed"
"""


@pytest.fixture(scope="session")
def surge():
    """Return columns of a log of 60 s as a user's device writes them, gravity included."""
    run = synthetic(CASES[1], 11)
    rows = 600
    t = np.arange(rows) * PERIOD
    pitch, roll = 3.0 * np.sin(0.7 * t), 5.0 + np.cos(t)
    reading = run.log.measured[:rows] + 9.81 * np.sin(np.radians(pitch))
    return {
        "t": [f"{value:.1f}" for value in t],
        "beta": [repr(100.0 * float(value)) for value in run.log.command[:rows]],
        "ax": [repr(100.0 * float(value)) for value in reading],
        "roll": [repr(float(value)) for value in roll],
        "pitch": [repr(float(value)) for value in pitch],
    }


@pytest.fixture
def pool(tmp_path, surge):
    """Return a function that writes log and experiment, changed, and returns the latter's path."""

    def write(columns=None, text=EXPERIMENT, rows=None):
        columns = surge if columns is None else columns
        with (tmp_path / "pool.csv").open("w", newline="") as file:
            writer = csv.writer(file)
            writer.writerow(columns)
            writer.writerows(list(zip(*columns.values(), strict=True))[:rows])
        path = tmp_path / "pool.toml"
        path.write_text(text, "utf-8")
        return path

    return write
