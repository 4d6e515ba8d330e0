"""Loads by strips against motions computed elsewhere, and loads in time."""

import math

import numpy as np
import pytest

from seatrial.errors import InputError
from seatrial.physics.sea.dispersion import wave_number
from seatrial.physics.sea.loads import WaveLoads, tabulated
from seatrial.physics.sea.spectra import Jonswap
from seatrial.physics.sea.strips import Strips
from seatrial.physics.sea.waves import irregular, regular

from .references import content, table


def strips_of(body, **changes):
    given = content(f"strip_{body}")
    at = {key: np.array(value) for key, value in given["sections"].items()}
    zero = np.zeros_like(at["x"])
    settings = {
        "x": at["x"],
        "beam": at["b"],
        "area": at["S"],
        "draught": at["T"],
        "a42": zero,
        "b42": zero,
        "hulls": tuple(given["hull_y"]),
        "round": body == "cat_13",
        **{key: at[key] for key in ("a33", "b33", "a22", "b22")},
    }
    return Strips(**(settings | changes)), given


def phasor(row, name):
    return row[f"{name}_amp"] * np.exp(1j * math.radians(row[f"{name}_deg"]))


@pytest.mark.parametrize("body", ["barge_T020", "cat_13", "wigley_160"])
def test_forces_and_motions_by_strips_are_those_of_the_reference(body):
    strips, given = strips_of(body)
    added, damping = strips.added_mass_and_damping()
    inertia = np.diag([given["mass"], given["I44"], given["I55"]])
    stiffness = np.diag([given["C33"], given["C44"], given["C55"]])
    rows = table(f"strip_{body}")
    scale = {n: rows[f"{n}_amp"].max() for n in ("F_heave", "F_pitch", "X_heave", "X_pitch")}
    for row in rows:
        w = np.array([row["omega"]])
        force = strips.forces(w, wave_number(w), math.radians(row["direction_deg"]))[:, 0]
        impedance = -(w[0] ** 2) * (inertia + added) + 1j * w[0] * damping + stiffness
        motion = np.linalg.solve(impedance, force[2:5])
        found = {
            "F_heave": force[2],
            "F_pitch": force[4],
            "X_heave": motion[0],
            "X_pitch": motion[2],
        }
        for name, value in found.items():
            assert abs(value - phasor(row, name)) < 1e-6 * scale[name]
        if len(strips.hulls) > 1:
            assert abs(motion[1] - phasor(row, "X_roll")) < 1e-6 * rows["X_roll_amp"].max()


@pytest.mark.parametrize(
    ("body", "shortest", "near"), [("barge_T020", 10.0, 0.06), ("cat_13", 28.0, 0.1)]
)
def test_a_hull_in_long_beam_seas_sways_as_by_panels_whatever_its_constant_damping(
    body, shortest, near
):
    strips, given = strips_of(body)
    coefficients = table(f"coef_{body}")
    rows = table(f"rao_{body}")
    rows = rows[(rows["direction_deg"] == 90) & (rows["omega"] < 6.0)]
    beam, compared = max(given["sections"]["b"]), 0
    for row in rows:
        w = row["omega"]
        k = wave_number(np.array([w]))
        if math.tau / k[0] < shortest * beam:
            continue
        own = coefficients[np.argmin(np.abs(coefficients["omega"] - w))]
        panels = phasor(row, "F_sway") / (
            -(w**2) * (given["mass"] + own["A22"]) + 1j * w * own["B22"]
        )
        for damping in (1.0, 0.0):
            part, _ = strips_of(body, b22=damping * strips.b22)
            A, D = (len(part.hulls) * c.sum() * part.spacing for c in (part.a22, part.b22))
            force = part.forces(np.array([w]), k, math.pi / 2)[1, 0]
            found = force / (-(w**2) * (given["mass"] + A) + 1j * w * D)
            assert abs(found - panels) < near
        assert abs(force) == pytest.approx(row["F_sway_amp"], rel=0.25)
        compared += 1
    assert compared > 4


def test_force_by_haskind_has_the_size_that_damping_says():
    sections = table("sections")
    circle = sections[sections["section"] == "half_circle"]
    radius, density = 0.0725, 1025.0
    w = np.sqrt(circle["K_b_half"] * 9.81 / radius)
    a33 = np.tile(density * radius**2 * circle["a33"], (20, 1))
    b33 = np.tile(density * radius**2 * circle["b33"] * w, (20, 1))
    strips, _ = strips_of("cat_13", a33=a33, b33=b33, hulls=(0.0,), haskind=True)
    force = strips.forces(w, wave_number(w), math.pi / 2)[2]
    per_length = np.sqrt(density * 9.81**2 * b33[0] / w)
    np.testing.assert_allclose(abs(force), 1.3 * per_length, rtol=1e-12)


def test_loads_in_time_are_the_sum_of_the_components():
    strips, _ = strips_of("barge_T020")
    sea = irregular(Jonswap(0.2, 2.5), direction=0.7, seed=3, high=8.0)
    found = WaveLoads(sea, strips.forces).at(12.3, 4.0, -2.0, -0.43)
    phasors = sea.phasors(12.3, np.array([4.0, -2.0]))
    expected = (strips.forces(sea.omega, sea.k, sea.direction + 0.43) @ phasors).real
    # Between two headings of the table, 2 degrees apart.
    scale = np.linalg.norm(
        abs(strips.forces(sea.omega, sea.k, sea.direction + 0.43)) * abs(phasors), axis=1
    )
    assert (abs(found - expected) < 2e-3 * scale + 1e-9).all()


def test_turning_craft_and_sea_together_changes_nothing():
    strips, _ = strips_of("cat_13")
    step = math.tau / 180
    for turn in (17 * step, -60 * step):
        here = WaveLoads(regular(0.2, 1.5, 0.3), strips.forces).at(0.4, 0.0, 0.0, 1.1)
        there = WaveLoads(regular(0.2, 1.5, 0.3 + turn), strips.forces).at(0.4, 0, 0, 1.1 + turn)
        np.testing.assert_allclose(there, here, rtol=1e-10, atol=1e-9)


def test_a_table_is_met_at_its_points_and_goes_round():
    strips, _ = strips_of("barge_T020")
    w, chi = np.linspace(1.0, 6.0, 60), np.radians(np.arange(0.0, 360.0, 5.0))
    forces = np.stack([strips.forces(w, wave_number(w), c) for c in chi], 2)
    response = tabulated(w, chi, forces)
    np.testing.assert_allclose(response(w, wave_number(w), chi[70]), forces[:, :, 70], atol=1e-9)
    np.testing.assert_allclose(
        response(w, wave_number(w), chi[-1] + math.radians(2.5) - math.tau),
        0.5 * (forces[:, :, -1] + forces[:, :, 0]),
        atol=1e-8,
    )
    between = np.array([2.713])
    direct = strips.forces(between, wave_number(between), 2.2)
    found = response(between, wave_number(between), 2.2)
    assert (abs(found - direct) < 5e-3 * abs(forces).max((1, 2))[:, None] + 1e-9).all()


def test_uneven_strips_are_refused():
    with pytest.raises(InputError, match="evenly"):
        strips_of("barge_T020", x=np.geomspace(0.1, 1.0, 20))


def test_a_table_of_one_frequency_holds_at_all():
    forces = np.arange(12.0).reshape(6, 1, 2) + 1j
    response = tabulated([1.0], [0.0, math.pi], forces)
    w = np.array([0.4, 1.0, 1.7])
    found = response(w, w**2 / 9.81, np.full(3, 0.25 * math.pi))
    expected = 0.75 * forces[:, 0, 0] + 0.25 * forces[:, 0, 1]
    np.testing.assert_allclose(found, np.repeat(expected[:, None], 3, 1), rtol=1e-12)
