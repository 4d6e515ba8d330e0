"""The multirotor at random poses over a tilted deck, against its equations in NumPy."""

import math

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from seatrial_kits.drone.multirotor import Multirotor
from tests.devices.running import started

G, RHO, DOWN = 9.81, 1.225, np.array([0.0, 0.0, 1.0])
PLACES, SPINS = ((1, 1), (-1, -1), (1, -1), (-1, 1)), np.array([1, 1, -1, -1])


def over_a_deck(draw):
    """Return ports of a drone whose rotors are 0.1 to 0.5 m over a deck, some beyond its edge."""
    deck = draw.uniform(-0.3, 0.3, 3)
    pad = np.array([0.2, -0.1, -0.3])
    place = draw.uniform([0.1, -0.2, -1.0], [0.4, 0.2, -0.8])
    origin = draw.normal(size=3)
    return {
        "mass": draw.uniform(5, 12), "inertia": draw.uniform(0.2, 0.6, 3), "inflow": 5e-4,
        "hub": np.array([0.25, 0.3, draw.uniform(-0.1, 0.1)]), "rotor_lag": 0.07,
        "rotor_diameter": 0.45, "drag_area": draw.uniform(0.1, 0.3, 3), "pad": pad,
        "deck_size": np.array([1.1, 0.9]), "feet": np.array([0.2, 0.15, 0.22]),
        "deck_attitude": deck, "deck_position": origin, "deck_velocity": draw.normal(size=3),
        "deck_rates": draw.normal(size=3), "wind": draw.normal(size=3) * 3,
        "attitude_start": draw.uniform(-0.6, 0.6, 3), "velocity_n_start": draw.normal(size=3),
        "position_start": origin + Rotation.from_euler("ZYX", deck[::-1]).apply(place),
        "rates_start": draw.normal(size=3), "rotor_speed_start": draw.uniform(300, 700, 4),
        "command": draw.uniform(300, 700, 4), "wake_length": 0.6,
    }  # fmt: skip


def plain(values):
    return {name: np.asarray(value).tolist() for name, value in values.items()}


@pytest.mark.parametrize("seed", range(6))
def test_a_drone_in_the_air_over_a_tilted_deck(seed):
    ports = over_a_deck(np.random.default_rng(seed))
    drone = started(Multirotor, **plain(ports))
    at = ports.__getitem__
    own, deck = (
        Rotation.from_euler("ZYX", at(name)[::-1]) for name in ("attitude_start", "deck_attitude")
    )
    place = deck.inv().apply(at("position_start") - at("deck_position"))
    w, v, n = at("rates_start"), at("velocity_n_start"), at("rotor_speed_start")
    D, m, inertia = at("rotor_diameter"), at("mass"), at("inertia")
    k_t = 0.10 * RHO * D**4 / (4 * math.pi**2)
    k_q = 0.045 / (2 * math.pi) * RHO * D**5 / (4 * math.pi**2)
    spin_up = (at("command") - n) / 0.07
    air = own.inv().apply(v - at("wind"))
    torques = k_q * n**2 + 3.0e-4 * spin_up
    total, moment, gains = 0.0, SPINS @ torques * DOWN, []
    for (ahead, aside), speed in zip(PLACES, n, strict=True):
        arm = at("hub") * [ahead, aside, 1]
        hub = place + deck.inv().apply(own.apply(arm))
        z = at("pad")[2] - hub[2]  # of the hub over the deck
        over = abs(hub[0]) <= 0.55 and abs(hub[1]) <= 0.45
        gains.append(1 / (1 - (D / 2 / (4 * max(z, D / 4))) ** 2) if over and z > 0 else 1.0)
        climb = -(air + np.cross(w, arm))[2]
        thrust = max(k_t * speed**2 - 5e-4 * speed * climb, 0.0) * gains[-1]
        total, moment = total + thrust, moment + np.cross(arm, [0, 0, -thrust])
    hover = math.sqrt(m * G / (4 * k_t))
    drag = -0.5 * RHO * at("drag_area") * np.linalg.norm(air) * air
    drag -= 0.30 * n.mean() / hover * air * [1, 1, 0]
    acceleration = G * DOWN + own.apply(drag - total * DOWN) / m
    momentum = inertia * w - 3.0e-4 * (SPINS @ n) * DOWN
    slopes = dict(
        zip(drone.compiled().x_names, drone.derivatives(drone._start_state()), strict=True)
    )
    turning = (moment - np.cross(w, momentum)) / inertia
    assert [slopes[f"rates.{axis}"] for axis in "pqr"] == pytest.approx(turning, rel=1e-9)
    found = [slopes[f"velocity_n.{axis}"] for axis in ("north", "east", "down")]
    assert found == pytest.approx(acceleration, rel=1e-9)
    assert [slopes[name] for name in slopes if name.startswith("rotor")] == pytest.approx(spin_up)
    # The quaternion of the turn since the start is (1, 0, 0, 0).
    assert [slopes[f"turn.{axis}"] for axis in "wxyz"] == pytest.approx([0.0, *w / 2])
    assert drone.get("thrust") == pytest.approx(total, rel=1e-9)
    assert drone.get("attitude") == pytest.approx(at("attitude_start"), rel=1e-9)
    assert drone.get("velocity") == pytest.approx(own.inv().apply(v), rel=1e-9)
    assert drone.get("acceleration") == pytest.approx(own.inv().apply(acceleration), rel=1e-9)
    assert drone.get("torque") == pytest.approx(SPINS * torques, rel=1e-9)
    assert drone.get("power") == pytest.approx(max(torques @ n, 0.0) / 0.8, rel=1e-9)
    assert drone.get("place") == pytest.approx(place, rel=1e-9)
    height = max(at("pad")[2] - 0.22 - place[2], 0.0)
    wake = math.exp(-((height / 0.6) ** 2)) * total
    assert (drone.get("load"), drone.get("legs_load")) == (pytest.approx(wake, rel=1e-9), 0.0)
    assert drone.get("force") == pytest.approx([0.0, 0.0, wake], rel=1e-9)
    x, y, _ = place
    assert drone.get("moment") == pytest.approx([y * wake, -x * wake, 0.0], rel=1e-9)
    assert max(gains) > 1.0


def test_some_rotors_are_beyond_the_edge_in_these_poses():
    beyond = 0
    for seed in range(6):
        ports = over_a_deck(np.random.default_rng(seed))
        drone = started(Multirotor, **plain(ports))
        free = started(Multirotor, **plain({**ports, "deck_size": np.array([9.0, 9.0])}))
        beyond += free.get("thrust") > drone.get("thrust") + 1e-6
    assert beyond >= 2


@pytest.mark.parametrize("seed", range(3))
def test_a_turn_since_the_start_goes_on_from_the_attitude_there(seed):
    draw = np.random.default_rng(seed)
    ports = over_a_deck(draw)
    first, turn = (
        Rotation.from_euler("ZYX", ports["attitude_start"][::-1]),
        Rotation.random(rng=draw),
    )
    x, y, z, w = turn.as_quat()
    # Any length of the quaternion is one turn; its length comes back to 1 by (1 - |q|^2) q.
    ports["turn_start"] = 1.1 * np.array([w, x, y, z])
    drone = started(Multirotor, **plain(ports))
    expected = (first * turn).as_euler("ZYX")[::-1]
    assert drone.get("attitude") == pytest.approx(expected, rel=1e-9)
    slopes = dict(
        zip(drone.compiled().x_names, drone.derivatives(drone._start_state()), strict=True)
    )
    p, q, r = ports["rates_start"]
    quaternion = ports["turn_start"]
    turning = np.array([
        [0, -p, -q, -r], [p, 0, r, -q], [q, -r, 0, p], [r, q, -p, 0]
    ])  # fmt: skip
    wanted = turning @ quaternion / 2 + (1 - 1.21) * quaternion
    assert [slopes[f"turn.{axis}"] for axis in "wxyz"] == pytest.approx(wanted, rel=1e-9)
