"""Dynamic positioning of a ship by two azimuths aft and two tunnels forward, from its sensors."""

import math

import numpy as np
import pytest

from seatrial.system.parameters import load_vehicle
from seatrial_kits.fitted.allocation.part_allocation import PartAllocation
from seatrial_kits.ships.control.dynamic_positioning import DynamicPositioning
from seatrial_kits.ships.control.sensed_motion import SensedMotion
from seatrial_kits.ships.hulls.thruster_ship import ThrusterShip
from tests.devices.running import started
from tests.kits.fitted.allocated import OSV, wrench

RATE = math.radians(12.0)
"""Of an azimuth: two turns a minute."""
STEP = 0.5


def ship_under(load):
    ship = ThrusterShip("ship")
    for name, entry in load_vehicle("thruster-ship").file.components["thruster-ship"].items():
        ship.set(name, entry.value)
    ship.set("force_2", load[:2])
    ship.set("moment_2", load[2])
    ship.initialise()
    ship.begin()
    return ship


def sense(ship, sensed):
    """Set what GNSS, compass and gyro measure, without errors."""
    x, y, psi = ship.get("eta")
    u, v, _ = ship.get("velocity")
    c, s = math.cos(psi), math.sin(psi)
    sensed.set("position_n", [x, y, 0.0])
    sensed.set("velocity_n", [c * u - s * v, s * u + c * v, 0.0])
    sensed.set("heading", psi)
    sensed.set("yaw_rate", ship.get("rates")[2])


def held(load, stop):
    """Return x, y, psi and the azimuths' angles every step, under a load from the start."""
    ship, sensed = ship_under(load), started(SensedMotion)
    positioning = started(DynamicPositioning)
    rates = {"propulsor_angle_rate_1": RATE, "propulsor_angle_rate_2": RATE}
    allocation = started(PartAllocation, **OSV, **rates, period=STEP)
    demand = PartAllocation.terminals["demand"].members
    rows = []
    for k in range(round(stop / STEP)):
        rows.append([*ship.get("eta"), *allocation.get("propulsor_angle")[:2]])
        sense(ship, sensed)
        for name in DynamicPositioning.terminals["truth"].members:
            positioning.set(name, sensed.get(name))
        for member, port in DynamicPositioning.terminals["held"].members.items():
            allocation.set(demand[member], positioning.get(port))
        given = wrench(allocation)
        ship.set("force_1", given[:2])
        ship.set("moment_1", given[5])
        for component in (ship, positioning, allocation):
            component.advance(STEP * k, STEP)
    return np.array(rows)


@pytest.mark.parametrize("load", [(5e4, 0.0, 0.0), (-2e4, 5e4, 1e6)])
def test_a_steady_load_leaves_it_at_its_station(load):
    rows = held(load, 220.0)
    eta, turned = np.abs(rows[:, :3]), np.abs(np.diff(rows[:, 3:], axis=0))
    assert eta[:, :2].max() < 2.0
    assert eta[-1, :2].max() < 0.02
    assert eta[-1, 2] < math.radians(0.02)
    assert turned.max() <= RATE * STEP * (1 + 1e-9)
    # The load is met by angles that stay: none spins.
    assert turned[-100:].sum(axis=0).max() < math.radians(2.0)


def test_velocities_are_turned_into_body_axes():
    sensed = started(SensedMotion, velocity_n=[0.0, 2.0, 0.5], heading=math.pi / 2, yaw_rate=0.1)
    assert sensed.get("velocity") == pytest.approx([2.0, 0.0, 0.5])
    assert sensed.get("attitude") == [0.0, 0.0, math.pi / 2]
    assert sensed.get("rates") == [0.0, 0.0, 0.1]
