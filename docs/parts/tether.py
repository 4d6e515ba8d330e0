"""The tether: how exact its shapes and its steps are."""

from __future__ import annotations

import itertools
import math
from collections.abc import Sequence
from functools import partial
from typing import Any

import numpy as np
from scipy.integrate import solve_ivp

from parts import part
from parts.markdown import table
from parts.settings import parameters
from parts.ships import verdicts
from seatrial.model.units import quantity
from seatrial.system.parameters import load_vehicle
from seatrial_kits.videoray.cable.cable import Cable
from seatrial_kits.videoray.cable.cable_shape import hanging_shape, static_shape
from seatrial_kits.videoray.cable.cable_solver import Chain, implicit_step
from seatrial_kits.videoray.cable.tether import Tether

part("tether-parameters")(partial(parameters, "tether"))
part("tether-trials")(partial(verdicts, "tether"))

_STREAM = np.array([[0.5], [0.0], [0.0]])
_START = np.array([34.0, 0.0, 17.0])


def _cable(segments: int, **changes: float) -> Cable:
    """Return the shipped tether."""
    names = ("length", "diameter", "mass_per_length", "axial_stiffness", "damping_ratio")
    more = ("normal_drag", "tangential_drag", "added_mass", "density", "gravity")
    entries = load_vehicle("tether").parameter_set("tether", None).values
    values: dict[str, Any] = {}
    for name in (*names, *more):
        value, unit = entries[name].value, entries[name].unit
        values[name] = quantity(f"{value} {unit}" if unit != "1" else value, _unit(name))
    return Cable(segments=segments, **values | changes)


def _unit(name: str) -> str:
    unit = Tether.ports[name].unit
    assert isinstance(unit, str)
    return unit


def _orders(errors: Sequence[float]) -> list[str]:
    pairs = itertools.pairwise(errors)
    return ["", *(f"{math.log2(before / after):.2f}" for before, after in pairs)]


def _arc(segments: int, cable: Cable) -> Any:
    pull = math.hypot(3.0, 10.0)
    b = 0.5 * cable.density * cable.diameter * cable.normal_drag * 0.5**2 / pull
    sigma = np.linspace(cable.length, 0.0, segments + 1) * (1.0 + pull / cable.axial_stiffness)
    x, z = np.sqrt(1.0 + (0.3 + b * sigma) ** 2) / b, np.arcsinh(0.3 + b * sigma) / b
    return np.array([x[0] - x, np.zeros_like(x), z[0] - z])


def _catenary(segments: int, cable: Cable) -> Any:
    s, H, V, w = np.linspace(0.0, cable.length, segments + 1), 2.0, -3.0, 0.25
    x = H * s / cable.axial_stiffness + H / w * (np.arcsinh((V + w * s) / H) - np.arcsinh(V / H))
    up = (V * s + w * s**2 / 2) / cable.axial_stiffness
    up += H / w * (np.sqrt(1 + ((V + w * s) / H) ** 2) - np.sqrt(1 + (V / H) ** 2))
    return np.array([x, np.zeros_like(x), -up])


@part("tether-static")
def static() -> str:
    """Errors of shapes at rest against closed forms."""
    counts, top = (5, 10, 20, 40, 80), np.zeros(3)
    arcs, catenaries = [], []
    for n in counts:
        cable = _cable(n, tangential_drag=0.0)
        found = hanging_shape(cable, top, np.array([3.0, 0.0, 10.0]), _STREAM)
        arcs.append(float(np.abs(found - _arc(n, cable)).max()))
        heavy = _cable(n, mass_per_length=cable.density * cable.area + 0.25 / cable.gravity)
        exact = _catenary(n, heavy)
        found = static_shape(heavy, top, exact[:, -1], np.zeros_like(exact), np.zeros((3, 1)))
        catenaries.append(float(np.abs(found - exact).max()))
    columns = zip(counts, arcs, _orders(arcs), catenaries, _orders(catenaries), strict=True)
    return table(
        ("segments", "arc in a current, mm", "order", "elastic catenary, mm", "order"),
        [(str(n), f"{a * 1e3:.3g}", p, f"{c * 1e3:.3g}", q) for n, a, p, c, q in columns],
    )


def _end(t: float) -> tuple[Any, Any]:
    way = np.array([0.24, 0.2, -0.25])
    return _START + way * (1.0 - math.cos(2.0 * t)), 2.0 * way * math.sin(2.0 * t)


@part("tether-dynamic")
def dynamic() -> str:
    """Error of the implicit step on a sway of the vehicle's end, against Radau's method."""
    cable, times = _cable(10), 0.1 * np.arange(1, 31)
    inner = 3 * (cable.segments - 1)
    rest = static_shape(cable, np.zeros(3), _START, np.zeros((3, 11)), _STREAM)

    def nodes(t: float, y: Any) -> tuple[Any, Any]:
        x, v = rest.copy(), np.zeros_like(rest)
        x[:, 1:-1], v[:, 1:-1] = y[:inner].reshape(3, -1), y[inner:].reshape(3, -1)
        x[:, -1], v[:, -1] = _end(t)
        return x, v

    def slope(t: float, y: Any) -> Any:
        forces = cable.forces(*nodes(t, y), _STREAM)
        return np.concatenate((y[inner:], cable.accelerations(forces)[:, 1:-1].ravel()))

    begin = np.concatenate((rest[:, 1:-1].ravel(), np.zeros(inner)))
    solved = solve_ivp(slope, (0.0, 3.0), begin, "Radau", t_eval=times, rtol=1e-8, atol=1e-9)
    exact = np.array([nodes(t, y)[0] for t, y in zip(times, solved.y.T, strict=True)])
    steps, errors = (0.02, 0.01, 0.005, 0.0025), []
    for h in steps:
        chain, x, v, found = Chain(cable.segments - 1), rest, np.zeros_like(rest), []
        for k in range(round(3.0 / h)):
            v[:, -1] = (_end((k + 1) * h)[0] - x[:, -1]) / h
            x, v, _ = implicit_step(cable, chain, x, v, _STREAM, h)
            if (k + 1) % round(0.1 / h) == 0:
                found.append(x)
        errors.append(float(np.abs(np.array(found) - exact).max()))
    return table(
        ("step, ms", "greatest error of a node, mm", "order"),
        [
            (f"{h * 1e3:g}", f"{e * 1e3:.2g}", p)
            for h, e, p in zip(steps, errors, _orders(errors), strict=True)
        ],
    )
