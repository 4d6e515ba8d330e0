"""REMUS-100 by data: published equations, and trajectories computed by the source's own code."""

import csv
import math

import numpy as np
import pytest

from seatrial.physics.craft.terms.spheroid import displaced_mass, inertia, lamb
from seatrial.system.parameters import load_vehicle
from tests.craft.references import DATA, STATES, assert_met, shipped

FULL = 1525.0
"""rpm at order 1."""
DEGREES = math.radians(5)
CASES = {
    "straight": [(0, FULL, 0, 0), (30, 0, 0, 0)],
    "rudder_step": [(0, 1200, 0, 0), (20, 1200, DEGREES, 0), (60, 1200, 0, 0)],
    "dive": [(0, FULL, 0, 0), (20, FULL, 0, -DEGREES), (35, FULL, 0, DEGREES), (50, FULL, 0, 0)],
}
"""Time, rpm, rudder and stern planes of each change of the orders."""
ACTUATORS = ("delta_r", "delta_s", "n")
EXACT = {"rtol": 1e-12, "atol": 1e-13}


def columns(case):
    """Return the columns by name; below the names stands a row of units."""
    with (DATA / f"remus100_{case}.csv").open() as file:
        _units, *rows = csv.DictReader(file)
    return {key: np.array([float(row[key]) for row in rows]) for key in rows[0]}


def auv(variant=None, **values):
    return shipped("fitted-craft", "remus100.hull", variant, **values)


def orders(case, t):
    _, n, rudder, planes = [row for row in CASES[case] if row[0] <= t][-1]
    return {"propulsor_order": [n / FULL] + 7 * [0], "foil_angle": [rudder, planes] + 6 * [0]}


def of_the_source(names, x):
    """Return the columns of a reference from states of ours."""
    lags = [names.index(name) for name in ("lagged_foil.f1", "lagged_foil.f2", "lagged_order.p1")]
    return np.hstack([x[:, :12], x[:, lags] * (1, 1, FULL)])


@pytest.mark.parametrize("case", CASES)
def test_trajectories_are_those_of_the_source(case):
    expected, component = columns(case), auv()
    breaks = [t for t, *_ in CASES[case][1:]]
    run = component.reference(expected["t"], lambda t, x: orders(case, t), breaks)
    found = of_the_source(run.x_names, run.x)
    assert_met(found, expected, (*STATES, *ACTUATORS), tolerance=1e-6, least=1e-15)


@pytest.mark.parametrize("case", CASES)
def test_steps_of_10_ms_follow_the_source(case):
    expected, component = columns(case), auv()
    component.initialise()
    component.begin()
    names, rows = component.compiled().x_names, []
    for k in range(len(expected["t"])):
        rows.append([v for p in component.state_ports for v in component.get(p.name)])
        for name, value in orders(case, k / 10).items():
            component.set(name, value)
        for i in range(10):
            component.advance(k / 10 + i / 100, 0.01)
    found = of_the_source(names, np.array(rows))
    assert_met(found, expected, (*STATES, *ACTUATORS), tolerance=1e-6, least=1e-15)


def test_the_numbers_are_those_of_the_spheroid():
    entries = load_vehicle("remus100").parameter_set("hull", None).values
    value = {name: entry.value for name, entry in entries.items()}
    m = displaced_mass(1.6, 0.19, 1026.0)
    about, across = inertia(m, 1.6, 0.19)
    k = lamb(1.6, 0.19)
    assert value["mass"] == pytest.approx(m, rel=1e-14)
    assert value["buoyancy"] == pytest.approx(9.81 * m, rel=1e-14)
    assert value["inertia"][:3] == pytest.approx([about, across, across], rel=1e-14)
    assert value["added_mass"][:3] == pytest.approx([m * k.k1, m * k.k2, m * k.k2], rel=1e-14)
    added = [0.3 * about, k.k_prime * across, k.k_prime * across]
    assert value["added_inertia"][:3] == pytest.approx(added, rel=1e-14)
    M = np.diag(auv().mass_matrix())
    arm = m * 9.81 * 0.02
    roll, pitch = 0.6 * math.sqrt(arm * M[3]), 1.6 * math.sqrt(arm * M[4])
    assert value["linear_damping_moment"] == pytest.approx([roll, pitch, M[5]], rel=1e-13)
    assert value["fading_damping_force"] == pytest.approx(M[:2] / 20, rel=1e-13)
    assert value["linear_damping_force"] == pytest.approx([0, 0, M[2] / 20], rel=1e-13)


def test_through_the_water_a_current_carries_it_and_over_ground_it_does_not():
    water, t = np.array([0.4, -0.3, 0.0]), np.arange(0, 41.0, 10)
    drive = {"propulsor_order": [0.8] + 7 * [0], "foil_angle": [0.05, 0.02] + 6 * [0]}

    def off(variant):
        still = auv(variant).reference(t, lambda t, x: drive, **EXACT)
        carried = auv(variant, velocity_start=water)
        carried = carried.reference(t, lambda t, x: {**drive, "current": water}, **EXACT)
        return np.abs(carried.x[:, :3] - still.x[:, :3] - np.outer(t, water)).max()

    assert off("through-water") < 1e-8
    assert off("source") > 1


def test_both_variants_go_straight_alike():
    # On a straight course in still water the flow at the propeller is the speed over ground.
    t = np.arange(0, 31.0, 10)
    drive = {"propulsor_order": [1] + 7 * [0]}
    level = {"propulsor_moment_share_1": 0, "center_of_gravity": (0, 0, 0)}
    source, ours = (
        auv(variant, **level).reference(t, lambda t, x: drive)["velocity.u"]
        for variant in ("source", "through-water")
    )
    np.testing.assert_allclose(source, ours, rtol=1e-9)
