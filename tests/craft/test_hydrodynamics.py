"""The list of terms: unchanged right-hand sides, terms alone, and names that are refused."""

import copy
import json
from pathlib import Path

import numpy as np
import pytest

from seatrial.errors import InputError
from seatrial.physics.craft.marine_craft import MarineCraft
from seatrial.physics.craft.rov import Rov
from seatrial.physics.craft.terms.hydrodynamics import TERMS, WAVES, WIND

STORED = json.loads(
    (Path(__file__).parents[1] / "reference/six_dof_right_hand_sides.json").read_text()
)
CLASSES = {"marine-craft": MarineCraft, "rov": Rov}


def craft(kind, **values):
    component = CLASSES[kind]("craft")
    for name, value in {**STORED["values"], **values}.items():
        component.set(name, value)
    return component


def inputs(component, case):
    """Return the stacked inputs: those stored, without thrust of propellers."""
    names = component.linearise(np.array(case["x"])).u_names
    stored = iter(case["u"])
    return np.array([0 if name.startswith("thrust") else next(stored) for name in names])


@pytest.mark.parametrize("case", STORED["cases"], ids=lambda c: c["craft"])
def test_right_hand_sides_are_those_from_before_the_list(case):
    component = craft(case["craft"], **case["values"])
    found = component.derivatives(np.array(case["x"]), inputs(component, case))
    np.testing.assert_allclose(found, case["dx"], rtol=1e-12, atol=0)


@pytest.mark.parametrize("kind", CLASSES)
def test_terms_act_alone_and_their_loads_add_up(kind):
    case = copy.deepcopy(next(c for c in STORED["cases"] if c["craft"] == kind))
    x, u = np.array(case["x"]), inputs(craft(kind), case)

    def slope(names):
        return craft(kind, **case["values"], terms=" ".join(names)).derivatives(x, u)

    case["values"].update(crossflow_length=2, crossflow_draught=0.2, crossflow_coefficient=1)
    case["values"].update(point_drag=(20, 30, 40), drag_spread=(0.5, 0.3, 0.2), lift=(30, 20))
    case["values"].update(coupled_damping_force=(3, -4), coupled_damping_moment=(-5, 6))
    case["values"].update(drag_coefficient=range(1, 10), projected_area=(0.1, 0.2, 0.3))
    case["values"].update(lift_arm=0.5, wave_damping=500, wave_depth=10)
    case["values"].update(fading_damping_force=(30, 40), fading_damping_rate=0.5)
    case["values"].update(body_lift_area=1, body_lift_span=1, wing_drag=(20, 30), wing_side=-10)
    bare = slope([])
    alone = [slope([name]) - bare for name in TERMS if name not in (WAVES, WIND)]
    assert all(np.abs(each[6:]).max() > 0.01 for each in alone)
    np.testing.assert_allclose(bare + sum(alone), slope(TERMS), rtol=1e-11, atol=1e-11)
    np.testing.assert_array_equal(slope(reversed(TERMS)), slope(TERMS))


def test_without_munk_terms_a_steady_oblique_translation_has_no_moment():
    # Of the full form it is v x A v alone (Munk), turned into accelerations by M.
    v, x = np.array([1.0, 0.4, -0.3]), np.zeros(12)
    x[6:9] = v
    full, without = (
        craft("marine-craft", terms="coriolis", coriolis=form) for form in ("full", "without-munk")
    )
    xx, yy, zz, xy, xz, yz = STORED["values"]["added_mass"]
    A = np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]])
    M = full.mass_matrix()
    np.testing.assert_allclose(M @ without.derivatives(x)[6:], 0, atol=1e-13)
    np.testing.assert_allclose(
        M @ full.derivatives(x)[6:], [0, 0, 0, *-np.cross(v, A @ v)], atol=1e-12
    )


# Of REMUS (T. Prestero, MIT 2001, tables of its appendix): N.s2/rad2 and N.s2/m.
REMUS = {"quadratic_coupled_damping_force": (0.632, -0.632)} | {
    "quadratic_coupled_damping_moment": (-3.18, 3.18)
}


@pytest.mark.parametrize("kind", CLASSES)
def test_coupled_damping_is_its_derivatives(kind):
    linear = {"coupled_damping_force": (3, -4), "coupled_damping_moment": (-5, 6)}
    hull = craft(kind, terms="coupled-damping", added_coupling=0.0, **REMUS, **linear)
    _, v, w, _, q, r = nu = (1.5, -0.4, 0.3, 0.2, -0.6, 0.5)
    x = np.array([0, 0, 5, 0, 0, 0, *nu])
    bare = craft(kind, terms="", added_coupling=0.0).derivatives(x)
    load = hull.mass_matrix() @ (hull.derivatives(x) - bare)[6:]
    sway, heave = 3 * r + 0.632 * r * abs(r), -4 * q - 0.632 * q * abs(q)
    pitch, yaw = 6 * w + 3.18 * w * abs(w), -5 * v - 3.18 * v * abs(v)
    np.testing.assert_allclose(load, [0, sway, heave, 0, pitch, yaw], rtol=1e-12, atol=1e-12)


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("restoring dampin", r"terms: unknown term 'dampin'; did you mean 'damping'"),
        ("damping damping", "'damping' stands twice"),
    ],
)
def test_a_term_that_is_not_known_or_stands_twice_is_refused(text, message):
    with pytest.raises(InputError, match=message):
        MarineCraft.ports["terms"].check_text(text)
    with pytest.raises(InputError, match=message):
        Rov.ports["terms"].check_text(text)


# The Otter USV of the Marine Systems Simulator (T. I. Fossen), its equations made consistent,
# with a payload of 25 kg and without: mass, CG, inertia, added inertia, draught, GM, linear
# damping, quadratic yaw damping and drag coefficient, and nu' computed independently of this
# project.
OTTER = {
    "loaded": (
        {
            "mass": 80,
            "center_of_gravity": (0.153125, 0, -0.246875),
            "inertia": (10.65103875, 14.5234375, 14.13671875, 0, 0.38671875, 0),
            "added_inertia": (2.13020775, 11.61875, 24.032421875, 0, 0, 0),
            "crossflow_draught": 0.1951219512,
            "crossflow_coefficient": 1.0042099954,
            "GM_T": 1.2325002450,
            "GM_L": 3.1112550813,
            "linear_damping_force": (77.55443235, 162.5, 605.4038838),
            "linear_damping_moment": (52.27472965, 226.7221688, 40.04492188),
            "quadratic_damping_moment": (0, 0, 400.4492188),
        },
        (1.4322712927, 1.4951383313, -1.3133195564, -13.4554182753, 7.902341939, 0.2432431455),
    ),
    "empty": (
        {
            "mass": 55,
            "center_of_gravity": (0.2, 0, -0.2),
            "inertia": (10.26432, 13.75, 13.75, 0, 0, 0),
            "added_inertia": (2.052864, 11.0, 23.375, 0, 0, 0),
            "crossflow_draught": 0.1341463415,
            "crossflow_coefficient": 0.8470352386,
            "GM_T": 1.9967187599,
            "GM_L": 4.7294530673,
            "linear_damping_force": (77.55443235, 137.5, 546.4804891),
            "linear_damping_moment": (50.02366181, 218.1878561, 39.325),
            "quadratic_damping_moment": (0, 0, 393.25),
        },
        (1.0238250594, 1.0999022562, -1.5542312273, -16.4439923049, 8.5842805257, 0.5251703718),
    ),
}


@pytest.mark.parametrize("load", OTTER)
def test_centre_of_flotation_and_crossflow_give_the_otter(load):
    values, expected = OTTER[load]
    port, starboard = 0.01108 * 90**2, -0.006445 * 40**2  # N, at 90 and -40 rad/s
    hull = MarineCraft("otter")
    shared = {
        "terms": "restoring coriolis damping crossflow-drag",
        "added_mass": (5.28152101, 82.5, 55, 0, 0, 0),
        "waterplane_area": 0.75,
        "center_of_flotation": (-0.2, 0),
        "crossflow_length": 2,
        "current": (0.2, -0.1, 0),
        "force_1": (port + starboard, 0, 0),
        "moment_1": (0, 0, 0.395 * (port - starboard)),
    }
    for name, value in {**shared, **values}.items():
        hull.set(name, value)
    x = np.array([1, 2, 0.05, 0.2, -0.1, 0.5, 1.2, -0.4, 0.1, 0.3, -0.2, 0.25])
    np.testing.assert_allclose(hull.derivatives(x)[6:], expected, rtol=1e-8)


def test_linear_restoring_is_the_conservative_one_to_first_order():
    def stiffness(form):
        hull = craft(
            "marine-craft",
            terms="restoring",
            restoring=form,
            waterplane_area=0.4,
            GM_T=0.3,
            GM_L=0.8,
            center_of_flotation=(-0.2, 0.1),
        )
        return hull.linearise(np.zeros(12)).A

    linear, conservative = stiffness("surface-linear"), stiffness("surface-conservative")
    np.testing.assert_allclose(linear, conservative, rtol=0, atol=1e-12)


# [Paulino2015], table 2.1 and eq. 5.8: 93.4127 N at 4.2 knots, by C_d S = 0.04002 m2 in fresh water.
TOP_SPEED, FULL_THRUST, DRAG_AREA = 4.2 * 1852 / 3600, 93.4127, 0.04002


def submerged(**values):
    """Return a ROV that displaces its mass, with nothing but the drag of Morison."""
    hull = Rov("rov")
    still = {"mass": 6.5, "volume": 6.5e-3, "density": 1000.0, "max_step": 0.01}
    for name, value in {**still, "terms": "morison restoring", **values}.items():
        hull.set(name, value)
    return hull


def test_morison_s_drag_balances_the_thrust_at_top_speed():
    area = 0.289 * 0.223  # beam times height of table 2.1
    coefficient = [DRAG_AREA / area, *[0.0] * 8]
    hull = submerged(drag_coefficient=coefficient, projected_area=(area, 0.1, 0.1))
    x = np.zeros(12)
    x[6] = TOP_SPEED
    # Four digits of C_d S.
    assert hull.derivatives(x)[6] * 6.5 == pytest.approx(-FULL_THRUST, rel=1e-4)


def test_cross_damping_is_the_matrix():
    """- rho / 2 C_d S |v| v, with numbers of its own."""
    C_d, S, v = np.arange(1.0, 10.0).reshape(3, 3), (0.1, 0.2, 0.3), np.array([0.5, -0.4, 0.3])
    hull = submerged(drag_coefficient=C_d.ravel().tolist(), projected_area=S)
    x = np.zeros(12)
    x[6:9] = v
    expected = -500.0 * C_d @ (np.array(S) * np.abs(v) * v)
    np.testing.assert_allclose(6.5 * hull.derivatives(x)[6:9], expected, rtol=1e-12)


def test_morison_s_equation_of_a_body_in_a_current_that_sets_in():
    """(m + C_m rho V) v' = 1/2 rho C_d S |v_c - v| (v_c - v), held at first: a closed form.

    The velocity through the water falls as 1 / (1 + a t / v_c0), a = rho C_d S v_c0^2 / 2 over
    the mass with C_m rho V.
    """
    C_m, C_d, S, current = 0.7, 0.9, 0.05, 0.8
    added = C_m * 1000.0 * 6.5e-3
    hull = submerged(
        drag_coefficient=[C_d, *[0.0] * 8],
        projected_area=(S, 0.1, 0.1),
        added_mass=(added, 0, 0, 0, 0, 0),
    )
    hull.set("current", (current, 0.0, 0.0))
    hull.initialise()
    hull.begin()
    for k in range(500):
        hull.advance(0.01 * k, 0.01)
    rate = 500.0 * C_d * S * current / (6.5 + added)
    assert hull.velocity[0] == pytest.approx(current - current / (1.0 + rate * 5.0), rel=1e-9)
