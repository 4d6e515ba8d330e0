"""Passes of the references of KVLCC2 and Otter, which were computed independently of this project.

Orders are the inputs of the craft: rudder and shaft of the ship, thrust of the two propellers.
"""

from pathlib import Path

import numpy as np

from seatrial_kits.identify.manoeuvres.passes import Pass
from seatrial_kits.sea_trials.figures.record import Record

FOLDER = Path(__file__).parents[3] / "reference"
GNSS, COMPASS = 1.0, np.radians(0.3)
AHEAD, ASTERN, ARM = 0.01108, 0.006445, 0.395
"""Of the Otter's propellers: N s2/rad2, and their distance from the centre line, m."""


def noisy(time, north, east, heading, seed, errors=(GNSS, COMPASS)):
    """Return a record with normal errors of position and heading, none without a seed."""
    if seed is None:
        return Record(time, north, east, heading)
    random, rows = np.random.default_rng(seed), len(time)
    place, angle = errors
    return Record(
        time,
        north + place * random.standard_normal(rows),
        east + place * random.standard_normal(rows),
        heading + angle * random.standard_normal(rows),
    )


def kvlcc2(name, seed=None, last=None):
    rows = np.loadtxt(FOLDER / f"kvlcc2_{name}.csv", delimiter=",", skiprows=2)[:last]
    orders = {"rudder": -rows[:, 7], "propeller_order": np.ones(len(rows))}
    return Pass(Path(name), noisy(*rows[:, :4].T, seed), orders)


def otter(name, seed=None, errors=(0.02, COMPASS)):
    rows = np.genfromtxt(FOLDER / f"otter_{name}.csv", delimiter=",", names=True)
    port, starboard = (_thrust(rows[each]) for each in ("n1", "n2"))
    orders = {"force_1.x": port + starboard, "moment_1.z": ARM * (port - starboard)}
    orders |= dict.fromkeys(("force_1.y", "force_1.z", "moment_1.x", "moment_1.y"), 0.0 * port)
    record = noisy(rows["t"], rows["x"], rows["y"], rows["psi"], seed, errors)
    return Pass(Path(name), record, orders)


def _thrust(rate):
    return np.where(rate > 0.0, AHEAD, ASTERN) * rate * np.abs(rate)
