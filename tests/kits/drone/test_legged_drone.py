"""The drone on its legs against statics and dynamics of a body on an inclined plane."""

import math
from itertools import pairwise

import casadi as ca
import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from seatrial.physics.contact import friction as coulomb
from seatrial.physics.contact import hunt_crossley
from seatrial_kits.drone.legged_drone import LeggedDrone
from tests.craft.numerically import numbers

G, MASS, LEG, STIFFNESS = 9.81, 10.0, 0.25, 6131.0
WEIGHT = MASS * G
PAD = 0.2  # m, the deck above the craft's origin
STEP = 0.002  # s


def drone(**values):
    component = LeggedDrone("drone")
    for name, value in values.items():
        component.set(name, value)
    component.initialise()
    component.begin()
    return component


def parked(degrees, friction, **values):
    """Return a drone that stands, motors off, on a large deck that heels to starboard."""
    a = math.radians(degrees)
    height = PAD + LEG - WEIGHT * math.cos(a) / (4 * STIFFNESS)
    return drone(
        position_start=[0.0, height * math.sin(a), -height * math.cos(a)],
        attitude_start=[a, 0.0, 0.0],
        deck_attitude=[a, 0.0, 0.0],
        deck_size=[40.0, 40.0],
        friction=friction,
        stopped_start=50.0,
        **values,
    )


def run(component, duration, each=lambda t: None):
    for _ in range(round(duration / STEP)):
        each(component.now)
        component.advance(component.now, STEP)


def test_weight_goes_from_the_wake_to_the_legs():
    landing = drone(position_start=[0.0, 0.0, -1.5])
    loads = []
    run(landing, 8.0, lambda t: loads.append(landing.get("load")))
    assert landing.get("thrust") < 1e-6
    assert landing.get("load") == pytest.approx(WEIGHT, rel=1e-6)
    assert landing.get("force") == pytest.approx([0.0, 0.0, WEIGHT], rel=1e-6, abs=1e-6)
    assert landing.get("contact_force") == pytest.approx([WEIGHT / 4] * 4, rel=1e-6)
    sunk = WEIGHT / (4 * STIFFNESS)
    assert landing.get("position")[2] == pytest.approx(-(PAD + LEG - sunk), abs=1e-8)
    # peak of the undamped impact of 0.4 m/s on the springs, wake and damping left: v sqrt(k m)
    assert 0.5 * WEIGHT < max(loads) < WEIGHT + 0.4 * math.sqrt(4 * STIFFNESS * MASS)


def test_the_craft_feels_the_weight_where_the_drone_stands():
    landing = drone(position_start=[0.3, 0.2, -0.46], pad=[0.3, 0.2, -0.2], deck_size=[2.0, 2.0])
    run(landing, 6.0)
    x, y, _ = landing.get("place")
    assert (x, y) == pytest.approx((0.3, 0.2), abs=1e-3)
    assert landing.get("moment") == pytest.approx([y * WEIGHT, -x * WEIGHT, 0.0], abs=1e-3)


def test_it_comes_down_at_the_speed_that_it_is_given():
    landing = drone(position_start=[0.0, 0.0, -3.0], descent=0.4)
    run(landing, 4.0)
    assert landing.get("velocity")[2] == pytest.approx(0.4, abs=1e-4)


@pytest.mark.parametrize("friction", [0.30, 0.35])
def test_it_slides_on_a_deck_that_is_steeper_than_its_friction(friction):
    a = math.radians(20.0)  # tan 0.364
    sliding = parked(20.0, friction)
    run(sliding, 1.0)
    early = sliding.get("slip")[1]
    run(sliding, 1.0)
    acceleration = sliding.get("slip")[1] - early
    assert acceleration == pytest.approx(G * (math.sin(a) - friction * math.cos(a)), abs=2e-3)


@pytest.mark.parametrize(("degrees", "friction"), [(20.0, 0.38), (20.0, 0.5), (5.0, 0.6)])
def test_it_creeps_on_one_that_is_not(degrees, friction):
    standing = parked(degrees, friction)
    run(standing, 2.0)
    r = math.tan(math.radians(degrees)) / friction
    assert standing.get("slip")[1] == pytest.approx(0.005 * r / math.sqrt(1 - r * r), rel=0.01)


def test_legs_downhill_carry_more_by_the_moment_of_the_weight():
    a = math.radians(20.0)
    standing = parked(20.0, 0.5)
    run(standing, 2.0)
    port, starboard, *_ = standing.get("contact_force")
    # The legs give way: it leans over by its difference of depths over the track.
    lean = (starboard - port) / STIFFNESS / 0.4
    arm = LEG * math.sin(a + lean) / math.cos(a)
    expected = 0.5 * WEIGHT * math.cos(a) * (0.5 + arm / 0.4)
    assert starboard == pytest.approx(expected, rel=5e-3)
    assert 2 * (port + starboard) == pytest.approx(WEIGHT * math.cos(a), rel=1e-3)


@pytest.mark.slow
def test_it_tips_where_the_weight_passes_its_feet():
    rate = math.radians(1.0)
    tipping = parked(30.0, 2.0, damping=5.0)
    run(tipping, 2.0)
    lifted = []

    def heel(t):
        tipping.set("deck_attitude", [math.radians(30.0) + rate * (t - 2.0), 0.0, 0.0])
        tipping.set("deck_rates", [rate, 0.0, 0.0])
        if min(tipping.get("contact_force")) <= 0.0:
            lifted.append(t)

    run(tipping, 10.0, heel)
    limit = math.degrees(math.atan(0.2 / LEG))
    # Both legs downhill sink in by W cos / 2 k, which leans it over by 0.9 degrees.
    leans = math.degrees(WEIGHT * math.cos(math.radians(limit)) / (2 * STIFFNESS) / 0.4)
    at = 30.0 + (lifted[0] - 2.0)
    assert at == pytest.approx(limit - leans, abs=0.3)
    assert tipping.get("attitude")[0] > math.radians(60.0)


def test_beside_the_deck_nothing_carries_it():
    falling = drone(position_start=[0.0, 1.5, -0.5], pad=[0.0, 1.5, -0.2], descent=2.0)
    run(falling, 4.0)
    assert falling.get("load") == 0.0
    assert falling.get("position")[2] > 1.0


def test_a_foot_far_below_the_deck_is_not_on_it():
    depths = {0.0495: 4 * [0.0495 * STIFFNESS], 0.0505: 4 * [0.0]}
    for depth, forces in depths.items():
        below = drone(position_start=[0.0, 0.0, -PAD - LEG + depth], stopped_start=50.0)
        assert below.get("contact_force") == pytest.approx(forces)


def test_thrust_stays_off_when_it_bounces():
    landing = drone(position_start=[0.0, 0.0, -1.0], descent=1.0, damping=0.0)
    lost = []
    run(landing, 4.0, lambda t: lost.append(landing.get("stopped")))
    assert all(b >= a for a, b in pairwise(lost))
    assert lost[-1] > 5.0


def tumbling(seed, turned=0.0, stopped=0.0):
    """Return forces and rates of change of a drone on a deck that moves, the world turned by z."""
    draw, z = np.random.default_rng(seed), Rotation.from_euler("z", turned)
    yaw = np.array([0.0, 0.0, turned])
    own, deck = draw.uniform(-0.12, 0.12, (2, 3)) + [0, 0, 1] * draw.uniform(-3, 3, (2, 1))
    R, D = (Rotation.from_euler("ZYX", euler[::-1]) for euler in (own, deck))
    above = [*draw.uniform(-0.2, 0.2, 2), -PAD - LEG + draw.uniform(0.0, 0.02)]
    origin, v, rates, V, spin = draw.normal(size=(5, 3))
    x = {
        "position": z.apply(origin + D.apply(above)),
        "velocity": z.apply(v),
        "attitude": own + yaw,
        "rates": rates,
        "clock": 2.0,
        "stopped": stopped,
    }
    u = {
        "deck_position": z.apply(origin),
        "deck_velocity": V,
        "deck_attitude": deck + yaw,
        "deck_rates": spin,
    }
    p = numbers(LeggedDrone, pad=[0.1, -0.05, -PAD], deck_size=[4.0, 4.0], inertia=[0.2, 0.3, 0.4])
    state = type(p)(**{name: ca.DM(value) for name, value in x.items()})
    inputs = type(p)(**{name: ca.DM(value) for name, value in u.items()})
    rates_of_change, outputs = LeggedDrone.equations(None, state, inputs, p)
    as_arrays = [
        {name: np.array(ca.DM(each)).ravel() for name, each in group.items()}
        for group in (rates_of_change, outputs)
    ]
    return (*as_arrays, (R, D, np.array(above), v, rates, V, spin))


@pytest.mark.parametrize("seed", range(6))
def test_legs_on_a_deck_that_turns_and_moves(seed):
    # Motors off: forces of the feet by their velocities over the deck, in {n}.
    changes, found, (R, D, above, v, rates, V, spin) = tumbling(seed, stopped=60.0)
    force, torque, on_deck = np.zeros((3, 3))
    for a, b in ((1, -1), (1, 1), (-1, -1), (-1, 1)):
        arm = R.apply([0.2 * a, 0.2 * b, LEG])
        foot = D.inv().apply(D.apply(above) + arm)
        over = v + np.cross(R.apply(rates), arm) - D.apply(V + np.cross(spin, foot))
        slip = D.inv().apply(over)
        depth = foot[2] + PAD
        normal = hunt_crossley(depth, slip[2], STIFFNESS, 1.0) * (depth < 0.05)
        own = D.apply([*coulomb(normal, slip[:2], 0.6, 0.005), -normal])
        force, torque = force + own, torque + np.cross(arm, own)
        on_deck = on_deck + np.cross(D.apply(foot), own)
    inertia = np.array([0.2, 0.3, 0.4])
    close = {"rtol": 1e-9, "atol": 1e-9}
    np.testing.assert_allclose(changes["velocity"], force / MASS + [0, 0, G], **close)
    spun = inertia * changes["rates"] + np.cross(rates, inertia * rates)
    np.testing.assert_allclose(R.apply(spun), torque, **close)
    np.testing.assert_allclose(found["force"], -D.inv().apply(force), **close)
    np.testing.assert_allclose(found["moment"], -D.inv().apply(on_deck), **close)


@pytest.mark.parametrize("seed", range(3))
def test_its_controller_prefers_no_heading_but_its_own(seed):
    here, there = (tumbling(seed, turned) for turned in (0.0, 1.3))
    for name in ("force", "moment", "thrust", "place", "slip"):
        np.testing.assert_allclose(there[1][name], here[1][name], rtol=1e-9, atol=1e-9)
    # About z it holds north.
    np.testing.assert_allclose(there[0]["rates"][:2], here[0]["rates"][:2], rtol=1e-9)
