"""Terms of hydrodynamics beside their equations in NumPy: half in the water, at random poses."""

import itertools
import math

import casadi as ca
import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from seatrial.physics.craft.rov import Rov
from seatrial.physics.craft.terms.context import Context
from seatrial.physics.craft.terms.hydrodynamics import TERMS

from .numerically import numbers, pose

G, RHO = 9.81, 1025.0


class Hull:
    """A hull partly under water, with a random number for every coefficient."""

    def __init__(self, seed):
        draw = self.draw = np.random.default_rng(seed)
        attitude, self.R, self.nu = pose(draw)
        self.size = draw.uniform(0.5, 1.5, 3)
        self.values = {
            "hull_size": self.size,
            "density": RHO,
            "gravity": G,
            "restoring": "floating",
        }
        for name in ("center_of_buoyancy", "center_of_gravity", "drag_center", "lift_center"):
            self.values[name] = 0.2 * draw.normal(size=3)
        origin = np.array([3.0, -2.0, 0.1 * draw.normal()])
        cells = self.values["center_of_buoyancy"] + self.signs * self.size / 4
        self.cells = [(r, origin[2] + (self.R @ r)[2]) for r in cells]
        x = [np.clip(0.5 + 2 * d / self.size[2], 0, 1) for _, d in self.cells]
        self.shares = np.polyval([-2, 3, 0, 0], x)
        self.wet = self.shares.mean()
        self.position, self.attitude = ca.DM(origin), ca.DM(attitude)

    signs = np.array(list(itertools.product((1, -1), repeat=3)))

    def drawn(self, name, *shape):
        """Return coefficients, and give them to the hull."""
        self.values[name] = self.draw.uniform(0.2, 2.0, shape)
        return self.values[name]

    def load(self, term):
        both = numbers(Rov, **self.values)
        nu = ca.DM(self.nu)
        context = Context(self.position, self.attitude, ca.DM(self.R), nu, nu, None, both, both)
        return np.array(ca.DM(TERMS[term](context))).ravel()

    def at(self, place):
        return self.nu[:3] + np.cross(self.nu[3:], place)


def wrench(force, place):
    return np.concatenate([force, np.cross(place, force)])


def restoring(hull):
    mass, buoyancy, entrained = (
        hull.drawn("mass"),
        hull.drawn("buoyancy"),
        hull.drawn("entrained_volume"),
    )
    down, more = hull.R[2], RHO * G * entrained
    lifts = [(buoyancy + more) * s - more for s in hull.shares]
    cells = [wrench(-lift / 8 * down, r) for lift, (r, _) in zip(lifts, hull.cells, strict=True)]
    return wrench(mass * G * down, hull.values["center_of_gravity"]) + sum(cells)


def point_drag(hull):
    drag, spread = hull.drawn("point_drag", 3), hull.drawn("drag_spread", 3)
    places = hull.values["drag_center"] + hull.signs * spread
    flows = [hull.at(r) for r in places]
    forces = [-s / 8 * drag * abs(v) * v for s, v in zip(hull.shares, flows, strict=True)]
    return sum(map(wrench, forces, places))


def wave_making(hull):
    b, length, down = hull.drawn("wave_damping"), hull.drawn("wave_depth"), hull.R[2]
    loads = []
    for share, (r, depth) in zip(hull.shares, hull.cells, strict=True):
        fades = math.exp(-max(depth - hull.size[2] / 4, 0) / length)
        loads.append(wrench(-b / 8 * share * fades * (down @ hull.at(r)) * down, r))
    return sum(loads)


def hull_lift(hull):
    lift, arm, u = hull.drawn("lift", 2), hull.drawn("lift_arm"), hull.nu[0]
    place = hull.values["lift_center"] - [arm * np.sign(u), 0, 0]
    return hull.wet * wrench(-abs(u) * np.array([0, *(lift * hull.at(place)[1:])]), place)


def coupled_damping(hull):
    _, v, w, _, q, r = hull.nu
    (y, z), (n, m) = (hull.drawn(f"coupled_damping_{each}", 2) for each in ("force", "moment"))
    Y, Z = hull.drawn("quadratic_coupled_damping_force", 2)
    N, M = hull.drawn("quadratic_coupled_damping_moment", 2)
    sway, heave = y * r + Y * abs(r) * r, z * q + Z * abs(q) * q
    return hull.wet * np.array([0, sway, heave, 0, m * w + M * abs(w) * w, n * v + N * abs(v) * v])


def damping(hull):
    linear = [hull.drawn(f"linear_damping_{each}", 3) for each in ("force", "moment")]
    square = [hull.drawn(f"quadratic_damping_{each}", 3) for each in ("force", "moment")]
    return -hull.wet * (np.ravel(linear) + np.ravel(square) * abs(hull.nu)) * hull.nu


def morison(hull):
    C, S, v = hull.drawn("drag_coefficient", 9), hull.drawn("projected_area", 3), hull.nu[:3]
    return hull.wet * np.array([*(-RHO / 2 * C.reshape(3, 3) @ (S * abs(v) * v)), 0, 0, 0])


def body_lift(hull):
    S, b, C_D0, e = (hull.drawn(f"body_lift_{n}") for n in ("area", "span", "drag", "efficiency"))
    (u, _, w), ratio = hull.nu[:3], b**2 / S
    alpha = math.atan2(w, u)
    C_L = math.pi * ratio * alpha / (1 + math.sqrt(1 + ratio**2 / 4))
    C_D = C_D0 + C_L**2 / (math.pi * e * ratio)
    flow = (-C_D - 1j * C_L) * np.exp(1j * alpha)  # drag against the flow, lift across it, upwards
    return (
        hull.wet
        * RHO
        / 2
        * (hull.nu[:3] @ hull.nu[:3])
        * S
        * np.array([flow.real, 0, flow.imag, 0, 0, 0])
    )


def winged_body(hull):
    (K_D0, K_D), (K_L0, K_L) = hull.drawn("wing_drag", 2), hull.drawn("wing_lift", 2)
    side, pitch = hull.drawn("wing_side"), hull.drawn("wing_pitch")
    (K_MR, K_M, K_MY), rates = hull.drawn("wing_moment", 3), hull.drawn("wing_damping", 3)
    u, v, w = hull.nu[:3]
    alpha, beta = math.atan2(w, u), math.asin(v / math.hypot(u, v, w))
    # x along the velocity, which turning to alpha about -y and to beta about z brings it to.
    R = Rotation.from_euler("YZ", [-alpha, beta])
    np.testing.assert_allclose(R.apply([math.hypot(u, v, w), 0, 0]), (u, v, w), rtol=1e-9)
    force = [-(K_D0 + K_D * alpha**2), side * beta, -(K_L0 + K_L * alpha)]
    moment = [K_MR * beta, pitch + K_M * alpha, K_MY * beta] + rates * hull.nu[3:]
    return hull.wet * (u * u + v * v + w * w) * np.concatenate([R.apply(force), R.apply(moment)])


def fading_damping(hull):
    d, k = hull.drawn("fading_damping_force", 2), hull.drawn("fading_damping_rate")
    fades = np.exp(-k * np.linalg.norm(hull.nu[:3]))
    return hull.wet * np.array([*(-d * fades * hull.nu[:2]), 0, 0, 0, 0])


def crossflow_drag(hull):
    L, T, C = (hull.drawn(f"crossflow_{each}") for each in ("length", "draught", "coefficient"))
    x, dx = L * (np.arange(20) - 9.5) / 20, L / 20
    drag = (
        -0.5 * RHO * T * C * abs(hull.nu[1] + x * hull.nu[5]) * (hull.nu[1] + x * hull.nu[5]) * dx
    )
    return np.array([0, drag.sum(), 0, 0, 0, x @ drag])


KNOWN = (
    *(restoring, damping, coupled_damping, morison, crossflow_drag, point_drag, hull_lift),
    *(body_lift, winged_body, fading_damping, wave_making),
)


@pytest.mark.parametrize("seed", range(3))
@pytest.mark.parametrize("known", KNOWN, ids=lambda known: known.__name__)
def test_a_term_is_its_equation(known, seed):
    hull = Hull(seed)
    expected = known(hull)
    assert 0.1 < hull.wet < 0.9
    found = hull.load(known.__name__.replace("_", "-"))
    np.testing.assert_allclose(found, expected, rtol=1e-9, atol=1e-9)
