"""Controllers over random inputs, gains all unequal, beside the recursion of their equations."""

import math

import numpy as np
import pytest

from seatrial.control.allocation.pulse_allocation import PulseAllocation
from seatrial.control.allocation.thruster_matrix_allocation import ThrusterMatrixAllocation
from seatrial.control.depth_hold import DepthHold
from seatrial.control.heading_hold import HeadingHold
from seatrial.control.helm import Helm
from seatrial.control.rudder_helm import RudderHelm
from seatrial.control.speed_hold import SpeedHold
from seatrial.control.station_keeping import HEADING_ONLY, HOLD, IDLE, RETURN, StationKeeping
from seatrial.control.tilt_hold import TiltHold
from tests.devices.running import over, started

H, STEPS = 0.2, 60


def clip(x, most):
    return min(max(x, -most), most)


def wrapped(x):
    return math.remainder(x, math.tau)


HOLDS = {
    DepthHold: ("mass", "depth", "depth_wanted", "heave", lambda x: x),
    HeadingHold: ("inertia", "heading", "heading_wanted", "yaw_moment", wrapped),
    TiltHold: ("inertia", "angle", "angle_wanted", "moment", lambda x: x),
}
AXIS = {
    "period": H, "natural_frequency": 0.6, "damping_ratio": 1.3, "integral_pole": 0.15,
    "damping": 2.3, "damping_per_speed": 5.1, "damping_rate": 0.8, "full_speed": 1.9,
    "full_surge": 70.0, "speed_lag": 0.7, "rate_filter": 0.45, "rate_limit": 0.35, "capacity": 8.0,
}  # fmt: skip


@pytest.mark.parametrize("kind", HOLDS)
def test_an_axis_is_held_by_its_recursion(kind):
    name, place, wanted, output, apart = HOLDS[kind]
    draw, m = np.random.default_rng(5), 9.3
    y = 3.0 + np.cumsum(draw.normal(0, 0.05, STEPS))
    surge = draw.uniform(-90, 90, STEPS)
    goal = 3.0 + np.repeat(draw.normal(0, 1.2, STEPS // 10), 10)
    held = started(kind, **AXIS, **{name: m, place: y[0], wanted: goal[0]})
    if kind is TiltHold:
        held.set("enabled", True)
    rows = [{place: a, wanted: b, "surge": c} for a, b, c in zip(y, goal, surge, strict=True)]
    found = over(held, [output], H, rows)[:, 0]
    w, zeta, sigma, p = 0.6, 1.3, 0.15, AXIS
    target, before, f, speed, integral, expected = y[0], None, 0.0, 0.0, 0.0, []
    kept = math.exp(-H / p["rate_filter"])
    for here, there, X in zip(y, goal, surge, strict=True):
        share = clip(X / 70.0, 1.0)
        full = 1.9 * math.copysign(math.sqrt(abs(share)), share)
        speed += (1 - math.exp(-H / 0.7)) * (full - speed)
        D = 2.3 + 5.1 * abs(speed)
        kp = m * (w**2 + 2 * zeta * w * sigma) + 0.8 * D
        kd, ki = m * (2 * zeta * w + sigma), sigma * (m * w**2 + 0.8 * D)
        if before is not None:
            f = kept * f + (1 - kept) * apart(here - before) / H
        g, e = clip(apart(there - target) / H, 0.35), apart(target - here)
        demand = kp * e + kd * (g - f) + D * g + integral
        expected.append(clip(demand, 8.0))
        integral += H * ki * (e + (expected[-1] - demand) / kp)
        target, before = target + H * g, here
    np.testing.assert_allclose(found, expected, rtol=1e-10, atol=1e-10)
    assert 5 < sum(abs(each) == 8.0 for each in expected) < STEPS - 5


def test_a_speed_is_held_by_its_recursion():
    draw, m, w, zeta = np.random.default_rng(6), 17.0, 0.4, 0.7
    values = {"natural_frequency": w, "damping_ratio": zeta, "mass": m, "linear_drag": 3.1}
    hold = started(SpeedHold, period=H, quadratic_drag=7.7, capacity=14.0, enabled=True, **values)
    wanted, speed = draw.normal(0, 0.8, (2, STEPS))
    rows = [{"speed_wanted": a, "speed": b} for a, b in zip(wanted, speed, strict=True)]
    found, integral, expected = over(hold, ["surge"], H, rows)[:, 0], 0.0, []
    for U, u in zip(wanted, speed, strict=True):
        demand = 2 * zeta * w * m * (U - u) + integral + 3.1 * U + 7.7 * abs(U) * U
        expected.append(clip(demand, 14.0))
        integral += H * (w**2 * m * (U - u) + w / (2 * zeta) * (expected[-1] - demand))
    np.testing.assert_allclose(found, expected, rtol=1e-10, atol=1e-10)
    assert 5 < sum(abs(each) == 14.0 for each in expected) < STEPS - 5


KEEPER = {
    "period": H, "hold_radius": 2.5, "capture_radius": 0.8, "reach": 1.7, "surge_gain": 9.0,
    "surge_integral": 0.6, "surge_damping": 11.0, "yaw_gain": 7.0, "yaw_integral": 0.5,
    "yaw_damping": 6.0, "surge_limit": 21.0, "moment_limit": 8.0, "half_beam": 0.45,
    "thrust_ahead": 17.0, "thrust_astern": 12.0, "timeout": 0.5,
}  # fmt: skip


def test_a_station_is_kept_by_its_recursion():
    draw, station, wanted = np.random.default_rng(8), np.array([12.0, -7.0]), 0.7
    keeper = started(
        StationKeeping, **KEEPER, enabled=True, station=station, station_heading=wanted
    )
    away = np.repeat(draw.normal(0, 1.6, (STEPS // 5, 2)), 5, axis=0)
    away += 0.3 * draw.normal(size=away.shape)
    headings, velocities = draw.uniform(-9, 9, STEPS), draw.normal(0, 0.4, (STEPS, 2))
    rates, fixed = draw.normal(0, 0.3, STEPS), draw.random(STEPS) < 0.7
    rows = [
        {
            "position_n": [*(station - off), 3.0], "heading": psi, "velocity_n": [*v, 0.1],
            "yaw_rate": r, "position_valid": bool(valid),
        }
        for off, psi, v, r, valid in zip(away, headings, velocities, rates, fixed, strict=True)
    ]  # fmt: skip
    names = ("mode", "distance", "surge_force", "yaw_moment")
    found = over(keeper, names, H, rows)
    mode, backwards, XI, NI, missed, expected = IDLE, False, np.zeros(2), 0.0, math.inf, []
    for e, psi, v, r, valid in zip(away, headings, velocities, rates, fixed, strict=True):
        bow, off = np.array([math.cos(psi), math.sin(psi)]), math.hypot(*e)
        if not valid and (missed + 1) * H > 0.5 + 1e-9:
            now = HEADING_ONLY
        else:
            now = RETURN if off > (0.8 if mode == RETURN else 2.5) else HOLD
        target = wanted
        if now == RETURN:
            target = math.atan2(e[1], e[0])
            if mode != RETURN:
                backwards = abs(wrapped(target - psi)) > math.pi / 2
            target += math.pi * backwards
        turn = wrapped(target - psi)
        N = 7.0 * turn + NI - 6.0 * r
        ahead = max(math.cos(turn), 0) if now == RETURN else 1.0
        ex = clip(e @ bow, 1.7) * ahead
        X = 9.0 * ex + XI @ bow - 11.0 * (v @ bow) if now != HEADING_ONLY else 0.0
        given_N = clip(N, min(8.0, 0.9 * 12.0))
        used = abs(given_N) / 0.9
        given_X = min(max(X, -min(21.0, 2 * (12 - used))), min(21.0, 2 * (17 - used)))
        expected.append([now, off, given_X, given_N])
        NI += H * 0.5 * (turn + (given_N - N) / 7.0)
        if now != HEADING_ONLY and off < 2.5:
            XI = XI + H * 0.6 * (ex + (given_X - X) / 9.0) * bow
        mode, missed = now, 0.0 if valid else missed + 1
        backwards = backwards and now == RETURN
    np.testing.assert_allclose(found, expected, rtol=1e-9, atol=1e-9)
    assert {HOLD, RETURN, HEADING_ONLY} == set(found[:, 0])


# ------------------------------------------------------------------ static ones


def test_a_helm_takes_what_holds_or_its_share_of_the_limit():
    held = {"surge_held": 3.0, "yaw_moment_held": -5.0, "heave_held": 7.0, "sway_held": 11.0}
    limits = {"surge_limit": 20.0, "sway_limit": 30.0, "moment_limit": 40.0, "heave_limit": 50.0}
    direct = [0.5, -0.25, 1.7, -0.1]  # surge, sway, yaw, heave
    for bits in range(8):
        engaged = [bool(bits & bit) for bit in (1, 2, 4)]
        helm = started(Helm, **held, **limits, engaged=engaged, direct=direct)
        X, N, Z = (10.0, 40.0, -5.0)
        expected = [3.0 if engaged[0] else X, 11.0 - 7.5]
        expected += [-5.0 if engaged[1] else N, 7.0 if engaged[2] else Z]
        assert [helm.get(n) for n in ("surge", "sway", "yaw_moment", "heave")] == expected


@pytest.mark.parametrize(("manual", "share"), [(0.4, 0.4), (-0.7, -0.7), (3.0, 1.0), (-2.0, -1.0)])
def test_a_rudder_goes_to_port_to_turn_to_starboard(manual, share):
    helm = started(RudderHelm, rudder_held=0.12, rudder_limit=0.6, manual=manual)
    assert helm.get("rudder") == pytest.approx(-0.6 * share)
    helm.set("engaged", True)
    assert helm.get("rudder") == 0.12


PULSES = {
    "thrust_ahead": 31.0, "thrust_astern": 23.0, "pulse_min": 1.05e-3, "pulse_neutral": 1.48e-3,
    "pulse_max": 1.93e-3, "dead_band": 3e-5, "exponent": 0.6,
}  # fmt: skip


def pulse(thrust):
    """Return the pulse of a thrust, s."""
    span, full = (0.45e-3, 31.0) if thrust > 0 else (0.43e-3, 23.0)
    away = 3e-5 + (span - 3e-5) * (abs(thrust) / full) ** 0.6
    return 1.48e-3 + math.copysign(away, thrust) if thrust else 1.48e-3


@pytest.mark.parametrize(
    ("X", "N"), [(13.0, 4.0), (-20.0, 7.0), (5.0, -9.0), (90.0, 3.0), (-80.0, -50.0)]
)
def test_a_pair_gives_the_moment_first(X, N):
    pair = started(PulseAllocation, **PULSES, half_beam=0.7, surge=X, yaw_moment=N)
    turning = clip(N / 1.4, 23.0)
    half = min(max(X / 2, abs(turning) - 23.0), 31.0 - abs(turning))
    found = pair.get("pulse_port"), pair.get("pulse_starboard")
    assert found == pytest.approx((pulse(half + turning), pulse(half - turning)))


def thrusters(count, seed):
    """Return places and directions at random."""
    draw = np.random.default_rng(seed)
    places, directions = draw.normal(size=(2, count, 3))
    directions /= np.linalg.norm(directions, axis=1)[:, None]
    return places, directions


@pytest.mark.parametrize("moments", ["all", "yaw"])
@pytest.mark.parametrize("scale", [0.3, 6.0])
def test_thrusters_anywhere_give_a_demand_in_its_order(moments, scale):
    places, directions = thrusters(7, 1)
    demand = scale * np.array([9.0, -5.0, 7.0, 3.0, -2.0, 4.0])
    names = ("surge", "sway", "heave", "roll_moment", "pitch_moment", "yaw_moment")
    ports = dict(zip(names, demand, strict=True))
    for number, pair in enumerate(zip(places, directions, strict=True), 1):
        ports |= {f"position_{number}": pair[0], f"direction_{number}": pair[1]}
    made = started(ThrusterMatrixAllocation, **PULSES, **ports, moments=moments)
    B = np.vstack([directions.T, np.cross(places, directions).T])
    rows = [0, 1, 2, 3, 4, 5] if moments == "all" else [0, 1, 2, 5]
    inverse = np.zeros((7, 6))
    inverse[:, rows] = np.linalg.pinv(B[rows])
    T = np.zeros(7)
    for part in ([3, 4], [5], [2], [0, 1]):
        more = inverse[:, part] @ demand[part]
        room = np.where(more > 0, 31.0 - T, -23.0 - T)
        T = T + max(0.0, min([1.0, *(room[more != 0] / more[more != 0])])) * more
    found = made.get("pulse")
    np.testing.assert_allclose(found[:7], [pulse(each) for each in T], rtol=1e-10)
    assert found[7:] == [1.48e-3] * 9
    if scale < 1 and moments == "all":
        np.testing.assert_allclose(B @ T, demand, rtol=1e-10)
    elif scale > 1:
        assert (np.isclose(T, 31.0) | np.isclose(T, -23.0)).any()
