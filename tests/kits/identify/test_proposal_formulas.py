"""Formulas of proposed files: closed forms, limits, tables and figures that others published."""

import math

import numpy as np
import pytest

from seatrial_kits.identify.proposal import box, sections, ship, torpedo

RHO = 1025.0


# ------------------------------------------------------------------ torpedo


def test_a_sphere_has_the_surface_of_a_sphere():
    assert torpedo.wetted_area(0.3, 0.3) == pytest.approx(math.pi * 0.3**2)


def test_surface_of_a_spheroid_is_that_of_its_rings():
    a, b = 0.8, 0.095
    t = (np.arange(200_000) + 0.5) * math.pi / 200_000
    rings = 2 * math.pi * b * np.sin(t) * np.hypot(a * np.sin(t), b * np.cos(t))
    assert torpedo.wetted_area(1.6, 0.19) == pytest.approx(rings.mean() * math.pi, rel=1e-8)


def test_bare_hull_drag_beside_that_of_prestero():
    # 1.62 kg/m of his cylinder with C_f 3.397e-3; a spheroid has pi / 4 of its surface, nearly.
    found = torpedo.bare_hull_drag(3.397e-3, 1.33, 0.191, 1030.0)
    assert found / (1.62 * math.pi / 4) == pytest.approx(1.0, abs=0.1)


def test_body_lift_is_that_of_remus():
    # Prestero 2001: c_yd 1.2 at l/d 6.96.
    assert torpedo.body_lift(1.33, 0.191, 1030.0) == pytest.approx(515 * 0.191**2 * 1.2, rel=0.01)


def test_drag_of_a_cylinder_is_that_of_its_strips():
    x = (np.arange(10_000) + 0.5) * 1.6e-4 - 0.8
    a = 0.5 * RHO * 1.1 * 0.19
    strips = a * 1.6, a * np.sum(np.abs(x) ** 3) * 1.6e-4
    assert torpedo.cylinder_drag(1.6, 0.19, RHO, 1.1) == pytest.approx(strips, rel=1e-6)


# ---------------------------------------------------------------------- box

PRISMS = ((1, 0.68), (2, 0.36), (3, 0.24), (4, 0.19), (5, 0.15), (6, 0.13), (7, 0.11), (10, 0.08))
"""DNV-RP-H103, table A-2, square prisms along their length: b/a and C_A on rho a^2 b."""


@pytest.mark.parametrize(("slender", "coefficient"), PRISMS)
def test_square_prisms_are_those_of_the_table(slender, coefficient):
    # Two entries of one practice: a formula for bodies with vertical sides, and a table.
    found = box.added_mass(float(slender), 1.0, 1.0, 1.0) / slender
    assert found == pytest.approx(coefficient, rel=0.06)


def test_a_thin_box_is_a_plate_and_a_long_plate_a_strip():
    assert box.added_mass(1e-9, 1, 1, 1.0) == pytest.approx(0.579 * math.pi / 4, rel=1e-4)
    assert box.added_mass(1e-9, 1, 10, 1.0) == pytest.approx(10 * math.pi / 4, rel=0.06)


def test_a_square_that_turns_has_the_known_inertia():
    # 0.725 rho a^4, a half of the side (Newman, Marine Hydrodynamics, table 4.3).
    assert box.section_inertia(2.0, 2.0, 1.0) == pytest.approx(0.725, rel=0.02)


def test_a_thin_rectangle_goes_towards_the_turning_plate():
    # rho pi a^4 / 8, Lamb.
    assert box.section_inertia(0.2, 2.0, 1.0) == pytest.approx(math.pi / 8, rel=0.18)


def test_added_inertia_is_larger_about_the_axis_across_the_broad_side():
    about = box.added_inertia(0.4, 0.4, 1.2, 1000.0)
    assert about[0] == pytest.approx(about[1])
    assert about[2] < 0.2 * about[0]


def test_turning_drag_of_a_cube_is_alike_about_all_axes():
    x, y, z = box.turning_drag(1.0, 1.0, 1.0, 2.0, (1.0, 1.0, 1.0))
    assert x == y == z == pytest.approx(1.15 * 2 / 32)


def test_projected_areas_act_squared_along_their_own_axis():
    assert box.projected((0.5, 1.0, 1.0)) == (0.25, 0.5, 0.5)


def test_an_even_box_is_the_sum_of_its_cells():
    n, size = 40, (0.5, 0.3, 0.2)
    x, y, z = np.meshgrid(*[((np.arange(n) + 0.5) / n - 0.5) * s for s in size])
    about = [np.mean(a**2 + b**2) * 12.0 for a, b in ((y, z), (x, z), (x, y))]
    assert box.inertia(12.0, *size) == pytest.approx(about, rel=1e-3)


# ----------------------------------------------------------------- sections


@pytest.mark.parametrize("beam", [0.4, 2.0, 5.0])
def test_half_ellipses_have_their_closed_forms(beam):
    ellipse = (beam, 1.0, math.pi / 4, RHO)
    assert sections.heave_mass(*ellipse) == pytest.approx(RHO * math.pi * beam**2 / 8)
    assert sections.sway_mass(*ellipse) == pytest.approx(RHO * math.pi / 2)


@pytest.mark.parametrize(("beam", "coefficient"), [(4.0, 1.36), (2.0, 1.51), (1.0, 1.70)])
def test_full_lewis_forms_are_about_the_rectangles_of_the_table(beam, coefficient):
    # Lewis forms round the corners. Half of DNV's C_A on rho pi a^2, the doubled section.
    half = coefficient * math.pi / 2 * (beam / 2) ** 2
    assert sections.heave_mass(beam, 1.0, 1.0, 1.0) == pytest.approx(half, rel=0.09)


def test_a_lewis_form_has_the_area_it_is_made_for():
    # Its boundary: b/2 and T by (1 + a1 + a3), area by Green.
    for fullness in (0.7, 0.85, 0.95):
        a1, a3 = sections.lewis(2.4, 1.0, fullness)
        t = np.linspace(0, math.pi / 2, 20_001)
        y = (1 + a1) * np.sin(t) - a3 * np.sin(3 * t)
        z = (1 - a1) * np.cos(t) + a3 * np.cos(3 * t)
        area = -np.trapezoid(y, z)
        assert area / (y[-1] * z[0]) == pytest.approx(fullness, rel=1e-6)
        assert y[-1] / z[0] == pytest.approx(1.2, rel=1e-9)


def test_a_half_circle_moves_no_water_by_rolling_and_a_plate_does():
    assert sections.roll_inertia(2.0, 1.0, RHO) == 0.0
    assert sections.roll_inertia(2.0, 0.0, 1.0) == pytest.approx(math.pi / 16)


# --------------------------------------------------------------------- ship

KVLCC2 = ship.FloatingHull(320.0, 58.0, 20.8, 312_600 / (320 * 58 * 20.8), 0.9)


def test_a_box_floats_by_its_closed_forms():
    found = ship.hydrostatics([ship.FloatingHull(30.0, 10.0, 1.5, 1.0, 1.0)])
    assert found.volume == pytest.approx(450)
    assert found.waterplane_area == pytest.approx(300)
    assert found.z_B == pytest.approx(0.75)
    heights = [found.BM_T, found.BM_L]
    assert heights == pytest.approx([10**2 / (12 * 1.5), 30**2 / (12 * 1.5)])


def test_a_diamond_water_line_has_its_closed_forms():
    found = ship.hydrostatics([ship.FloatingHull(8.0, 2.0, 1.0, 0.4, 0.5)])
    assert found.BM_T * found.volume == pytest.approx(8 * 2**3 / 48)
    assert found.BM_L * found.volume == pytest.approx(2 * 8**3 / 48)


def test_two_hulls_apart_have_the_theorem_of_steiner():
    one = ship.FloatingHull(2.0, 0.25, 0.2, 0.4, 0.75)
    both = [ship.FloatingHull(2.0, 0.25, 0.2, 0.4, 0.75, y) for y in (-0.4, 0.4)]
    single, pair = ship.hydrostatics([one]), ship.hydrostatics(both)
    lever = one.area * 0.4**2 / one.volume
    heights = [pair.BM_T, pair.BM_L]
    assert heights == pytest.approx([single.BM_T + lever, single.BM_L])


def test_surge_of_the_otter_is_that_of_its_source():
    assert ship.surge_mass(55.0, 2.0, RHO) == pytest.approx(5.281521, abs=1e-6)


def test_crossflow_of_the_otter_is_that_of_its_source():
    for draught, coefficient in ((0.1951219512, 1.0042099954), (0.1341463415, 0.8470352386)):
        assert ship.crossflow_coefficient(0.25, draught) == pytest.approx(coefficient, abs=1e-9)


def test_wetted_surface_of_kvlcc2():
    # 27,194 m2 (SIMMAN 2008).
    assert ship.wetted_surface(KVLCC2) == pytest.approx(27_194, rel=0.01)


def test_lift_of_a_hull_has_the_leading_terms_of_clarke():
    # Y_v' = -pi (T/L)^2 on rho/2 L^2 U.
    T, L = 0.5, 7.0
    assert ship.hull_lift(T, RHO) == pytest.approx(math.pi * (T / L) ** 2 * 0.5 * RHO * L**2)


def test_strips_of_a_box_are_its_section_times_its_length():
    found = ship.added_mass(ship.FloatingHull(12.0, 4.0, 1.0, 1.0, 1.0), RHO, box=True)
    heave = sections.heave_mass(4.0, 1.0, 1.0, RHO)
    assert found.heave == pytest.approx(12 * heave)
    assert found.pitch == pytest.approx(heave * 12**3 / 12)
    assert found.yaw == pytest.approx(found.sway * 12**2 / 12)


def test_regression_and_strips_agree_in_sway_of_a_slender_hull():
    # Strips know no ends, the regression knows all of the ship: 20 % at L/B 8.
    hull = ship.FloatingHull(16.0, 2.0, 0.8, 0.55, 0.7)
    strips = hull.over_length(lambda x, b: sections.sway_mass(b, 0.8, hull.fullness, RHO))
    assert ship.clarke(hull, RHO)[0] == pytest.approx(strips, rel=0.2)
