"""The state that a craft starts from: that of the log then."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from seatrial.system.part import Part
from seatrial.system.system import System
from seatrial.trial.logs.channels import Array
from seatrial.trial.logs.resampling import Trace

_FITTED = 20.0
"""Longest time over which the first velocity is found, s; at most a tenth of the record is."""
_FEWEST = 6
"""Rows of the shortest part."""
_ROUNDING = 1e-9
"""m and rad."""
_PLACES: Mapping[str, tuple[str, ...]] = {
    "north": ("position_start.x", "eta_start.x"),
    "east": ("position_start.y", "eta_start.y"),
    "heading": ("attitude_start.psi", "eta_start.psi"),
    "u": ("velocity_start.u", "nu_start.u"),
    "v": ("velocity_start.v", "nu_start.v"),
    "r": ("rates_start.r", "nu_start.r"),
    "depth": ("position_start.z", "eta_start.z"),
}
"""Parameters of craft that are the state at the start, as they call them."""


def crafts(system: System) -> list[Part]:
    """Return the components that are craft whose state at the start can be set."""
    return [
        part for part in system.parts.values()
        if any(name in part.instance.variables for name in _PLACES["heading"])
        and "attitude.psi" in part.instance.variables
    ]  # fmt: skip


def first_state(motion: Mapping[str, Trace], window: tuple[float, float]) -> dict[str, float]:
    """Return position, heading and velocity at the begin of a window, SI, as far as they are known.

    Velocities are those of a polynomial of degree 2 through the beginning, at most 20 s or a tenth
    of the record, as far as that follows. Those over ground are taken for those through the water.
    """
    first, last = window
    length = min(_FITTED, 0.1 * (last - first))
    found = {what: motion[what] for what in ("north", "east", "heading") if what in motion}
    fits = {what: _fit(each, first, length) for what, each in found.items()}
    state = {what: fit[0] for what, fit in fits.items()}
    if "depth" in motion:
        state["depth"] = float(motion["depth"].at(np.array([first]))[0][0])
    if "heading" in fits:
        state["r"] = fits["heading"][1]
    if fits.keys() == {"north", "east", "heading"}:
        psi, v_n, v_e = state["heading"], fits["north"][1], fits["east"][1]
        state["u"] = v_n * np.cos(psi) + v_e * np.sin(psi)
        state["v"] = v_e * np.cos(psi) - v_n * np.sin(psi)
    elif "speed" in motion:
        state["u"] = float(motion["speed"].at(np.array([first]))[0][0])
    return {what: float(value) for what, value in state.items()}


def _fit(each: Trace, first: float, length: float) -> tuple[float, float]:
    """Return value and slope at ``first``, of the longest part that a polynomial follows.

    That is a part whose residual is not larger than one and a half times the noise.
    """
    elapsed, values = each.time - first, each.values
    inside = (elapsed >= 0.0) & (elapsed <= length)
    elapsed, values = elapsed[inside], values[inside]
    counts: list[int] = []
    while len(elapsed) >> len(counts) >= _FEWEST:
        counts.append(len(elapsed) >> len(counts))
    if not counts:
        return float(each.at(np.array([first]))[0][0]), 0.0
    most = 1.5 * _noise(each.values) + _ROUNDING
    for count in counts:
        fitted = np.polyfit(elapsed[:count], values[:count], 2)
        left = values[:count] - np.polyval(fitted, elapsed[:count])
        if np.sqrt(np.sum(left**2) / (count - 3)) <= most or count == counts[-1]:
            break
    return float(fitted[2]), float(fitted[1])


def _noise(values: Array) -> float:
    """Return the standard deviation of white noise in values, by their second differences."""
    if len(values) < _FEWEST:
        return 0.0
    # Those of white noise have six times its variance; 0.6745 is the median of |x| for N(0, 1).
    return float(np.median(np.abs(np.diff(values, 2))) / (0.6745 * np.sqrt(6.0)))


def settings(craft: Part, state: Mapping[str, float]) -> dict[str, float]:
    """Return the parameters of a craft that are its state at the start, by component.port."""
    found: dict[str, float] = {}
    for what, value in state.items():
        for name in _PLACES[what]:
            if name in craft.instance.variables:
                found[f"{craft.name}.{name}"] = value
    return found
