"""The VideoRay that can be driven: reference trajectories, eigenvalues, closed forms, invariance."""

from __future__ import annotations

import csv
import itertools
import math
import tomllib
from functools import cache
from pathlib import Path
from types import SimpleNamespace

import casadi as ca
import numpy as np
import pytest
from scipy.optimize import brentq

from seatrial.control.depth_hold import DepthHold
from seatrial.control.heading_hold import HeadingHold
from seatrial.model.units import quantity
from seatrial.physics.craft.kinematics import rotation_rows
from seatrial.physics.craft.rov import Rov
from seatrial.physics.craft.terms.context import Context
from seatrial.physics.craft.terms.slender import hull_lift
from seatrial.shipped import available
from seatrial.system.parameters import load_vehicle
from seatrial_kits.videoray.vessel.thruster_allocation import ThrusterAllocation
from tests.devices.running import started

PILOT_FILE = available("vehicles")["videoray"].with_name("pilot.toml")
DATA = Path(__file__).parents[2] / "reference"
STATES = ("x", "y", "z", "phi", "theta", "psi", "u", "v", "w", "p", "q", "r")
FULL = np.array([46.7, 46.7, 25.0])
LAG, DELAY = 0.15, 0.1


@cache
def shipped():
    values = load_vehicle("videoray").parameter_set("rov", "drivable").values
    return {name: entry.value for name, entry in values.items()}


def videoray(**values):
    """Return the vehicle at rest, 5 m deep."""
    component = Rov("vehicle")
    for name, value in shipped().items():
        component.set(name, value)
    for name, value in {"eta_start": (0, 0, 5, 0, 0, 0), **values}.items():
        component.set(name, value)
    return component


def thrusts(values):
    return [*values, 0, 0, 0, 0, 0]


def driven(component, commands, stop, step=0.005):
    """Yield the state each 0.1 s; ``commands`` are held from multiples of 0.1 s.

    The lag is exact at the middle of each step, at which the thrust is held.
    """
    component.set("max_step", step)
    component.initialise()
    component.begin()
    thrust, pending = np.zeros(3), np.zeros(3)
    count = round(0.1 / step)
    for k in range(round(stop / 0.1) + 1):
        state = np.array(component.get("eta") + component.get("nu"))
        yield 0.1 * k, state
        goal, pending = pending, FULL * np.clip(commands(0.1 * k, state), -1, 1)
        for n in range(count):
            # Of two half steps of Runge-Kutta with the thrust held, the error is of second order.
            middle = goal + (thrust - goal) * math.exp(-step / 2 / LAG)
            component.set("thrust", thrusts(middle))
            component.advance(0.1 * k + n * step, step)
            thrust = goal + (thrust - goal) * math.exp(-step / LAG)


def from_one_second(*shares):
    return lambda t, _: shares if t > 0.95 else (0, 0, 0)


PILOT = {
    "heading_hold": HeadingHold,
    "depth_hold": DepthHold,
    "allocation": ThrusterAllocation,
}


def piloting(name, kind):
    """Return a component of the shipped pilot, with its values there."""
    pilot = tomllib.loads(PILOT_FILE.read_text())
    given = pilot["components"][name]["set"].items()
    return started(kind, **{key: quantity(text, kind.ports[key].unit) for key, text in given})


def held():
    """Return commands of the shipped holds: ahead from 2 s on, a turn of 45 degrees at 12 s."""
    heading, depth, allocation = (piloting(*each) for each in PILOT.items())
    depth.set("depth_wanted", 5.0)

    def commands(t, state):
        share = min(max(t - 2, 0), 1)
        heading.set("heading_wanted", math.radians(45) if t > 11.95 else 0.0)
        heading.set("heading", state[5])
        depth.set("depth", state[2])
        for hold in (heading, depth):
            hold.set("surge", 93.4 * share)
        allocation.set("surge", 93.4 * share)
        allocation.set("yaw_moment", heading.get("yaw_moment"))
        allocation.set("heave", depth.get("heave"))
        for hold in (heading, depth):
            hold.advance(t, 0.1)
        return [allocation.get(name) for name in ("port", "starboard", "vertical")]

    return commands


@pytest.mark.slow
@pytest.mark.parametrize(
    ("name", "commands", "stop", "depth", "tolerance"),
    [
        ("full_ahead", from_one_second(1, 1, 0), 15, 5, 1e-5),
        ("half_turn", from_one_second(0.7, 0.3, 0), 20, 5, 1e-5),
        ("surfacing", from_one_second(0, 0, -1), 10, 3, 1e-4),
        ("heading_hold", held(), 25, 5, 1e-4),
    ],
)
def test_reference_trajectories_are_met(name, commands, stop, depth, tolerance):
    with (DATA / f"videoray_drive_{name}.csv").open() as file:
        rows = [[float(row[s]) for s in STATES] for row in csv.DictReader(file)]
    heading = float(rows[0][5])
    component = videoray(eta_start=(0, 0, depth, 0, 0, heading))
    found = np.array([state for _, state in driven(component, commands, stop, 0.002)])
    allowed = np.array([tolerance] * 9 + [10 * tolerance] * 3)
    assert (np.abs(found - rows) < allowed).all(), np.abs(found - rows).max(axis=0)


# ---------------------------------------------------------------------- closed forms


def test_full_thrust_gives_the_makers_speed():
    """d1 u + d2 u^2 = 2 (T - kappa T0 u) at full thrust."""
    speed = brentq(lambda u: drag(u) - 2 * 46.7 * (1 - 0.178 * u), 1, 3)
    assert speed == pytest.approx(2.16, abs=0.005)
    end = videoray(thrust=thrusts(FULL * (1, 1, 0))).reference([0.0, 15.0]).x[-1]
    assert end[6] == pytest.approx(speed, abs=0.005)


@pytest.mark.parametrize(
    ("axis", "linear", "quadratic"), [(0, 0.95, 11.9), (1, 5.87, 30.73), (2, 3.70, 26.36)]
)
def test_translation_has_the_published_drag(axis, linear, quadratic):
    nothing = {"drag_center": 0.0, "lift": 0.0, "ring_drag": 0.0, "volume": 6.5e-3}
    component = videoray(**nothing, center_of_buoyancy=0.0, added_coupling=0.0)
    mass = 6.5 + (1.94, 6.05, 3.95)[axis]
    x = np.array([0, 0, 5.0, 0, 0, 0, 0, 0, 0, 0, 0, 0])
    x[6 + axis] = 0.7
    found = component.derivatives(x)[6 + axis]
    assert found == pytest.approx(-(linear * 0.7 + quadratic * 0.49) / mass, rel=1e-12)


def test_it_floats_where_its_volume_says():
    """Archimedes, with the shares of the cells: sum (V + V_e) (1 - s) / 8 = V - m / rho."""

    def left(z):
        share = [np.clip(0.5 + (z - 0.02 + side * 0.223 / 4) / 0.1115, 0, 1) for side in (1, -1)]
        out = [1 - s * s * (3 - 2 * s) for s in share]
        return 10.533e-3 * sum(out) / 2 - (6.533e-3 - 6.5e-3)

    level = brentq(left, 0.0, 0.3)
    assert level == pytest.approx(0.1263, abs=1e-3)
    end = videoray(eta_start=(0, 0, 0.2, 0, 0, 0)).reference([0.0, 60.0]).x[-1]
    assert end[2] == pytest.approx(level, abs=1e-4)
    assert np.abs(end[3:]).max() < 1e-4


def test_the_surface_changes_nothing_at_depth():
    deep = videoray()
    states = np.random.default_rng(3).standard_normal((20, 12))
    for x in states:
        x[:6] *= 0.1
        x[2] = 5.0
        found = deep.derivatives(x)
        assert found == pytest.approx(
            videoray(restoring="submerged", wave_damping=0.0).derivatives(x), rel=1e-9, abs=1e-12
        )


def test_hull_lift_has_its_derivatives():
    """By speed ahead: Y_v = -a_y, Y_r = N_v = a_y l, N_r = -a_y l^2; l from the CG to the stern."""
    arm = 0.150 + 0.012
    places = {"lift_center": ca.DM([-0.012, 0, -0.018]), "lift_arm": 0.150}
    p = SimpleNamespace(**places, lift=ca.DM([16.1, 10.5]), restoring="submerged")
    nu = ca.SX.sym("nu", 6)
    level = ca.DM.eye(3), nu, nu, ca.DM.eye(6)
    context = Context(ca.DM([0, 0, 5]), ca.DM.zeros(3), *level, SimpleNamespace(), p)
    slopes = ca.Function("slopes", [nu], [ca.jacobian(hull_lift(context), nu)])
    D = np.array(slopes([1, 0, 0, 0, 0, 0]))
    assert D[1, 1] == pytest.approx(-16.1)
    assert D[1, 5] == pytest.approx(16.1 * arm)
    assert D[5, 1] == pytest.approx(16.1 * arm)
    assert D[5, 5] == pytest.approx(-16.1 * arm**2)


def drag(speed):
    return 0.95 * speed + 11.9 * speed**2


# Of pitch and heave, of sway, roll and yaw, about straight level motion.
EIGENVALUES = {
    0.0: ([-0.12 + 3.21j, -0.35], [-0.14 + 3.47j, -0.17, -0.47]),
    0.3: ([-0.72 + 3.16j, -0.78], [-0.20 + 3.47j, -0.74, -1.99]),
    0.6: ([-1.14, -1.35 + 3.07j], [-0.26 + 3.46j, -1.08, -3.71]),
    1.0: ([-1.37, -2.32 + 2.91j], [-0.35 + 3.46j, -1.53, -6.02]),
    1.5: ([-1.21, -3.75 + 2.83j], [-0.45 + 3.44j, -2.10, -8.90]),
    2.2: ([-0.86, -5.82 + 3.07j], [-0.58 + 3.42j, -2.90, -12.9]),
    -1.2: ([-0.98 + 2.25j, -2.67], [0.17, -0.16 + 3.48j, -6.24]),
}


@pytest.mark.parametrize("speed", EIGENVALUES)
def test_eigenvalues_of_level_motion(speed):
    root = brentq(lambda r: 2 * 46.7 * (r**2 - 0.178 * abs(speed) * r) - drag(abs(speed)), 0, 2)
    thrust = 46.7 * root**2 if speed > 0 else 0.0  # astern the table is without thrust
    component = videoray(thrust=thrusts((thrust, thrust, 0)))
    x = np.array([0, 0, 5.0, 0, 0, 0, speed, 0, 0, 0, 0, 0])
    A = component.linearise(x).A
    for states, known in zip(((4, 8, 10), (3, 7, 9, 11)), EIGENVALUES[speed], strict=True):
        found = sorted(np.linalg.eigvals(A[np.ix_(states, states)]), key=lambda v: (v.real, v.imag))
        expected = [*known, *(v.conjugate() for v in known if isinstance(v, complex))]
        expected.sort(key=lambda v: (complex(v).real, complex(v).imag))
        assert np.abs(np.subtract(found, expected)).max() < 0.01 * max(1, np.abs(expected).max())


def test_drag_lift_and_waves_only_take_energy():
    """Their power along the motion is never positive, deep or at the surface."""
    losing = "damping point-drag hull-lift wave-making"
    generator = np.random.default_rng(5)
    mass = videoray().mass_matrix()
    for _ in range(60):
        x = np.concatenate([0.5 * generator.standard_normal(6), generator.standard_normal(6)])
        powers = []
        for terms in ("restoring", f"restoring {losing}"):
            found = videoray(terms=terms).derivatives(x)
            powers.append(x[6:] @ mass @ found[6:])
        assert powers[1] - powers[0] <= 1e-9


def test_a_current_only_carries_it_along():
    """Galilean invariance, deep."""
    current = np.array([0.4, -0.3, 0.1])
    start = np.array([0, 0, 5.0, 0.1, -0.1, 0.3, 1.0, 0.2, -0.1, 0.1, 0.2, -0.1])
    runs = []
    for water in (np.zeros(3), current):
        component = videoray(current=tuple(water), thrust=tuple(thrusts((20, 10, 5))))
        R = np.array(rotation_rows(np.sin(start[3:6]), np.cos(start[3:6])))
        component.set("eta_start", tuple(start[:6]))
        component.set("nu_start", (*(start[6:9] + R.T @ water), *start[9:]))
        runs.append(component.reference([0.0, 5.0]).x[-1])
    still, carried = runs
    assert carried[:3] - 5.0 * current == pytest.approx(still[:3], abs=1e-7)
    assert carried[3:6] == pytest.approx(still[3:6], abs=1e-7)


def at_once(shares, stop, depth):
    """Return the states of a run with thrusts that are there from the start."""
    start = (0, 0, depth, 0.01, 0.01, 0.01)
    component = videoray(eta_start=start, thrust=thrusts(FULL * shares), max_step=0.01)
    component.initialise()
    component.begin()
    states = []
    for k in range(round(stop / 0.1)):
        component.advance(0.1 * k, 0.1)
        states.append(component.get("eta") + component.get("nu"))
    return np.array(states)


@pytest.mark.parametrize("shares", list(itertools.product((-1, 0, 1), repeat=3)))
def test_no_command_makes_it_somersault(shares):
    states = at_once(shares, 10, 10)
    roll, pitch = np.degrees(np.abs(states[:, 3:5]).max(axis=0))
    assert pitch < 45
    assert roll < 30


@pytest.mark.parametrize("shares", [(0, 0, -1), (1, 1, -1)])
def test_full_up_breaks_the_surface_and_floats(shares):
    """It comes up by 15 cm at most, also under way, and then stays at the surface."""
    states = at_once(shares, 25, 5)
    assert states[:, 2].min() > 0.1263 - 0.15
    assert 0.0 < states[-1, 2] < 0.13
