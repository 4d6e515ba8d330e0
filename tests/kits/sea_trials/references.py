"""Records and figures of the KVLCC2 by the MMG standard method (Yasukawa and Yoshimura 2015).

They were computed by a program independent of this project; the ship is 320 m long, the model 7 m.
"""

import json
from functools import cache
from pathlib import Path

import numpy as np

from seatrial_kits.sea_trials.figures.record import Record

FOLDER = Path(__file__).parents[2] / "reference"
FIGURES = json.loads((FOLDER / "kvlcc2_figures.json").read_text("utf-8"))
TURNS = [name for name in FIGURES if "turn" in name]
ZIG_ZAGS = [name for name in FIGURES if "zigzag" in name]


@cache
def columns(name):
    """Return time, north, east, heading and rudder, positive to turn to starboard."""
    rows = np.loadtxt(FOLDER / f"{name}.csv", delimiter=",", skiprows=2)
    return rows[:, [0, 1, 2, 3, 7]].T


def record(name, every=1):
    time, north, east, heading, rudder = (each[::every] for each in columns(name))
    return Record(time, north, east, heading, rudder)
