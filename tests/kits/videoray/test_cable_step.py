"""One implicit step in a sheared current beside dense matrices by differences; the drive's law."""

import math

import numpy as np
import pytest

from seatrial_kits.videoray.cable.cable_solver import Chain, implicit_step
from seatrial_kits.videoray.drive import THRUSTERS, Drive, share_of_thrust
from tests.kits.videoray.cables import cable

CURRENT = np.array([[0.5], [0.2], [0.1]])
SHEARED = {
    "profile_depth": (0.0, 5.0, 20.0, 40.0),
    "profile_velocity": ((0.1, 0.9, 0.2, 0.0), (0.0, 0.7, 0.1, 0.4)),
}


@pytest.mark.parametrize("h", [0.01, 0.2])
def test_a_step_solves_the_linearised_equations_of_a_taut_cable(h):
    one, draw = (
        cable(7, mass_per_length=0.3, tangential_drag=0.05, **SHEARED),
        np.random.default_rng(1),
    )
    way = np.array([[0.4], [0.6], [0.7]]) / np.linalg.norm([0.4, 0.6, 0.7])
    x = 1.05 * one.l0 * np.arange(8) * way + 0.02 * draw.normal(size=(3, 8))
    v = 0.02 * np.arange(8) * way + 0.005 * draw.normal(size=(3, 8))

    def forces(place, motion):
        return one.node_forces(one.forces(place, motion, CURRENT)).ravel()

    assert one.forces(x, v, CURRENT).axial.min() > 100.0  # taut, and so after the step

    def slope(function, start):
        columns = []
        for unit in np.eye(24):
            ends = [function(start + s * unit.reshape(3, 8)) for s in (1e-6, -1e-6)]
            columns.append((ends[0] - ends[1]) / 2e-6)
        return np.array(columns).T

    K, D = slope(lambda at: forces(at, v), x), slope(lambda by: forces(x, by), v)
    F, M = forces(x, v), np.zeros((3, 8, 3, 8))
    for node, mass in enumerate(one.masses(one.forces(x, v, CURRENT)).transpose(2, 0, 1)):
        M[:, node, :, node] = mass
    free = np.arange(24).reshape(3, 8)[:, 1:-1].ravel()
    matrix = M.reshape(24, 24) - h * D - h**2 * K
    gained = np.zeros(24)
    gained[free] = np.linalg.solve(matrix[np.ix_(free, free)], h * (F + h * K @ v.ravel())[free])
    new_v = v + gained.reshape(3, 8)
    moved = implicit_step(one, Chain(6), x, v, CURRENT, h)
    scale = np.abs(gained).max()
    np.testing.assert_allclose(moved.v, new_v, atol=1e-5 * scale)
    np.testing.assert_allclose(moved.x, x + h * new_v, atol=1e-5 * h * scale)
    at_end = (F + h * K @ new_v.ravel() + D @ gained).reshape(3, 8)[:, [0, -1]]
    np.testing.assert_allclose(moved.pull, at_end, atol=1e-5 * np.abs(at_end).max())


class Memory:
    """Values of the thrusters' registers."""

    def __init__(self, **values):
        self.values = values

    def value(self, name):
        return self.values[name]


REGISTERS = {
    "port_target": 0.9, "starboard_target": -1.7, "vertical_target": 0.02, "total_power": 0.8,
    "port_slew_rate": 0.3, "starboard_slew_rate": 0.5, "vertical_slew_rate": 2.0,
    "port_dead_band": 0.1, "starboard_dead_band": 0.2, "vertical_dead_band": 0.15,
    "port_max_limit": 0.9, "starboard_max_limit": 0.7, "vertical_max_limit": 0.95,
}  # fmt: skip


@pytest.mark.parametrize("compensates", [True, False])
@pytest.mark.parametrize(
    ("unit", "loops"), [("per-loop", 1.0), ("per-second", 0.2), ("per-millisecond", 200.0)]
)
def test_duties_follow_target_power_slew_and_dead_band(compensates, unit, loops):
    drive, node, commands = Drive(0.2, unit, compensates), Memory(**REGISTERS), [0.0] * 3
    autos = [0.05, 0.4, -0.06]
    for _ in range(6):
        found = drive.run(node, autos)
        for k, name in enumerate(THRUSTERS):
            target = max(-1.0, min(1.0, REGISTERS[f"{name}_target"])) + autos[k]
            wanted = max(-0.8, min(0.8, target))
            most = REGISTERS[f"{name}_slew_rate"] * loops
            commands[k] += max(-most, min(most, wanted - commands[k]))
            band, limit = REGISTERS[f"{name}_dead_band"], REGISTERS[f"{name}_max_limit"]
            size = abs(commands[k])
            if compensates:
                duty = band + size * (limit - band)
            else:
                duty = limit * size if limit * size >= band else 0.0
            assert found[k] == pytest.approx(math.copysign(duty, commands[k]), abs=1e-12)
    assert drive.stop() == drive.commands == [0.0] * 3


@pytest.mark.parametrize(
    ("duty", "band", "share"),
    [(0.6, 0.2, 0.5), (-0.6, 0.2, -0.5), (0.1, 0.2, 0.0), (1.0, 0.3, 1.0), (0.9, 1.0, 0.0)],
)
def test_a_motor_turns_from_a_duty_of_its_own_on(duty, band, share):
    assert share_of_thrust(duty, band) == pytest.approx(share)
