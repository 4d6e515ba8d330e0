"""Control and engine of ships over random inputs beside their recursion; the notch by SciPy."""

import math

import numpy as np
import pytest
from scipy import signal

from seatrial_kits.ships.control.dynamic_positioning import DynamicPositioning
from seatrial_kits.ships.control.heading_autopilot import HeadingAutopilot
from seatrial_kits.ships.control.reference_filter import HeadingReference
from seatrial_kits.ships.devices.marine_engine import MarineEngine
from seatrial_kits.ships.devices.rudder_machine import RudderMachine
from tests.devices.running import over, started

STEPS, H = 60, 0.3


def clip(x, most):
    return np.minimum(np.maximum(x, -np.asarray(most)), most)


def wrapped(x):
    return math.remainder(x, math.tau)


def notched(samples, w, z):
    """Return samples after (s^2 + 2 z w s + w^2) / (s + w)^2, exact at w, settled on the first."""
    # The bilinear rule with the rate at which w stays w.
    rate = w / (2 * math.tan(w * H / 2))
    b, a = signal.bilinear([1, 2 * z * w, w * w], [1, 2 * w, w * w], rate)
    start = signal.lfilter_zi(b, a) * samples[0]
    return signal.lfilter(b, a, samples, zi=start)[0]


def walk(seed, *scale):
    draw = np.random.default_rng(seed)
    return np.cumsum(draw.normal(size=(STEPS, len(scale))) * scale, axis=0)


@pytest.mark.parametrize("wave", [0.0, 0.9])
@pytest.mark.parametrize(("lag", "response"), [(0.0, 1.0), (4.0, 1.5), (1.0, 2.0)])
def test_a_ship_is_positioned_by_its_recursion(wave, lag, response):
    mass, w = np.array([7e6, 13e6, 4e9]), np.array([0.21, 0.17, 0.3])
    zeta, sigma = np.array([0.9, 1.2, 0.8]), np.array([0.02, 0.03, 0.05])
    most = np.array([1.1e6, 0.8e6, 9e7])
    eta = np.add(walk(1, 0.9, 0.7, 0.1), [40.0, -30.0, 2.8])
    nu = 0.4 * walk(2, 0.1, 0.1, 0.004)
    station, wanted = np.array([41.0, -29.0]), -3.0
    held = started(
        DynamicPositioning, period=H, mass=mass, natural_frequency=w, damping_ratio=zeta,
        integral_pole=sigma, capacity=most, thruster_time_constant=lag, wave_frequency=wave,
        thruster_response=response, wave_damping=0.2, station=station, station_heading=wanted,
        attitude=[0, 0, eta[0, 2]], position=[*eta[0, :2], 0], velocity=[*nu[0, :2], 0],
        rates=[0, 0, nu[0, 2]],
    )  # fmt: skip
    rows = [
        {
            "position": [x, y, 1.0], "attitude": [0.1, 0.2, wrapped(psi)],
            "velocity": [u, v, 0.3], "rates": [0.2, 0.1, r],
        }
        for (x, y, psi), (u, v, r) in zip(eta, nu, strict=True)
    ]  # fmt: skip
    found = over(held, ["demand"], H, rows)
    seen = np.hstack([eta, nu])
    if wave:
        seen = np.array([notched(column, wave, 0.2) for column in seen.T]).T
    kd, kp = mass * (2 * zeta * w + sigma), mass * (w**2 + 2 * zeta * w * sigma)
    ki, learnt, force = mass * w**2 * sigma, np.zeros(3), np.zeros(3)

    def turned(three, psi):
        across = complex(*three[:2]) * np.exp(1j * psi)
        return np.array([across.real, across.imag, three[2]])

    limits = 0
    for k, here in enumerate(seen):
        off = [*(station - here[:2]), wrapped(wanted - here[2])]
        push = kp * turned(off, -here[2])
        tau = clip(push, most) - kd * here[3:] + turned(learnt, -eta[k, 2])
        given = clip(tau, most)
        asked = given
        if lag > response:
            asked = clip(force + lag / response * (given - force), most)
        np.testing.assert_allclose(found[k], asked, rtol=1e-8, atol=1e-3)
        grown = H * ki / kp * (np.where(abs(push) <= most, push, 0) + given - tau)
        learnt = learnt + turned(grown, eta[k, 2])
        if lag:
            force = asked + (force - asked) * math.exp(-H / lag)
        limits += np.count_nonzero(given != tau)
    assert limits > 5


@pytest.mark.parametrize("wave", [0.0, 0.9])
def test_a_heading_is_held_by_its_recursion(wave):
    psi, r = 2.9 + walk(3, 0.1)[:, 0], 0.05 * walk(4, 0.3)[:, 0]
    wanted, wanted_rate = -2.6, 0.004
    pilot = started(
        HeadingAutopilot, period=H, proportional_gain=0.7, derivative_gain=9.0, integral_gain=0.03,
        rudder_limit=0.5, wave_frequency=wave, wave_damping=0.2, reference=wanted,
        reference_rate=wanted_rate, heading=psi[0], yaw_rate=r[0],
    )  # fmt: skip
    rows = [{"heading": wrapped(a), "yaw_rate": b} for a, b in zip(psi, r, strict=True)]
    found, integral, limits = over(pilot, ["rudder", "error"], H, rows), 0.0, 0
    left, slow = (notched(x, wave, 0.2) if wave else x for x in (psi, r))
    for k in range(STEPS):
        error = wrapped(psi[k] - wanted)
        asked = 0.7 * wrapped(left[k] - wanted) + 9.0 * (slow[k] - wanted_rate) + integral
        held = float(clip(asked, 0.5))
        np.testing.assert_allclose(found[k], [held, error], atol=1e-9)
        integral += H * 0.03 * (error + (held - asked) / 0.7)
        limits += held != asked
    assert 3 < limits < STEPS


def test_waves_beyond_half_the_sample_rate_are_not_filtered():
    values = {"heading": 0.3, "yaw_rate": 0.02, "period": H, "rudder_limit": 9.0}
    plain, filtered = (
        started(HeadingAutopilot, **values, wave_frequency=w) for w in (0.0, 1.01 * math.pi / H)
    )
    for pilot in (plain, filtered):
        pilot.advance(0.0, H)
        pilot.set("heading", 0.5)
    assert plain.get("rudder") == pytest.approx(filtered.get("rudder"))


def test_a_course_is_followed_as_its_differential_equation_says():
    w, zeta, h = 0.13, 0.8, 0.2
    model = started(
        HeadingReference, natural_frequency=w, damping_ratio=zeta, rate_limit=1.0, period=h,
        heading_start=2.9, target=-3.1,
    )  # fmt: skip
    found = over(model, ["heading", "rate"], h, [{}] * 200)
    spread, step = 2 * zeta + 1, math.tau - 3.1 - 2.9  # the shorter way, through south
    system = signal.lti([w**3], [1, spread * w, spread * w**2, w**3])
    t = h * np.arange(200)
    expected = 2.9 + step * signal.step(system, T=t)[1]
    np.testing.assert_allclose(found[:, 0], expected, atol=1e-6)
    np.testing.assert_allclose(found[1:-1, 1], np.gradient(expected, h)[1:-1], atol=1e-4)


def test_a_limited_rate_and_a_craft_that_is_steered_by_hand():
    model = started(
        HeadingReference, natural_frequency=0.2, rate_limit=0.03, period=0.1, target=2.0
    )
    found = over(model, ["rate"], 0.1, [{}] * 900)[:, 0]
    assert found.max() == pytest.approx(0.03, rel=1e-6)
    assert model.get("heading") == pytest.approx(2.0, abs=0.01)
    for rate, shown in ((0.02, 0.02), (0.5, 0.03), (-0.5, -0.03)):
        by_hand = {"engaged": False, "measured_heading": -7.5, "measured_rate": rate}
        for name, value in by_hand.items():
            model.set(name, value)
        assert (model.get("heading"), model.get("rate")) == (-7.5, shown)
    model.advance(90.0, 0.1)  # goes on from there, at its rate and no acceleration
    model.set("engaged", True)
    assert model.get("heading") == pytest.approx(-7.5 - 0.003, abs=1e-4)


ENGINE = {
    "rated_speed": (11.0, 7.0), "rated_torque": (900.0, 600.0), "torque_at_rest": 0.6,
    "load_time": 4.0, "reversing_speed": 0.4, "inertia": 250.0, "friction": 20.0,
    "governor_gain": 3.0, "governor_time": 1.7,
}  # fmt: skip


@pytest.mark.parametrize(
    ("fault", "slower", "left"), [("none", 1, 1), ("slow", 10, 1), ("wrong", 1, 0.5)]
)
def test_an_engine_governs_its_shaft_within_its_limits(fault, slower, left):
    engine, h = started(MarineEngine, **ENGINE), 0.2
    orders = np.repeat([0.8, 0.3, -1.4, 0.0, 1.5, -0.5], 40)
    rows, n, M, integral = [], 0.0, 0.0, 0.0
    expected = []
    for order in orders:
        load = 6.0 * n * abs(n) + 5.0
        rows.append({"command": order, "load": load, "fault": fault})
        rated = 11.0 if n >= 0 else 7.0
        expected.append([n, n / rated, M, M * n])
        order = min(max(order, -1), 1)
        side, most, full = (1, 900.0, 11.0) if order >= 0 else (-1, 600.0, 7.0)
        P = 3.0 * most / full * (order * full - n)
        grown = integral + P * h / 1.7
        ahead = side * n / rated
        share = min(0.6 + 0.4 * max(ahead, 0), max(side * M, 0) / most + h / (4.0 * slower))
        given = side * min(max(side * (P + grown), 0.0), share * most)
        if order == 0 or ahead < -0.4:
            given = 0.0
        integral = grown if given == P + grown else integral if given else 0.0
        M = left * given
        turned = n + h * (M - load) / 250.0
        n = math.copysign(max(abs(turned) - h * 20.0 / 250.0, 0.0), turned)
    found = over(engine, ["speed", "shaft_order", "torque", "power"], h, rows)
    np.testing.assert_allclose(found, expected, rtol=1e-9, atol=1e-9)
    assert found[:, 0].min() < -0.2
    assert found[:, 0].max() > 1.0


@pytest.mark.parametrize(
    ("word", "share"),
    [
        ("dead slow ahead", 0.31),
        ("half astern", -0.62),
        ("full ahead", 0.83),
        ("stop", 0.0),
        ("remote", 0.17),
    ],
)
def test_the_telegraph_orders_its_shares(word, share):
    values = {**ENGINE, "telegraph_speeds": (0.31, 0.47, 0.62, 0.83), "telegraph": word}
    ordered = started(MarineEngine, **values, command=0.17)
    remote = started(MarineEngine, **ENGINE, command=share)
    for k in range(30):
        ordered.advance(0.2 * k, 0.2)
        remote.advance(0.2 * k, 0.2)
    assert ordered.get("speed") == remote.get("speed")
    assert (ordered.get("speed") != 0.0) == (share != 0.0)


@pytest.mark.parametrize(
    ("fault", "goal", "slower"), [("none", 0.1, 1), ("wrong", 0.22, 1), ("slow", 0.1, 10)]
)
@pytest.mark.parametrize(("positive", "way"), [("port", 1), ("starboard", -1)])
def test_a_rudder_machine_lags_within_its_rate(fault, goal, slower, positive, way):
    machine = started(
        RudderMachine, limit=0.6, rate=0.05, time_constant=0.8, positive=positive, max_step=0.01,
        angle_start=0.03, command=0.1,
    )  # fmt: skip
    angle, expected = 0.03, []
    found = over(machine, ["angle"], 0.4, [{"fault": fault}] * 20)[:, 0]
    for _ in range(20):
        expected.append(angle)
        left = 0.4 / slower
        off = way * goal - angle
        # At its rate until the lag asks for less, then as the lag does.
        fast = min(left, max(0.0, (abs(off) - 0.05 * 0.8) / 0.05))
        angle += math.copysign(0.05 * fast, off)
        off = way * goal - angle
        angle = way * goal - off * math.exp(-(left - fast) / 0.8)
    np.testing.assert_allclose(found, expected, atol=1e-5)


def test_a_rudder_stops_at_its_limit():
    machine = started(RudderMachine, limit=0.6, rate=5.0, time_constant=0.1, command=-2.0)
    machine.advance(0.0, 5.0)
    assert machine.get("angle") == pytest.approx(-0.6)
