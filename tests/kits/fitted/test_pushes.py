"""All that a propulsor says, at random flows, beside momentum theory in NumPy."""

import math
from types import SimpleNamespace

import casadi as ca
import numpy as np
import pytest

from seatrial_kits.fitted.parts.thrust import Drive, azimuth, jet, thruster, tunnel

RHO = 1019.0
CONTEXT = SimpleNamespace(parameters=SimpleNamespace(density=RHO))
KINDS = {"thruster": thruster, "azimuth": azimuth, "tunnel": tunnel, "jet": jet}


def number(x):
    return np.array(ca.DM(x)).squeeze()


@pytest.mark.parametrize("order", [0.7, -0.4])
@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("seed", range(2))
def test_force_rate_power_and_loading(kind, order, seed):
    draw = np.random.default_rng(seed)
    flow, place, direction = draw.normal(size=(3, 3))
    direction /= np.linalg.norm(direction)
    D, exponent, ahead, astern = 0.35, 1.6, 900.0, 500.0
    slot = SimpleNamespace(
        diameter=D, exponent=exponent, thrust=ca.DM([ahead, astern]), deduction=0.13, wake=0.21,
        fading_speed=2.2, position=ca.DM(place), speed=ca.DM([150.0, 90.0]),
    )  # fmt: skip
    push = KINDS[kind](CONTEXT, Drive(slot, ca.DM(order), ca.DM(direction), ca.DM(flow)))
    way, size = math.copysign(1, order), abs(order) ** exponent
    area, advance = math.pi / 4 * D**2, (1 - 0.21) * direction @ flow
    if kind == "jet":
        V = math.sqrt(size * ahead / (RHO * area))
        kept = 1.0 if order > 0 else -astern / ahead
        force = RHO * area * V * (kept * V * direction - flow)
        along, before = direction @ force, direction @ force
        power = RHO * area * V / 2 * max(V**2 - flow @ flow, 0)
    else:
        T0 = way * size * (ahead if order > 0 else astern)
        into = max(way * direction @ flow, 0)
        lost = {"thruster": 0, "azimuth": flow @ flow - into**2, "tunnel": flow[0] ** 2}[kind]
        before = T0 * max(0, 1 - lost / 2.2**2)
        along = (1 - 0.13) * before
        force = along * direction
        u = way * advance / 2
        power = abs(T0) * (u + math.sqrt(u**2 + abs(T0) / (2 * RHO * area)))
    rate = way * abs(order) ** (exponent / 2) * (150.0 if order > 0 else 90.0)
    np.testing.assert_allclose(number(push.load), [*force, *np.cross(place, force)], rtol=1e-9)
    found = [number(x) for x in (push.force, push.rate, push.power, push.loading, push.advance)]
    np.testing.assert_allclose(found, [along, rate, power, before / D**2, advance], rtol=1e-9)
