"""Passes of the references of the KVLCC2, which were computed independently of this project.

Orders are the inputs of the craft: rudder and shaft.
"""

from pathlib import Path

import numpy as np

from seatrial_kits.identify.manoeuvres.passes import Pass
from seatrial_kits.sea_trials.figures.record import Record

FOLDER = Path(__file__).parents[3] / "reference"
GNSS, COMPASS = 1.0, np.radians(0.3)


def noisy(time, north, east, heading, seed):
    """Return a record with normal errors of position and heading, none without a seed."""
    if seed is None:
        return Record(time, north, east, heading)
    random, rows = np.random.default_rng(seed), len(time)
    return Record(
        time,
        north + GNSS * random.standard_normal(rows),
        east + GNSS * random.standard_normal(rows),
        heading + COMPASS * random.standard_normal(rows),
    )


def kvlcc2(name, seed=None, last=None):
    rows = np.loadtxt(FOLDER / f"kvlcc2_{name}.csv", delimiter=",", skiprows=2)[:last]
    orders = {"rudder": -rows[:, 7], "propeller_order": np.ones(len(rows))}
    return Pass(Path(name), noisy(*rows[:, :4].T, seed), orders)
