"""A craft by a panel code's tables: motions solved in frequency, energy, and what is refused."""

import math
import re
from pathlib import Path

import numpy as np
import pytest

from seatrial.errors import InputError
from seatrial.physics.craft.marine_craft import MarineCraft
from seatrial_kits.panels.panel_files import read_panels
from seatrial_kits.panels.seakeeping_craft import SeakeepingCraft
from tests.craft.fleet import states
from tests.craft.test_seaway import amplitude

TABLES = Path(__file__).parents[2] / "reference/barge_capytaine.nc"
MASS, ABOVE = 205.0, 0.06
HELD = [2e4, 2e4, 0.0], [50.0, 0.0, 5e3]
"""Damping that holds surge, sway and yaw, and of roll, which radiates next to nothing."""
STIFFNESS = np.diag([0.0, 0.0, 10055.25, 127.588, 3269.21, 0.0])


def barge(kind=SeakeepingCraft, **changes):
    craft, weight = kind("barge"), MASS * 9.81
    about_cg = [8.2 - MASS * ABOVE**2, 51.25 - MASS * ABOVE**2, 51.25, 0, 0, 0]
    values = {
        "mass": MASS,
        "center_of_gravity": [0, 0, ABOVE],
        "inertia": about_cg,
        "restoring": "surface-linear",
        "waterplane_area": 1.0,
        "GM_T": STIFFNESS[3, 3] / weight,
        "GM_L": STIFFNESS[4, 4] / weight,
        "linear_damping_force": HELD[0],
        "linear_damping_moment": HELD[1],
    }
    if kind is SeakeepingCraft:
        values |= {"panel_file": str(TABLES), "terms": "restoring damping radiation wave-loads"}
    for name, value in {**values, **changes}.items():
        craft.set(name, value)
    return craft


def motion_in_frequency(tables, i, j):
    """Return the motions per metre of amplitude from the tables themselves."""
    w = tables.omega[i]
    inertia = np.diag([MASS, MASS, MASS, 8.2, 51.25, 51.25])
    inertia[0, 4] = inertia[4, 0] = MASS * ABOVE
    inertia[1, 3] = inertia[3, 1] = -MASS * ABOVE
    damping = tables.damping[i] + np.diag([*HELD[0], *HELD[1]])
    impedance = -(w**2) * (inertia + tables.added[i]) + 1j * w * damping + STIFFNESS
    return np.linalg.solve(impedance, tables.excitation[:, i, j])


@pytest.mark.slow
@pytest.mark.sampled(4)
@pytest.mark.parametrize(
    ("omega", "degrees"), [(2.4, 180), (4.0, 180), (3.2, 135), (5.2, 90), (2.8, 300)]
)
def test_motions_in_waves_are_those_solved_in_frequency(omega, degrees):
    tables = read_panels(TABLES, 1025.0, 9.81)
    i = int(np.argmin(abs(tables.omega - omega)))
    j = int(np.argmin(abs(tables.chi - math.radians(degrees))))
    w, slope = float(tables.omega[i]), float(tables.omega[i]) ** 2 / 9.81
    craft = barge(
        sea_spectrum="regular",
        sea_height=2e-3,
        sea_period=math.tau / w,
        sea_direction=math.radians(degrees),
    )
    x = states(craft, 60.0, 0.02)
    t = np.arange(len(x)) * 0.02
    wanted = motion_in_frequency(tables, i, j)
    for column, scale in ((2, 1.0), (3, slope), (4, slope)):
        off = amplitude(x[:, column], t, w) / 1e-3 - wanted[column]
        # What the memory misses of the tables: 5 % of radiation, 2.5 % of the motions.
        assert abs(off) < 0.025 * max(scale, abs(wanted[column]))


@pytest.mark.slow
def test_left_alone_it_loses_energy_to_its_waves_and_comes_to_rest():
    still = {"linear_damping_force": [0, 0, 0], "linear_damping_moment": [50.0, 0, 0]}
    craft = barge(**still, position_start=[0, 0, 0.05], attitude_start=[0.05, 0.05, 0])
    x = states(craft, 40.0, 0.02)
    inertia = craft.mass_matrix()
    nu, place = x[:, 6:12], np.concatenate([x[:, :3], x[:, 3:6]], 1)
    stored = 0.5 * (
        np.einsum("ti,ij,tj->t", nu, inertia, nu)
        + np.einsum("ti,ij,tj->t", place, STIFFNESS, place)
        + np.square(x[:, 12:]).sum(1)
    )
    # To first order: Euler angles are not the integral of the rates.
    assert (np.diff(stored) < 1e-3 * stored[:-1] + 1e-9).all()
    assert stored[-1] < 0.02 * stored[0]
    assert abs(x[-1, [2, 4]]).max() < 1e-4


def test_steady_speed_is_not_held_back():
    craft = barge(terms="restoring radiation", velocity_start=[1.0, 0, 0], panel_file=str(TABLES))
    x = states(craft, 60.0, 0.02)
    assert x[-1, 6] == pytest.approx(x[-500, 6], rel=2e-3)
    assert x[-1, 6] > 0.8


def test_without_a_file_it_is_a_marine_craft():
    given = {
        "added_mass": [30, 180, 250, 0, 0, 0],
        "added_inertia": [2, 60, 40, 0, 0, 0],
        "attitude_start": [0.1, 0.05, 0.3],
        "velocity_start": [0.5, 0.1, 0.0],
        "terms": "restoring coriolis damping",
    }
    plain = states(barge(MarineCraft, **given), 5.0, 0.02)
    own = states(barge(**given, panel_file=""), 5.0, 0.02)
    np.testing.assert_allclose(own[:, :12], plain, rtol=1e-12, atol=1e-14)
    assert not own[:, 12:].any()


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"added_mass": [1, 0, 0, 0, 0, 0]}, "added_mass is given, and panel_file has it too"),
        ({"waterplane_area": 1.5}, "lift the hull by"),
        ({"terms": "restoring damping"}, "radiation is missing"),
        ({"panel_file": "none.nc"}, "none.nc"),
        ({"panel_file": "hull.dat"}, "kind of panel code file"),
        (
            {"terms": "restoring radiation", "sea_spectrum": "regular", "sea_height": 0.1}
            | {"sea_period": 3.0},
            "wave-loads is missing",
        ),
    ],
)
def test_what_contradicts_the_file_is_refused(changes, message):
    craft = barge(**changes)
    craft.setup(0.0)
    with pytest.raises(InputError, match=re.escape(message)):
        craft.initialise()
        craft.begin()


def test_it_starts_twice_with_the_same_numbers():
    craft = barge()
    first = states(craft, 0.1, 0.02)
    again = states(craft, 0.1, 0.02)
    assert craft.memory_omega[0] > 0.0
    np.testing.assert_array_equal(first, again)
