"""Forces by strips at oblique headings, section by section, and what a hull makes of its craft's."""

import cmath
import math

import numpy as np
import pytest
from scipy.integrate import quad

from seatrial.physics.craft.wave_hull import HullCoefficients, WaveHull
from seatrial.physics.sea.strips import Strips

RHO, G = 1019.0, 9.79
OMEGA = np.array([0.9, 2.1, 3.7])
K = OMEGA**2 / G * [1.0, 1.1, 1.0]  # of any depth
HEADINGS = [0.4, 2.0, 3.9, 5.6]


def sections(draw, count=5):
    """Return sections of a hull, with random coefficients."""
    beam, draught = draw.uniform(0.3, 0.9, (2, count))
    names = ("a33", "b33", "a22", "b22", "a42", "b42")
    values = {name: draw.uniform(10.0, 90.0, count) for name in names}
    area = beam * draught * draw.uniform(0.6, 1.0, count)
    return {"beam": beam, "draught": draught, "area": area, **values}


def summed(x, hulls, part, w, k, chi, is_round, haskind):
    """Return X to N by the sums of the specification, one wave of 1 m."""
    dx, total = x[1] - x[0], np.zeros(6, dtype=complex)
    cos, sin = math.cos(chi), math.sin(chi)
    for i, at in enumerate(x):
        b, T, S, a33, b33, a22, b22, a42, b42 = (
            float(part[name][i])
            for name in ("beam", "draught", "area", "a33", "b33", "a22", "b22", "a42", "b42")
        )
        t = S / b
        # Pressure over the water line, at the mean draught; relative motion.
        lift = RHO * G * quad(lambda y: math.cos(k * y * sin), -b / 2, b / 2)[0]
        up = (lift - a33 * w**2 + 1j * w * b33) * math.exp(-k * t)
        if haskind:
            up *= math.sqrt(RHO * G**2 * b33 / w) / abs(up)
        u = w * math.exp(-k * t / 2)
        ahead = RHO * S * 1j * w * u * cos
        aside = ((RHO * S + a22) * 1j * w * u + b22 * u) * sin
        roll = (a42 * 1j * w * u + b42 * u) * sin
        if not is_round:
            sides = quad(lambda z: z * math.exp(-k * z), 0.0, T)[0]
            roll += RHO * G * 1j * k * sin * (b**3 / 12 * math.exp(-k * T) - b * sides)
        for y in hulls:
            E = cmath.exp(-1j * k * (at * cos + y * sin))
            moments = [roll - y * up, at * up, at * aside - y * ahead]
            total += np.array([ahead, aside, -up, *moments]) * E * dx
    return total


@pytest.mark.parametrize("chi", HEADINGS)
@pytest.mark.parametrize("hulls", [(0.0,), (-0.7, 1.1)])
@pytest.mark.parametrize(("is_round", "haskind"), [(False, False), (True, False), (False, True)])
def test_forces_are_the_sums_of_the_specification(chi, hulls, is_round, haskind):
    part = sections(np.random.default_rng(3))
    x = np.linspace(-1.7, 2.3, 5)
    strips = Strips(x, **part, hulls=hulls, round=is_round, haskind=haskind, density=RHO, gravity=G)
    expected = [
        summed(x, hulls, part, w, k, chi, is_round, haskind) for w, k in zip(OMEGA, K, strict=True)
    ]
    np.testing.assert_allclose(strips.forces(OMEGA, K, chi), np.array(expected).T, rtol=1e-9)


def test_radiation_of_hulls_off_the_centre_is_that_of_points():
    part, x = sections(np.random.default_rng(4)), np.linspace(-1.7, 2.3, 5)
    added, damping = Strips(x, **part, hulls=(-0.7, 1.1)).added_mass_and_damping()
    for found, name in ((added, "a33"), (damping, "b33")):
        expected = np.zeros((3, 3))
        for at, each in zip(x, part[name], strict=True):
            for y in (-0.7, 1.1):
                effect = np.array([1.0, y, -at])  # down by heave, roll and pitch
                expected += each * np.outer(effect, effect) * (x[1] - x[0])
        np.testing.assert_allclose(found, expected, rtol=1e-12)


OWN = HullCoefficients((80.0, 300.0), (60.0, 40.0), (20.0, 50.0), (30.0, 90.0), 5.0)
BEAM = np.array([0.1, 0.4, 0.5, 0.6, 0.7, 0.7, 0.6, 0.6, 0.5, 0.3, 0.2])
HULL = {
    "hull_length": 4.0, "hull_middle": 0.3, "hull_waterline": 0.2, "section_beam": BEAM,
    "section_draught": 0.3 - 0.1 * BEAM, "section_area": 0.15 * BEAM,
}  # fmt: skip


@pytest.mark.parametrize("chi", HEADINGS)
@pytest.mark.parametrize("spacing", [0.0, 1.8])
def test_a_hull_shares_out_the_coefficients_of_its_craft(chi, spacing):
    made = WaveHull("hull")
    for name, value in {**HULL, "hull_spacing": spacing}.items():
        made.set(name, value)
    found = made.hull_loads(OWN, RHO, G, None).forces(OMEGA, K, chi)
    x = -2.0 + 0.2 * (np.arange(20) + 0.5)
    stations = np.linspace(-2.0, 2.0, 11)
    shape = {n: np.interp(x, stations, HULL[f"section_{n}"]) for n in ("beam", "draught", "area")}
    hulls = (-spacing / 2, spacing / 2) if spacing else (0.0,)
    square = shape["beam"] ** 2
    share = square / (0.2 * square.sum() * len(hulls))
    level = np.ones(20) / (4.0 * len(hulls))
    common = {**shape, "a22": 60 * level, "b22": 40 * level, "a42": 5 * level, "b42": 0 * level}
    lever = (share * x**2).sum() * 0.2 * len(hulls)

    def forces(pair, per=1.0, bare=False):
        part = {**common, "a33": pair[0] / per * share, "b33": pair[1] / per * share}
        if bare:
            part |= dict.fromkeys(("a33", "b33", "a22", "b22"), 0 * share)
        rows = [
            summed(x, hulls, part, w, k, chi, False, False) for w, k in zip(OMEGA, K, strict=True)
        ]
        return np.array(rows).T

    expected, pressure = forces(OWN.heave), forces((0, 0), bare=True)[:3]
    expected[4] = forces(OWN.pitch, lever)[4]
    if spacing:
        expected[3] = forces(OWN.roll, (spacing / 2) ** 2)[3]
    else:
        # One hull rolls relative to the slope, zeta_y = -i k sin(chi), mean over its water line.
        sin, depth = math.sin(chi), shape["area"].sum() / shape["beam"].sum()
        along = np.exp(-1j * K * x[:, None] * math.cos(chi)).mean(0)
        half = K * shape["beam"].mean() * sin / 2
        slope = 1j * K * sin * along * np.sin(half) / half * np.exp(-K * depth)
        expected[3] += (1j * OMEGA * 50.0 - OMEGA**2 * 20.0) * slope
    place = [0.3, 0.0, -0.2]
    expected[3:] += np.cross(place, pressure, axis=0)
    expected *= np.exp(-1j * K * 0.3 * math.cos(chi))
    np.testing.assert_allclose(found, expected, rtol=1e-9, atol=1e-9)


@pytest.mark.parametrize("gone", ["beam", "draught", "area"])
def test_a_section_that_is_not_there_has_no_slice(gone):
    made = WaveHull("hull")
    values = {**HULL, "hull_spacing": 1.8, "hull_freeboard": 0.3}
    values[f"section_{gone}"] = [0.0, 0.0, *HULL[f"section_{gone}"][2:]]
    for name, value in values.items():
        made.set(name, value)
    slices = made.slices()
    assert len(slices) == 2 * 18  # of 20 strips two lie between the stations without
    assert [part.length for part in slices] == [pytest.approx(0.2)] * 36
    middles = [part.outline[:, 0].mean() for part in slices]
    assert sum(middle > 0 for middle in middles) == 18
    tops = [part.outline[:, 1].min() for part in slices]
    assert tops == [pytest.approx(-0.3)] * 36
