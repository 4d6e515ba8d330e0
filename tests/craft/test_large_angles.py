"""Righting arms at large angles: closed forms of a barge, a cylinder, two boxes; the craft's own."""

import math

import numpy as np
import pytest

from seatrial.errors import InputError
from seatrial.physics.craft.large_angles import Slice, outline, righting_arms
from seatrial.physics.craft.marine_craft import MarineCraft

BEAM, DRAUGHT, FREEBOARD, LENGTH = 4.0, 1.0, 1.0, 10.0


def box(beam=BEAM, draught=DRAUGHT, freeboard=FREEBOARD, aside=0.0):
    return [Slice(outline(beam, draught, beam * draught, freeboard, aside), LENGTH)]


def test_a_barge_is_wall_sided_until_its_deck_edge_or_bilge_leaves_the_surface():
    # GZ = sin(phi) (GM + BM tan(phi)^2 / 2) while the surface meets the sides.
    edge = math.atan(2 * min(DRAUGHT, FREEBOARD) / BEAM)
    phi = np.linspace(-0.999 * edge, 0.999 * edge, 21)
    BM, GM = BEAM**2 / (12 * DRAUGHT), 0.3
    found = righting_arms(box(), BEAM * DRAUGHT * LENGTH, GM, phi)
    np.testing.assert_allclose(found, np.sin(phi) * (GM + BM / 2 * np.tan(phi) ** 2), atol=1e-6)
    beyond = righting_arms(box(), BEAM * DRAUGHT * LENGTH, GM, np.array([1.2 * edge]))[0]
    assert beyond < math.sin(1.2 * edge) * (GM + BM / 2 * math.tan(1.2 * edge) ** 2) - 1e-3


def test_a_barge_on_its_side_and_upside_down():
    # Half under: 90 degrees on, y_B is a quarter of the depth from the middle, and at 180 the arm
    # is that of the negative of what holds it up, by symmetry about the middle of a full box.
    z_G = 0.3 + DRAUGHT / 2 - BEAM**2 / 12  # of GM = z_G - (z_B - BM), z down
    arms = righting_arms(box(), BEAM * DRAUGHT * LENGTH, 0.3, np.array([math.pi / 2, math.pi]))
    assert arms[0] == pytest.approx(z_G, abs=1e-6)
    assert arms[1] == pytest.approx(0.0, abs=1e-9)


@pytest.mark.parametrize("radius", [0.5, 3.0])
def test_a_cylinder_turns_about_its_axis(radius):
    # Buoyancy goes through the axis at every angle: GZ = GM sin(phi).
    t = np.linspace(0.0, math.tau, 721)[:-1]
    around = [Slice(radius * np.column_stack([np.cos(t), np.sin(t)]), 5.0)]
    phi = np.linspace(0.0, math.pi, 19)
    found = righting_arms(around, 0.4 * math.pi * radius**2 * 5.0, 0.1, phi)
    np.testing.assert_allclose(found, 0.1 * np.sin(phi), atol=2e-5 * radius)


def test_a_catamaran_of_two_boxes():
    # Wall-sided, too: BM of both hulls; later, on one hull and out of the water with the other,
    # half the beam between them less what the centre of gravity takes off.
    a, b, T, F, GM = 3.0, 0.5, 0.5, 1.0, 2.0
    hulls = [*box(b, T, F, a), *box(b, T, F, -a)]
    volume = 2 * b * T * LENGTH
    BM = 2 * (b**3 / 12 + b * a**2) / (2 * b * T)
    phi = np.array([-0.1, 0.05, 0.12])
    found = righting_arms(hulls, volume, GM, phi)
    np.testing.assert_allclose(found, np.sin(phi) * (GM + BM / 2 * np.tan(phi) ** 2), atol=1e-5)
    # With all of the volume in the starboard hull, 2 T deep: its own centre, y and z in body axes.
    phi = 0.35
    tan, sin, cos = math.tan(phi), math.sin(phi), math.cos(phi)
    assert tan > T / a  # the port hull is out
    inertia = b**2 / (12 * 2 * T)
    y, z = a + inertia * tan, T - T - inertia * tan**2 / 2
    z_G = GM + T / 2 - BM
    found = righting_arms(hulls, volume, GM, np.array([phi]))[0]
    assert found == pytest.approx(y * cos - z * sin + z_G * sin, abs=1e-5)


@pytest.mark.parametrize(("share", "power"), [(math.pi / 4, 2.0), (0.5, 1.0)])
def test_sections_have_the_area_that_is_given(share, power):
    found = outline(2.0, 1.0, 2.0 * share, 0.0, 0.0)
    y, z = found.T
    area = abs(y @ np.roll(z, -1) - z @ np.roll(y, -1)) / 2
    assert area == pytest.approx(2.0 * share, rel=3e-3)
    inside = (z > 0.01) & (y > 0.01)
    np.testing.assert_allclose(y[inside] ** power + z[inside] ** power, 1.0, atol=1e-6)


def barge(**values):
    """Return a craft with the sections of the barge, free to heel."""
    craft = MarineCraft("hull")
    area = BEAM * DRAUGHT
    given = {
        "terms": "restoring",
        "restoring": "surface-curve",
        "mass": 1025.0 * area * LENGTH,
        "inertia": [5e4, 4e5, 4e5, 0, 0, 0],
        "waterplane_area": BEAM * LENGTH,
        "GM_T": 0.3,
        "GM_L": 8.0,
        "hull_length": LENGTH,
        "hull_freeboard": FREEBOARD,
        "section_beam": [BEAM] * 11,
        "section_draught": [DRAUGHT] * 11,
        "section_area": [area] * 11,
    }
    for name, value in {**given, **values}.items():
        craft.set(name, value)
    craft.initialise()
    return craft


def moment(craft, phi, theta=0.0):
    """Return the moment of the restoring about the body origin, N.m."""
    x = np.array([0, 0, 0, phi, theta, 0, *np.zeros(6)])
    return (craft.mass_matrix() @ craft.derivatives(x)[6:])[3:]


@pytest.mark.parametrize("degrees", [2, 10, 20, 40, 70, 120, 170, -15, -60])
def test_a_craft_has_the_righting_moment_of_its_curve(degrees):
    craft, phi = barge(), math.radians(degrees)
    W = craft.mass * craft.gravity
    wanted = -W * craft.righting_arms(np.array([phi]))[0]
    # The series of twelve sines smooths the corners of the curve by centimetres.
    assert moment(craft, phi)[0] == pytest.approx(wanted, abs=0.02 * W)
    small = 1e-4
    assert moment(craft, small)[0] == pytest.approx(-W * 0.3 * small, rel=1e-3)


def test_the_moment_of_the_curve_does_no_work_around_a_loop():
    # In (phi, theta) about still points: the curl of (K, M) in Euler angles at psi' = 0 vanishes.
    craft, h = barge(), 1e-5

    def work(phi, theta):
        K, M, N = moment(craft, phi, theta)
        return np.array([K, M * math.cos(phi) - N * math.sin(phi)])  # by phi' and theta'

    for phi, theta in ((0.4, 0.2), (1.2, -0.3), (-2.0, 0.5)):
        across = (work(phi, theta + h)[0] - work(phi, theta - h)[0]) / (2 * h)
        along = (work(phi + h, theta)[1] - work(phi - h, theta)[1]) / (2 * h)
        assert across == pytest.approx(along, rel=1e-4, abs=1.0)


def test_a_craft_beyond_its_range_capsizes_and_comes_to_rest_upside_down():
    craft = barge(linear_damping_moment=[6e4, 0, 0], terms="restoring damping")
    phi = np.radians(np.arange(0, 181, 1))
    arms = craft.righting_arms(phi)
    vanishing = phi[np.flatnonzero((arms[:-1] > 0) & (arms[1:] <= 0))[0]]
    ends = []
    for start in (vanishing - 0.1, vanishing + 0.1):
        craft.set("attitude_start", [start, 0, 0])
        ends.append(craft.reference([0.0, 120.0], rtol=1e-7)["attitude.phi"][-1])
    assert ends[0] == pytest.approx(0.0, abs=0.02)
    assert ends[1] > math.pi / 2


def test_a_curve_without_a_deck_and_a_hull_that_sinks_are_refused():
    with pytest.raises(InputError, match="hull_freeboard"):
        barge(hull_freeboard=0.0)
    with pytest.raises(InputError, match=r"enclose 80 m3, and 82 m3 are displaced"):
        barge(mass=1025.0 * 82.0)
