"""What surrounds a craft at a random pose, and Newton's and Kirchhoff's equations in it."""

from types import SimpleNamespace

import casadi as ca
import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from seatrial.physics.craft.around import Around, Places
from seatrial.physics.craft.marine_craft import MarineCraft
from seatrial.physics.craft.rov import Rov
from seatrial.physics.craft.seaway import PORTS
from seatrial.physics.craft.six_dof import six_dof_motion
from seatrial.physics.sea.wind_loads import Areas

from .numerically import numbers, pose

T, STATE = 7.0, np.array([30.0, -20.0, 4.0, 0.3, -0.2, 2.1, 1.5, -0.7, 0.2, 0.1, 0.3, -0.4])
IN_SPACE = Places(x=0, y=1, z=2, psi=5, u=6, v=7)
SEA, MOVES = np.arange(1.0, 7.0), np.array([0.5, -0.3, 0.2, 0.07, 0.11, -0.13])
STREAM, RATE, SHEAR = np.array([0.4, -0.9]), np.array([0.03, 0.05]), np.array([-0.02, 0.06])
AREAS = Areas(3.0, 8.0, 0.7, 1.3, 0.75, 0.9)


class Given:
    """Says what it is told to, and what it was asked."""

    def __init__(self, answer):
        self.answer, self.asked = answer, []

    def at(self, *asked):
        self.asked.append(asked)
        return self.answer

    velocity = at


def around(places=IN_SPACE, loads=None, orbital=None, current=None, wind=None):
    found = Around(places, loads, orbital, current, wind).at(T, STATE)
    ends = np.cumsum([port.size for port in PORTS])
    return dict(zip([port.name for port in PORTS], np.split(found, ends[:-1]), strict=True))


def assert_are(found, **expected):
    """Compare those that are named; the others are 0."""
    for name, value in found.items():
        np.testing.assert_allclose(value, expected.get(name, 0.0), atol=1e-12, err_msg=name)


def test_each_effect_is_asked_at_the_craft_and_stands_at_its_place():
    loads, orbital = Given(SEA), Given((0.6, MOVES))
    assert_are(around(loads=loads), wave_load=SEA)
    assert loads.asked == [(T, 30.0, -20.0, 2.1)]
    met = {"water_elevation": 0.6, "water_velocity": MOVES[:3], "water_acceleration": MOVES[3:]}
    assert_are(around(orbital=orbital), **met)
    assert orbital.asked == [(T, 30.0, -20.0, 4.0)]


@pytest.mark.parametrize(("z", "depth"), [(2, 4.0), (None, 0.0)])
def test_a_current_comes_on_top_of_the_waves(z, depth):
    current = Given((STREAM, RATE, SHEAR))
    found = around(IN_SPACE._replace(z=z), orbital=Given((0.6, MOVES)), current=current)
    assert current.asked == [(T, depth)]
    met = {"water_elevation": 0.6, "water_shear": SHEAR}
    met["water_velocity"] = [*(MOVES[:2] + STREAM), MOVES[2]]
    met["water_acceleration"] = [*(MOVES[3:5] + RATE), MOVES[5]]
    assert_are(found, **met)


def test_wind_is_met_in_body_axes():
    wind, height = Given(np.array([6.0, -2.0])), 1.3
    found = around(wind=(wind, AREAS, height))
    assert wind.asked == [(T, height)]
    turned = Rotation.from_euler("Z", 2.1).as_matrix()[:2, :2].T @ wind.answer
    X, Y, K, N = AREAS.loads(1.5 - turned[0], -0.7 - turned[1])
    assert_are(found, wind_load=[X, Y, 0, K, 0, N])
    assert min(map(abs, (X, Y, K, N))) > 1.0


def test_a_craft_in_the_plane_has_its_state_elsewhere():
    loads = Given(SEA)
    around(Places(x=3, y=1, z=None, psi=7, u=2, v=0), loads=loads)
    assert loads.asked == [(T, 0.3, -20.0, -0.7)]


# ------------------------------------------------------------------ equations of motion


class Body:
    """A body of random inertia at a random pose, in water that moves and is sheared."""

    def __init__(self, seed, kind):
        draw = np.random.default_rng(seed)
        self.attitude, self.R, self.nu = pose(draw)
        self.position = draw.normal(size=3)
        self.kind = kind
        half = draw.normal(size=(3, 3))
        self.inertia = half @ half.T + 2 * np.eye(3)
        half = 0.3 * draw.normal(size=(6, 6))
        self.added = half @ half.T + np.eye(6)
        names = ("center_of_gravity", "center_of_buoyancy", "attachment_place", "flow_place")
        self.values = {name: 0.2 * draw.normal(size=3) for name in names}
        self.values |= {"mass": 3.0, "buoyancy": 35.0, "gravity": 9.7, "density": 1025.0}
        self.values |= {"restoring": "submerged", "terms": "restoring coriolis"}
        self.values["inertia"] = self._tensor(self.inertia, -1)
        self.values["added_mass"] = self._tensor(self.added[:3, :3], 1)
        self.values["added_inertia"] = self._tensor(self.added[3:, 3:], 1)
        self.values["added_coupling"] = self.added[:3, 3:].ravel()
        names = ("current", "attachment_force", "force_1", "force_3", "moment_2", "moment_4")
        self.inputs = {name: draw.normal(size=3) for name in names}
        self.water, self.water_rate, self.shear = draw.normal(size=(3, 3))
        self.accelerated, self.parts = draw.normal(size=3), draw.normal(size=6)

    @staticmethod
    def _tensor(m, sign):
        return [*np.diag(m), *(sign * m[[0, 0, 1], [1, 2, 2]])]

    def moved(self, at_sea):
        given = numbers(self.kind, **self.values, **self.inputs)
        u = vars(numbers(self.kind, **self.inputs))
        if at_sea:
            u |= {"water_velocity": self.water, "water_acceleration": self.water_rate}
            u |= {"water_shear": self.shear[:2]}
        given = SimpleNamespace(**(vars(given) | {"buoyancy": self.values["buoyancy"]}))
        changes, outputs = six_dof_motion(
            *map(ca.DM, (self.position, self.attitude, self.nu)),
            SimpleNamespace(**{n: v if isinstance(v, str) else ca.DM(v) for n, v in u.items()}),
            given, self.accelerated, parts=self.parts,
        )  # fmt: skip
        found = {**vars(changes), **outputs}
        return {name: np.array(value).ravel() for name, value in found.items()}


def wrench(force, place):
    return np.concatenate([force, np.cross(place, force)])


@pytest.mark.parametrize("kind", [MarineCraft, Rov])
@pytest.mark.parametrize("at_sea", [False, True])
@pytest.mark.parametrize("seed", range(2))
def test_momentum_changes_as_the_forces_say(kind, at_sea, seed):
    body = Body(seed, kind)
    found, v, w, down = body.moved(at_sea), body.nu[:3], body.nu[3:], body.R[2]
    named = SimpleNamespace(**body.values, **body.inputs)
    turned = body.R.T
    stream = named.current + (body.water if at_sea else 0)
    shears = np.array([*body.shear[:2], 0]) * (down @ v)
    met = body.water_rate + shears if at_sea else np.zeros(3)
    # Momentum of body and water by the velocity through it: Kirchhoff.
    arm = named.center_of_gravity
    nu_r = np.concatenate([v - turned @ stream, w])
    own = np.zeros((6, 6))
    for i, unit in enumerate(np.eye(6)):
        velocity, rates = unit[:3], unit[3:]
        momentum = named.mass * (velocity + np.cross(rates, arm))
        own[:, i] = wrench(momentum, arm)
        own[3:, i] += body.inertia @ rates
    M = own + body.added
    h = M @ nu_r
    gyroscopic = [*np.cross(w, h[:3]), *(np.cross(w, h[3:]) + np.cross(nu_r[:3], h[:3]))]
    pull = turned @ named.attachment_force
    load = body.parts + wrench(pull, named.attachment_place)
    load += [*(named.force_1 + named.force_3), *(named.moment_2 + named.moment_4)]
    load += wrench(named.mass * named.gravity * down, arm)
    load -= wrench(named.buoyancy * down, named.center_of_buoyancy)
    if at_sea:
        displaced = named.buoyancy / named.gravity
        load += wrench(displaced * turned @ body.water_rate, named.center_of_buoyancy)
        load -= wrench(named.mass * turned @ met, arm)
    below = down @ named.flow_place * at_sea
    sheared = turned @ [*(body.shear[:2] * below), 0]
    nu_r_dot = np.linalg.solve(M, load - gyroscopic)
    # v = v_r + R^T v_c, whose rate of change in {n} is R (v' + w x v).
    inertial = nu_r_dot[:3] + np.cross(w, nu_r[:3]) + turned @ (met + body.accelerated)
    expected = {
        "velocity": inertial - np.cross(w, v),
        "rates": nu_r_dot[3:],
        "acceleration": inertial,
        "position": body.R @ v,
        "attachment_point": body.position + body.R @ named.attachment_place,
        "attachment_velocity": body.R @ (v + np.cross(w, named.attachment_place)),
        "nu_r": nu_r,
        "flow": nu_r[:3] + np.cross(w, named.flow_place) - sheared,
    }
    for name, value in expected.items():
        np.testing.assert_allclose(found[name], value, rtol=1e-9, atol=1e-9, err_msg=name)
    h, euler = 1e-6, body.attitude
    later = Rotation.from_euler("ZYX", (euler + h * found["attitude"])[::-1]).as_matrix()
    turning = (later - body.R) / h
    np.testing.assert_allclose(turning, body.R @ skew(w), atol=1e-4)


def skew(a):
    return np.cross(np.eye(3), a).T @ -np.eye(3)
