"""The search against a brute-force one over the printed table."""

import math
from importlib.resources import files

import numpy as np
import pytest

from seatrial.physics.foils import FoilTable, sail_naca0015
from seatrial_kits.sailing.control.sail_search import best_setting, setting

TABLE = sail_naca0015("verbatim", "table")
PRINTED = np.loadtxt(files("seatrial") / "physics/sail_naca0015.csv", delimiter=",", skiprows=1)
LIFT, DRAG = (PRINTED[:, column].reshape(7, 37) for column in (2, 3))
DEG = math.radians(1.0)
WINDS = [-10, -33, -52, -71, -88, -95, -104]


def brute_force(beta, alphas):
    """Return (angle, flap, drive, side) for all flaps and these alphas, rad, in rows."""
    grid = np.radians(np.arange(0, 181, 5))
    rows = []
    for row in range(7):
        c_l, c_d = (np.interp(alphas, grid, table[row]) for table in (LIFT, DRAG))
        drive = -c_l * np.sin(beta) + c_d * np.cos(beta)
        side = c_l * np.cos(beta) + c_d * np.sin(beta)
        angle = beta - alphas + np.pi
        rows.append(np.column_stack([angle, np.full_like(angle, row * 5 * DEG), drive, side]))
    return np.vstack(rows)


@pytest.mark.parametrize("beta", WINDS)
def test_greatest_drive_of_the_table(beta):
    beta *= DEG
    found = best_setting(TABLE, beta, 0.0, math.pi / 2)
    offered = brute_force(beta, np.radians(np.arange(0, 181, 5)))
    offered = offered[(offered[:, 0] >= 0.0) & (offered[:, 0] <= math.pi / 2)]
    best = offered[np.argmax(offered[:, 2])]
    if found.angle == math.pi / 2:  # the end of the range is in it
        assert found.drive >= best[2]
    else:
        assert found == pytest.approx(best, rel=1e-12)


@pytest.mark.parametrize("most_side", [0.3, 0.8, 1.5])
@pytest.mark.parametrize("beta", WINDS)
def test_greatest_drive_within_a_side_force(beta, most_side):
    """No alpha up to 90 degrees, in steps of a hundredth, gives more."""
    beta *= DEG
    found = best_setting(TABLE, beta, 0.0, math.pi / 2, most_side)
    offered = brute_force(beta, np.radians(np.arange(0, 90.001, 0.01)))
    offered = offered[(offered[:, 0] >= 0.0) & (offered[:, 0] <= math.pi / 2)]
    allowed = offered[np.abs(offered[:, 3]) <= most_side]
    if len(allowed):
        assert abs(found.side) <= most_side
        # The table's rows and where the limit is reached are the corners of a linear problem.
        assert found.drive == pytest.approx(allowed[:, 2].max(), rel=2e-3, abs=1e-3)
    else:
        assert abs(found.side) <= np.abs(offered[:, 3]).min() + 0.02


def test_what_cannot_keep_to_the_side_force_has_the_least():
    beta = -45 * DEG
    found = best_setting(TABLE, beta, 0.0, math.pi / 2, 0.0)
    assert found.side != 0.0
    offered = brute_force(beta, np.radians(np.arange(45, 91, 5)))
    assert abs(found.side) == pytest.approx(np.abs(offered[:, 3]).min(), rel=1e-12)


def test_a_searched_setting_gives_what_it_says():
    for beta in WINDS:
        found = best_setting(TABLE, beta * DEG, 0.0, math.pi / 2, 0.9)
        assert setting(TABLE, beta * DEG, found.angle, found.flap) == pytest.approx(found, rel=1e-9)


def test_dead_downwind_the_flap_is_5_degrees():
    """A search over all angles, cut off afterwards, would take 20: the boat is then slower."""
    assert best_setting(TABLE, 0.0, 0.0, math.pi / 2).flap == pytest.approx(5 * DEG)


@pytest.mark.parametrize(
    ("rows", "flap", "alpha"),
    [
        # Columns of the greatest drag, by flap; dead downwind drag is drive.
        ({0: [18], 1: [25]}, 0, 90),
        ({0: [25], 1: [18]}, 0, 125),
        ({1: [20, 27], 2: [22]}, 5, 100),
    ],
)
def test_of_equals_the_smallest_flap_then_the_smallest_alpha_is_taken(rows, flap, alpha):
    drag = np.zeros((3, 37))
    for row, columns in rows.items():
        drag[row, columns] = 1.0
    table = FoilTable(tuple(map(tuple, np.zeros((3, 37)))), tuple(map(tuple, drag)))
    found = best_setting(table, 0.0, 0.0, math.pi / 2)
    assert found.flap == pytest.approx(flap * DEG)
    assert found.angle == pytest.approx((180 - alpha) * DEG)
