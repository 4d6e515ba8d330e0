"""Landing on a moving deck: laws, tracking, and prediction against closed forms and references."""

import math
from pathlib import Path

import numpy as np
import pytest

from seatrial_kits.drone.landing import laws, prediction, tracking
from seatrial_kits.drone.landing.landing_control import DeckLandingControl
from seatrial_kits.drone.multirotor_attitude import MultirotorAttitude
from seatrial_kits.drone.wave_follower import drawn, moved, period_of
from tests.kit import needs_kits

HERE = Path(__file__).parents[2] / "reference" / "drone"
SIZES = {"hydrone": ((1.168, 0.517, 0.043), 0.2), "wamv": ((4.05, 2.44, 0.15), 1.0)}


def test_the_rendezvous_arrives_at_place_and_velocity_at_its_time():
    z, v, t, T, h = 0.0, -0.3, 0.0, 2.0, 1e-4
    while T - t > 2 * h:
        a = laws.rendezvous(1.5 - z, v, 0.35, T - t)
        z, v, t = z + v * h + a * h * h / 2, v + a * h, t + h
    assert z == pytest.approx(1.5, abs=1e-3)
    assert v == pytest.approx(0.35, abs=5e-3)


def test_thrust_for_an_acceleration():
    thrust, (phi, theta, psi) = laws.thrust_for((1.0, -0.5, 0.3), 10.0, 0.7)
    from scipy.spatial.transform import Rotation

    own = Rotation.from_euler("ZYX", [psi, theta, phi])
    force = own.apply([0, 0, -thrust]) / 10.0 + [0, 0, 9.81]
    assert force == pytest.approx([1.0, -0.5, 0.3], abs=1e-9)


def test_thrust_is_tilted_by_no_more_than_its_limit():
    _, (phi, theta, _) = laws.thrust_for((30.0, 20.0, 0.0), 10.0, 0.0)
    assert math.acos(math.cos(phi) * math.cos(theta)) == pytest.approx(0.40, abs=1e-9)


def test_near_the_deck_the_tilt_stays_near_that_of_integral_and_deck():
    far = laws.below((1.0, 0.0), (0.0, 0.0), (0.2, 0.1), (0.3, 0.0), 2.0)
    assert far == pytest.approx((1.5 * 0.2 + 0.3 + 3.0, 0.15))
    near = laws.below((1.0, 0.0), (0.0, 0.0), (0.2, 0.1), (0.3, 0.0), 0.2)
    assert near == pytest.approx((0.6 + 9.81 * 0.13, 0.15))


@pytest.mark.parametrize(("height", "speed"), [(0.3, 0.4), (1.0, 0.55), (5.0, 0.8)])
def test_it_sinks_more_slowly_near_the_deck(height, speed):
    assert laws.sinking(height) == pytest.approx(speed)


def test_within_the_braking_height_the_law_has_braked_to_its_touch_speed():
    height, velocity, h = laws.braking(2.0), 2.0, 1e-3
    while height > 0.0:
        height -= velocity * h
        velocity += laws.down(laws.sinking(height), velocity, 0.0) * h
    assert velocity == pytest.approx(0.4, abs=0.05)


def test_the_integral_is_limited_in_its_length():
    total = (0.0, 0.0)
    for _ in range(10_000):
        total = laws.integrated(total, (3.0, 4.0), 0.01)
    assert total == pytest.approx((0.6 * 5.0 / 1.5, 0.8 * 5.0 / 1.5))


def test_the_track_follows_an_oscillation():
    draw, omega, h = np.random.default_rng(1), 2.0, 0.05
    x = P = None
    errors = []
    for k in range(400):
        t = k * h
        place = np.array([0.3 * math.sin(omega * t), 0.0, 0.1])
        speed = np.array([0.3 * omega * math.cos(omega * t), 0.0, 0.0])
        if x is None:
            x, P = tracking.first(place)
            continue
        x, P = tracking.moved_on(x, P, h, omega, 0.6)
        x, P = tracking.corrected(x, P, 0, place + draw.normal(0, 0.02, 3), 0.02)
        x, P = tracking.corrected(x, P, 1, speed + draw.normal(0, 0.02, 3), 0.02)
        later = tracking.ahead(x, 0.12, omega)
        errors.append(later[0][0] - 0.3 * math.sin(omega * (t + 0.12)))
    assert np.std(errors[50:]) < 0.008


def test_a_first_sight_leaves_the_velocity_open():
    x, P = tracking.first(np.array([1.0, 2.0, 3.0]))
    v = np.array([0.4, -0.2, 0.1])
    found, left = tracking.corrected(x, P, 1, v, 0.5)
    # Of two independent measurements with the variances 10 and 0.25 (m/s)^2.
    np.testing.assert_allclose(found, [[1.0, 2.0, 3.0], v * 10 / 10.25, [0.0] * 3], rtol=1e-12)
    np.testing.assert_allclose(np.diag(left), [100.0, 1 / (1 / 10 + 1 / 0.25), 1.0], rtol=1e-12)


def test_ahead_is_an_oscillation():
    def swing(t):
        return [[math.sin(2 * t + 0.3)], [2 * math.cos(2 * t + 0.3)], [-4 * math.sin(2 * t + 0.3)]]

    np.testing.assert_allclose(tracking.ahead(swing(0.0), 0.7, 2.0), swing(0.7), rtol=1e-12)


def test_an_oscillation_is_predicted():
    t = np.arange(120) * 2 * math.pi / prediction.PER_PERIOD
    y = np.column_stack([np.sin(t), 0.1 * np.cos(t), 0.05 * np.sin(t + 1.0)])
    later = np.arange(120, 134) * 2 * math.pi / prediction.PER_PERIOD
    expected = np.column_stack([np.sin(later), 0.1 * np.cos(later), 0.05 * np.sin(later + 1.0)])
    found = ar(y, 14)
    assert np.abs(found - expected).max() < 0.02
    # The sea that it expects has no such lines: it draws towards the mean.
    found = prediction.harmonic(y, 14)
    assert np.abs(found[:3] - expected[:3]).max() < 0.3
    assert np.corrcoef(found[:, 0], expected[:, 0])[0, 1] > 0.9


def test_the_harmonic_prediction_is_that_of_its_spectrum():
    # The most likely continuation of a Gaussian signal whose variance the docstring states.
    y = np.random.default_rng(3).normal(size=(40, 3)).cumsum(axis=0) * [0.1, 0.02, 0.01]
    found = prediction.harmonic(y, 6)
    w = 0.4 + 0.05 * np.arange(73)
    sigma = np.where(w > 1.0, 0.09, 0.07)
    jonswap = w**-5.0 * np.exp(-1.25 / w**4) * 3.3 ** np.exp(-0.5 * ((w - 1.0) / sigma) ** 2)
    t = 2 * math.pi / 14 * np.arange(46)
    for axis, (power, noise) in enumerate(((0, 0.01), (4, 0.003), (4, 0.003))):
        shares = jonswap * w**power / (jonswap * w**power).sum()
        whole = sum(s * np.cos(a * (t[:, None] - t)) for s, a in zip(shares, w, strict=True))
        mean, spread = y[:, axis].mean(), y[:, axis].std()
        known = whole[:40, :40] + np.eye(40) * ((noise / spread) ** 2 + (3e-3 if axis else 1e-2))
        expected = mean + whole[40:, :40] @ np.linalg.solve(known, y[:, axis] - mean)
        # 1e-9 is added to the spread.
        np.testing.assert_allclose(found[:, axis], expected, rtol=1e-5, atol=1e-6)


def errors_of(predict, deck, height):
    """Return the errors of heave over its deviation, and of the slopes', by samples ahead."""
    size, pad = SIZES[deck]
    period = period_of(height)
    missed, meant = [], []
    for seed in range(16):
        draw = np.random.default_rng(seed)
        raft = drawn(size, height, period, draw.uniform(0, math.pi), pad, draw)
        rows = []
        for k in range(230):
            (heave, north, east, _, _), _ = moved(
                raft.components, k * period / prediction.PER_PERIOD
            )
            up = pad * math.cos(math.atan(north)) * math.cos(math.atan(east))
            rows.append([heave + up, north, east])
        true = np.array(rows)
        noisy = true + draw.standard_normal(true.shape) * [0.01, 0.003, 0.003]
        for k in range(120, 210, 4):
            missed.append(predict(noisy[k - 120 : k], 14) - true[k : k + 14])
            meant.append(true[k : k + 14] - true.mean(axis=0))
    error = np.sqrt(np.mean(np.square(missed), axis=0))
    spread = np.std(np.concatenate(meant), axis=0)
    return error[:, 0] / spread[0], np.hypot(*error[:, 1:].T) / math.hypot(*spread[1:])


def ar(samples, steps):
    """Return what the autopilot predicts from the samples, one of each second, the last at 0 s."""
    control = DeckLandingControl("landing")
    control.set("wave_period", prediction.PER_PERIOD)
    control.reset_estimate(0.0)
    control.reset_windows(0.0)
    control._samples, control._grid = samples.tolist(), 1
    return np.array([control.predicted(float(k)) for k in range(1, steps + 1)])


def test_coefficients_are_those_of_a_least_squares_fit():
    t, draw = np.arange(120) * 2 * math.pi / prediction.PER_PERIOD, np.random.default_rng(1)
    y = np.column_stack([np.sin(t) + 0.4 * np.sin(1.7 * t + 1.0), 0.1 * np.cos(2.1 * t)])
    y += draw.normal(0.0, 0.01, y.shape)
    order = prediction.ORDER
    for column in range(2):
        about = y[:, column] - y[:, column].mean()
        past = np.column_stack([about[order - i : len(y) - i] for i in range(1, order + 1)])
        normal = past.T @ past
        normal += 1e-3 * np.trace(normal) / order * np.eye(order)
        expected = np.linalg.solve(normal, past.T @ about[order:])
        mean = prediction.mean(y, column)
        found = prediction.coefficients(y, column, mean)
        assert found == pytest.approx(expected, abs=1e-10)


@pytest.mark.slow
@pytest.mark.parametrize("predict", [ar, prediction.harmonic])
@pytest.mark.parametrize("row", range(9))
def test_how_far_a_deck_is_foreseen(predict, row):
    table = np.genfromtxt(
        HERE / "deck-statistics-and-prediction.csv",
        delimiter=",",
        skip_header=1,
        dtype=None,
        encoding=None,
    )[row]
    heave, tilt = errors_of(predict, str(table[0]), float(table[1]))
    # A quarter of the period is 3.5 samples.
    assert 0.5 * (heave[2] + heave[3]) < 0.65
    if predict is ar:
        assert 0.5 * (heave[2] + heave[3]) == pytest.approx(table[8], abs=0.08)
        assert heave[6] == pytest.approx(table[9], abs=0.12)
        assert 0.5 * (tilt[2] + tilt[3]) == pytest.approx(table[12], abs=0.1)


def test_speeds_that_give_the_thrust_and_moments_wanted():
    loop = MultirotorAttitude("loop")
    for name, value in {
        "thrust": 98.1,
        "motors": True,
        "attitude_wanted": [0.02, -0.03, 0.01],
        "rates": [0.1, 0.05, -0.02],
    }.items():
        loop.set(name, value)
    loop.initialise()
    loop.begin()
    k_t, k_q = 7.943580797559283e-05, 2.2756682696065566e-06
    squares = np.square(loop.get("command"))
    assert k_t * squares.sum() == pytest.approx(98.1)
    x, y = np.array([1, -1, 1, -1]) * 0.25, np.array([1, -1, -1, 1]) * 0.25
    spins = np.array([1, 1, -1, -1])
    found = [-(y * k_t * squares).sum(), (x * k_t * squares).sum(), (spins * k_q * squares).sum()]
    w = np.array([0.1, 0.05, -0.02])
    inertia = np.array([0.25, 0.25, 0.4])
    from scipy.spatial.transform import Rotation

    turned = Rotation.from_euler("ZYX", [0.01, -0.03, 0.02]).as_matrix()
    error = np.array(
        [turned[2, 1] - turned[1, 2], turned[0, 2] - turned[2, 0], turned[1, 0] - turned[0, 1]]
    )
    n = np.array([11.0, 11.0, 3.0])
    wanted = inertia * (n**2 * error / 2 - 1.6 * n * w) + np.cross(w, inertia * w)
    assert found == pytest.approx(wanted, abs=1e-9)


def test_motors_off_are_off_and_yaw_gives_way_at_a_limit():
    loop = MultirotorAttitude("loop")
    loop.set("attitude_wanted", [0.0, 0.0, 3.0])
    loop.set("thrust", 196.2)
    loop.initialise()
    loop.begin()
    assert loop.get("command") == [0.0] * 4
    loop.set("motors", True)
    loop.advance(0.0, 0.004)
    assert loop.get("command") == pytest.approx([785.7987745754486] * 4, rel=1e-6)


@pytest.mark.slow
@needs_kits("native")
@pytest.mark.parametrize("control", ["naive", "relative", "predictive"])
def test_each_law_has_c(control):
    from seatrial_kits.native.carriers import why_python

    assert not why_python(DeckLandingControl, {"control": control})
