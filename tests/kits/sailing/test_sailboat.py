"""The sailing boat against independent figures, conservation laws and symmetry.

Figures without a formula beside them were computed independently of this project from the
equations of [Silva2018], corrected.
"""

import csv
import math
import tomllib
from pathlib import Path
from types import SimpleNamespace

import casadi as ca
import numpy as np
import pytest

from seatrial.errors import InputError
from seatrial.model.units import conversion
from seatrial.physics.craft.kinematics import to_ned
from seatrial.system.parameters import load_vehicle
from seatrial_kits.sailing.sailboat import Sailboat
from tests.craft.numerically import numbers

GLORIA = tomllib.loads(load_vehicle("gloria").read_from.path.read_text("utf-8"))
REFERENCE = Path(__file__).parents[2] / "reference"
STEADY = list(csv.DictReader((REFERENCE / "gloria_steady_fixed_sail.csv").open()))
M = np.array([[29.92, 0, 0, 0], [0, 51.025, 0, 2.72], [0, 0, 23.899, 0], [0, 2.72, 0, 28.541]])
NO_FOILS = {"sail_area": 0.0, "keel_area": 0.0, "rudder_area": 0.0}
NO_DAMPING = {"X_u": 0.0, "Y_v": 0.0, "N_r": 0.0}
STRAY = [0, 0, 0.3, 0.5, 1, 0.2, 0.1, 0.3]
MIRROR = np.array([1, -1, -1, -1, 1, -1, -1, -1])


def gloria(variant="source", **changes):
    boat = Sailboat("boat")
    for name, entry in {**GLORIA["sailboat"], **GLORIA["variants"][variant]["sailboat"]}.items():
        boat.set(name, entry["value"])
    for name, value in changes.items():
        boat.set(name, value)
    return boat


def placed(boat, state):
    boat.set("eta_start", state[:4])
    boat.set("nu_start", state[4:])
    return boat


def state_of(boat):
    return np.array([*boat.get("eta"), *boat.get("nu")])


def test_water_that_accelerates_takes_the_boat_along():
    # Pressure gives a boat the acceleration of the water around it, whatever its mass.
    values = {name: entry["value"] for name, entry in GLORIA["sailboat"].items()}
    both = numbers(Sailboat, **values)
    state = SimpleNamespace(eta=ca.SX.sym("eta", 4), nu=ca.SX.sym("nu", 4))
    at = [[0, 0, 0.2, 0.9], [1.0, 0.3, 0.1, -0.2]]
    found = []
    for speeding in ([0.0, 0.0, 0.0], [0.4, -0.7, 0.2]):
        sea = {"water_velocity": [0.2, 0.1, 0.0], "water_acceleration": speeding}
        sea |= {"wave_load": [0.0] * 6, "wind_load": [0.0] * 6}
        inputs = SimpleNamespace(**vars(both), **{n: ca.DM(v) for n, v in sea.items()})
        rates, _ = Sailboat("boat").equations(state, inputs, both)
        function = ca.Function("rates", [state.eta, state.nu], [rates["nu"]])
        found.append(np.array(function(*at)).ravel())
    c, s = math.cos(0.9), math.sin(0.9)
    # Heeled by 0.2 rad, her y axis meets the cosine of it.
    ahead, starboard = c * 0.4 - s * 0.7, (-s * 0.4 - c * 0.7) * math.cos(0.2)
    np.testing.assert_allclose(found[1] - found[0], [ahead, starboard, 0, 0], atol=1e-9)


# ---------------------------------------------------------------------- parameters


def test_parameters_are_declared_in_convertible_units_with_their_origin():
    tables = (GLORIA, *GLORIA["variants"].values())
    for name, entry in [item for table in tables for item in table["sailboat"].items()]:
        port = Sailboat.ports[name]
        assert entry["mark"] in ("stated", "corrected", "assumed")
        assert entry["source"]
        if port.type is float:
            assert conversion(entry["unit"], port.unit) == (1.0, 0.0), name
        else:
            assert entry["value"] in port.choices
    assert GLORIA["default"] in GLORIA["variants"]


def test_mass_matrix_is_that_of_the_source():
    np.testing.assert_allclose(gloria().mass_matrix(), M, atol=1e-14)


def test_a_mass_matrix_that_is_not_positive_definite_is_refused():
    with pytest.raises(InputError, match=r"boat: the mass matrix .*check mass, inertia, X_udot"):
        gloria(N_rdot=10.0).initialise()


def test_other_tables_than_those_there_are_are_refused():
    with pytest.raises(InputError, match=r"boat\.unknown value of high_alpha 'flat'"):
        gloria(high_alpha="flat").initialise()


# ---------------------------------------------------------------------- derivatives

PROBE = np.array([0, 0, 0.1, 0.6, 1.2, -0.05, 0.03, 0.02])


def test_derivative_and_partial_loads():
    boat = placed(gloria(sail=0.7, flap=0.2, rudder=0.05, wind=(5, 0)), PROBE)
    expected = [
        *(1.01849381854, 0.636510349345, 0.03, 0.0199000833056),
        *(0.705793014627, -0.108988498726, -1.38051479179, -0.109215076631),
    ]
    np.testing.assert_allclose(boat.derivatives(PROBE), expected, rtol=1e-9)
    boat.initialise()
    loads = {
        "sail_load": (29.38750036, -25.93294723, -22.48386525, -0.05622531174),
        "keel_load": (0.1645766618, 16.21114646, -5.074088842, -1.669748085),
        "rudder_load": (0.01518697142, 3.431677618, -0.1338354271, -1.928602821),
    }
    for port, load in loads.items():
        np.testing.assert_allclose(boat.get(port), load, rtol=1e-9)


def loaded(**inputs):
    boat = gloria("physical", **inputs)
    boat.initialise()
    return boat


@pytest.mark.parametrize("angle", [0.7, -1.2, 0.0])
def test_torque_about_the_axis_of_the_sail_is_arm_times_force(angle):
    boat = loaded(sail=angle, flap=0.2, wind=(5, 2))
    X, Y, *_ = boat.get("sail_load")
    # The centre of effort is 0.228 m along a boom that points aft and by the angle to port.
    x, y = -0.228 * math.cos(angle), -0.228 * math.sin(angle)
    assert boat.get("sail_torque") == pytest.approx(x * Y - y * X, abs=1e-12)


@pytest.mark.parametrize(("angle", "rate"), [(0.7, 2.0), (-1.2, -0.5), (0.1, 1.5)])
def test_a_sail_that_swings_meets_the_wind_that_its_centre_of_effort_does(angle, rate):
    def place(at):
        return np.array([-0.228 * math.cos(at), -0.228 * math.sin(at)])

    velocity = (place(angle + 1e-6 * rate) - place(angle - 1e-6 * rate)) / 2e-6
    swinging = loaded(sail=angle, sail_rate=rate, sail_swing="on", wind=(5, 2))
    still = loaded(sail=angle, wind=np.array([5, 2]) - velocity)
    np.testing.assert_allclose(swinging.get("sail_load"), still.get("sail_load"), rtol=1e-7)
    assert loaded(sail=angle, sail_rate=rate, wind=(5, 2)).get("sail_load") == loaded(
        sail=angle, wind=(5, 2)
    ).get("sail_load")


@pytest.mark.parametrize("rate", [3.0, -3.0])
def test_still_air_resists_a_swing(rate):
    assert loaded(sail=0.4, sail_rate=rate, sail_swing="on").get("sail_torque") * rate < 0.0


def hull_part(**left):
    """Return M nu' at the probe with only the named part of the hull's equation left."""
    nothing = {**NO_FOILS, **NO_DAMPING, "GM_T": 0.0}
    boat = gloria(**{**nothing, **left})
    return boat.mass_matrix() @ boat.derivatives(PROBE)[4:]


def test_parts_of_the_hulls_equation():
    rigid, added = np.array([-0.0272, -0.6528, 0, 0]), np.array([-0.022737, -0.06528, 0, 1.20102])
    np.testing.assert_allclose(hull_part(), rigid + added, rtol=1e-9, atol=1e-12)
    added_mass = dict.fromkeys(("X_udot", "Y_vdot", "Y_rdot", "K_pdot", "N_rdot"), 0.0)
    np.testing.assert_allclose(hull_part(**added_mass), rigid, rtol=1e-9, atol=1e-12)
    damping = hull_part(X_u=-7.0, Y_v=-23.0, N_r=-48.0) - hull_part()
    np.testing.assert_allclose(damping, [-8.4, 1.15, 0, -0.96], rtol=1e-9, atol=1e-12)
    righting = hull_part(GM_T=0.2) - hull_part()
    np.testing.assert_allclose(righting, [0, 0, -5.301133487, 0], rtol=1e-9, atol=1e-12)
    # The derivatives that are 0 for this boat: N.s/rad, N.s and N.m.s/rad at v = -0.05.
    others = hull_part(Y_r=2.0, N_v=3.0, K_p=-4.0) - hull_part()
    np.testing.assert_allclose(others, [0, 0.04, -0.12, -0.15], rtol=1e-9, atol=1e-12)


@pytest.mark.parametrize(("speed", "slope"), [(0.2, -5.07), (1.0, -25.36), (2.0, -50.71)])
def test_keel_and_rudder_damp_roll_in_proportion_to_speed(speed, slope):
    A = gloria().linearise(np.array([0, 0, 0, 0, speed, 0, 0, 0])).A
    assert A[6, 6] * M[2, 2] == pytest.approx(slope, abs=0.005)


def test_yaw_moment_of_the_rudder():
    boat = placed(gloria(), [0, 0, 0, 0, 1, 0, 0, 0])
    boat.initialise()
    moments = {}
    for degrees in range(-20, 21):
        boat.set("rudder", math.radians(degrees))
        moments[degrees] = boat.get("rudder_load.N")
    assert max(abs(N) for N in moments.values()) == pytest.approx(1.691, abs=5e-4)
    assert moments[1] == pytest.approx(-0.2524, abs=5e-5)  # trailing edge to port turns to port
    assert moments[-1] == -moments[1]


def test_derivatives_are_finite_at_rest_in_still_air():
    assert np.isfinite(gloria().linearise(np.zeros(8)).A).all()


# ---------------------------------------------------------------------- steady sailing


@pytest.mark.parametrize("variant", ["source", "physical"])
@pytest.mark.parametrize("row", STEADY, ids=[row["case"] for row in STEADY])
def test_steady_states_with_a_fixed_sail(row, variant):
    value = {name: float(text) for name, text in row.items() if name != "case"}
    boat = gloria(variant, wind=(5, 0), sail=math.radians(value["lam_deg"]))
    exact = [value[name] for name in ("u", "v", "phi_rad", "sigma_rad")]
    heading = math.radians(value["psi_deg"])
    x, rudder = boat.steady(heading, [1.01 * z + 0.001 for z in exact])
    assert [x[4], x[5], x[2], rudder] == pytest.approx(exact, abs=2e-9)  # digits of the file
    boat.set("rudder", rudder)
    slope = boat.derivatives(x)
    assert np.abs(slope[2:]).max() < 1e-9
    north, east, _down = to_ned((x[2], 0.0, heading), (x[4], x[5], 0.0))
    assert slope[:2] == pytest.approx([north, east], abs=1e-14)


def test_no_steady_state_is_an_error():
    with pytest.raises(ArithmeticError, match="no steady state found"):
        gloria(wind=(50, 0), sail=math.radians(60)).steady(math.pi / 2, (2, 0, -0.4, 0))


# Best speed over sail (2.5 deg) and flap (5 deg), 5 m/s of wind: attached, rudder below 12 deg.
@pytest.mark.slow
@pytest.mark.parametrize(
    ("wind_angle", "speed"),
    [
        (110, 2.84),
        *(pytest.param(*point, marks=pytest.mark.interop) for point in ((45, 1.09), (70, 1.84))),
    ],
)
def test_points_of_the_polar(wind_angle, speed):
    boat, heading = gloria(wind=(5, 0)), math.radians(180 - wind_angle)
    best = 0.0
    for flap in range(0, 31, 5):
        boat.set("flap", math.radians(flap))
        guess = (1.5, -0.05, -0.4, 0.0)
        for sail in np.arange(20.0, 80.1, 2.5):
            boat.set("sail", math.radians(sail))
            try:
                x, rudder = boat.steady(heading, guess)
            except ArithmeticError:
                continue
            if abs(x[5]) < 0.25 * x[4] and abs(rudder) < math.radians(12) and abs(x[2]) < 1.2:
                guess = (x[4], x[5], x[2], rudder)
                best = max(best, x[4])
    assert best == pytest.approx(speed, abs=0.006)  # printed digits and half a step of the sail


# ---------------------------------------------------------------------- laws


def energy(x):
    return 0.5 * x[4:] @ M @ x[4:] + 0.5 * 27.2 * 9.81 * 0.2 * math.sin(x[2]) ** 2


def test_power_without_foils_is_that_of_the_damping():
    boat = gloria(**NO_FOILS)
    generator = np.random.default_rng(1)
    for _ in range(100):
        x = generator.uniform(-1.5, 1.5, 8)
        slope = boat.derivatives(x)
        righting = 27.2 * 9.81 * 0.2 * math.sin(x[2]) * math.cos(x[2]) * slope[2]
        u, v, _p, r = x[4:]
        power = -7 * u**2 - 23 * v**2 - 48 * r**2
        assert x[4:] @ M @ slope[4:] + righting == pytest.approx(power, abs=3e-13)


def test_energy_is_conserved_without_foils_and_damping():
    boat = placed(gloria(**NO_FOILS, **NO_DAMPING), STRAY)
    run = boat.reference(np.linspace(0, 20, 41), rtol=1e-12, atol=1e-13)
    energies = np.array([energy(x) for x in run.x])
    assert np.abs(energies / energies[0] - 1).max() < 1e-9


def sailed(side, seconds=40.0, h=0.02):
    """Sail a course with everything moving; ``side`` -1 mirrors port and starboard."""
    start = np.array([0, 0, 0.05, 0.9, 0.5, 0.05, 0, 0.02])
    boat = placed(gloria(wind=(5, 0), max_step=h), start * (MIRROR if side < 0 else 1))
    boat.initialise()
    boat.begin()
    for k in range(round(seconds / h)):
        t = k * h
        boat.set("sail", side * (0.9 + 0.2 * math.sin(0.3 * t)))
        boat.set("flap", 0.2 + 0.2 * math.sin(0.7 * t))
        boat.set("rudder", side * 0.1 * math.sin(0.5 * t))
        boat.set("current.east", side * 0.2)
        boat.advance(t, h)
    return state_of(boat)


def test_port_and_starboard_mirror_each_other():
    one, other = sailed(1), sailed(-1)
    np.testing.assert_allclose(other, MIRROR * one, rtol=0, atol=1.2e-14)
    assert 0.1 < abs(one[2]) < 1.2
    assert np.hypot(*one[:2]) > 20.0


# ---------------------------------------------------------------------- current


def carried(current, **changes):
    """Return a run with sail, keel and rudder at work, in the frame that drifts with the water."""
    drift = np.array(current)
    start = np.array([0, 0, 0, 0.9, 1.0, 0.1, 0, 0.2])
    c, s = math.cos(0.9), math.sin(0.9)
    start[4:6] += [c * drift[0] + s * drift[1], -s * drift[0] + c * drift[1]]
    boat = placed(gloria(current=current, wind=(5 + drift[0], drift[1]), **changes), start)

    def helm(t, x):
        return {"sail": 0.9, "flap": 0.1, "rudder": 0.15 * math.sin(t)}

    t = np.linspace(0, 20, 21)
    run = boat.reference(t, helm, rtol=1e-12, atol=1e-13)
    return run.x[:, :4] - np.column_stack([np.outer(t, drift), np.zeros((21, 2))])


LEVEL = {"sail_axis.z": 0.0, "keel_place.z": 0.0, "rudder_place.z": 0.0}


@pytest.mark.slow
def test_a_current_carries_a_level_boat_exactly():
    still, moving = carried((0.0, 0.0), **LEVEL), carried((0.6, -0.8), **LEVEL)
    # The tables' kinks limit what the integrator reaches.
    np.testing.assert_allclose(moving, still, atol=1e-8)
    assert np.ptp(still[:, 3]) > 0.1


def test_a_spinning_hull_drifts_with_the_water():
    # With fore and aft alike: Y_rdot pushes a spinning hull off its place.
    boat = gloria(**NO_FOILS, **NO_DAMPING, Y_rdot=0.0, current=(0.6, -0.8))
    boat.set("nu_start", [0.6, -0.8, 0, 0.5])  # as the water, and turning
    run = boat.reference([0.0, 10.0], rtol=1e-12, atol=1e-13)
    np.testing.assert_allclose(run.x[-1, :4], [6, -8, 0, 5], atol=1e-9)
    c, s = math.cos(5), math.sin(5)
    along, across = 0.6 * c - 0.8 * s, -0.6 * s - 0.8 * c
    np.testing.assert_allclose(run.x[-1, 4:], [along, across, 0, 0.5], atol=1e-9)


def test_a_current_carries_a_heeled_boat_on_a_steady_course():
    still = gloria(wind=(5, 0), sail=math.radians(55))
    moving = gloria(wind=(5.6, -0.8), current=(0.6, -0.8), sail=math.radians(55))
    x, rudder = still.steady(math.pi / 2, (2.2, 0.0, -0.3, 0.0))
    y, other = moving.steady(math.pi / 2, (1.4, -0.6, -0.3, 0.0))
    assert (y[2], other) == pytest.approx((x[2], rudder), abs=1e-10)
    # Heading east the bow has -0.8 of the current, starboard -0.6 foreshortened by the heel.
    in_water = [y[4] + 0.8, y[5] + 0.6 * math.cos(y[2])]
    assert in_water == pytest.approx(x[4:6], abs=1e-10)
    assert abs(x[2]) > 0.2


def test_what_heel_leaves_of_a_current_while_turning_and_rolling():
    """M (nu' - nu_c' - still nu') is m (r u_c sin^2 phi - p v_c tan phi) in sway, and no more."""
    generator = np.random.default_rng(2)
    h = 1e-6
    for _ in range(20):
        x = generator.uniform(-1, 1, 8)
        drift = generator.uniform(-1, 1, 2)

        def water(eta, drift=drift):
            c, s = math.cos(eta[3]), math.sin(eta[3])
            across = math.cos(eta[2]) * (-s * drift[0] + c * drift[1])
            return np.array([c * drift[0] + s * drift[1], across, 0, 0])

        still = gloria(wind=(5, 0), sail=0.9, flap=0.1, rudder=0.1)
        moving = gloria(wind=np.add(drift, (5, 0)), current=drift, sail=0.9, flap=0.1, rudder=0.1)
        slope = still.derivatives(x)
        other = moving.derivatives(x + np.array([0, 0, 0, 0, *water(x[:4])]))
        turning = (water(x[:4] + h * slope[:4]) - water(x[:4] - h * slope[:4])) / (2 * h)
        (u_c, v_c, *_), (_u, _v, p, r) = water(x[:4]), x[4:]
        left = r * u_c * math.sin(x[2]) ** 2 - p * v_c * math.tan(x[2])
        np.testing.assert_allclose(
            M @ (other[4:] - turning - slope[4:]), [0, -27.2 * left, 0, 0], atol=1e-8
        )


# ---------------------------------------------------------------------- fixed steps


def stepped(h, seconds):
    boat = placed(gloria(**NO_FOILS, max_step=h), STRAY)
    boat.initialise()
    boat.begin()
    for k in range(round(seconds / h)):
        boat.advance(k * h, h)
    return state_of(boat)


END = np.array(
    [
        *(1.2530766384, 1.0809945147, -0.2774059055, 0.6057804680),
        *(0.6468537478, 0.0614385894, -0.1937454357, -0.0131964807),
    ]
)


def test_free_motion_of_the_hull():
    run = placed(gloria(**NO_FOILS), STRAY).reference([0.0, 2.0])
    np.testing.assert_allclose(run.x[-1], END, atol=6e-11)  # digits given
    np.testing.assert_allclose(stepped(0.01, 2.0), END, atol=1e-9)


def test_fixed_step_has_order_four_without_the_kinks_of_the_tables():
    exact = placed(gloria(**NO_FOILS), STRAY).reference([0.0, 2.0]).x[-1]
    errors = [np.abs(stepped(h, 2.0) - exact).max() for h in (0.2, 0.1, 0.05, 0.025)]
    orders = np.log2(np.divide(errors[:-1], errors[1:]))
    assert (orders > 3.8).all()
    assert (orders < 4.2).all()


# ---------------------------------------------------------------------- outputs


def test_motion_as_sensors_expect_it():
    boat = placed(gloria(), [7, -3, 0.2, 1.1, 1.5, -0.1, 0.05, 0.3])
    boat.initialise()
    assert boat.get("position") == [7, -3, 0]
    assert boat.get("attitude") == [0.2, 0, 1.1]
    assert boat.get("velocity") == [1.5, -0.1, 0]
    assert boat.get("rates") == [0.05, 0, 0.3]
    u_dot, v_dot = boat.derivatives(state_of(boat))[4:6]
    inertial = [u_dot + 0.3 * 0.1, v_dot + 0.3 * 1.5, -0.1 * 0.05]
    assert boat.get("acceleration") == pytest.approx(inertial, abs=1e-15)


@pytest.mark.parametrize(
    ("heading", "speed", "expected"),
    [
        (0.0, 0.0, (5.0, 0.0)),  # from astern
        (math.pi / 2, 0.0, (5.0, -math.pi / 2)),  # from starboard
        (math.pi, 1.0, (6.0, math.pi)),  # from ahead, and the boat's own way
        (math.pi / 2, 5.0, (5.0 * math.sqrt(2.0), -0.75 * math.pi)),
    ],
)
def test_apparent_wind(heading, speed, expected):
    boat = placed(gloria(wind=(5, 0), sail=1.0), [0, 0, 0, heading, speed, 0, 0, 0])
    boat.initialise()
    found = boat.get("apparent_wind")
    assert abs(found[1]) == pytest.approx(abs(expected[1]), abs=1e-15)
    assert [found[0], math.cos(found[1] - expected[1])] == pytest.approx([expected[0], 1.0])


def test_apparent_wind_turns_with_the_boats_rates():
    boat = placed(gloria(wind=(5, 0), sail=1.0), [0, 0, 0, 0.4, 1, 0.1, 0.2, 0.3])
    boat.initialise()
    # Eq. 2.18 with lambda = 0: l1 = -0.343, l2 = 0.228, h1 = 0.867.
    a = 5 * math.cos(0.4) - 1
    b = -5 * math.sin(0.4) - 0.1 + 0.3 * (-0.343 + 0.228) - 0.2 * 0.867
    assert boat.get("apparent_wind") == pytest.approx([math.hypot(a, b), math.atan2(b, a)])
