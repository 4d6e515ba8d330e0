"""Parameters of parts of a body that the craft alone reads: coefficients of their loads."""

from __future__ import annotations

from collections.abc import Mapping
from functools import partial
from types import SimpleNamespace
from typing import Any, NamedTuple

from .slots import BallastSlots, Each, FoilSlots, PropulsorSlots

SORTS = ("propulsor", "foil", "ballast")
"""Of parts."""
ORDER = 4
"""Highest harmonic of the four-quadrant series."""
_HARMONICS = (
    *(f"a{k}" for k in range(ORDER + 1)),
    *(f"b{k}" for k in range(1, ORDER + 1)),
)

_p = partial(Each, "propulsor")
_f = partial(Each, "foil")


class PropulsorCoefficients(PropulsorSlots):
    """Mix-in: open-water characteristics; see `screws`."""

    propulsor_K_T = _p(
        0.0, "1", "thrust: K_T = k0 + k1 J + k2 J^2 (propeller)", axes=("k0", "k1", "k2")
    )
    propulsor_K_Q = _p(
        0.0, "1", "moment: K_Q = k0 + k1 J + k2 J^2 (propeller)", axes=("k0", "k1", "k2")
    )
    propulsor_advance_limit = _p(
        1.6, "1", "J from which on the coefficients are held (propeller, wageningen-b)", min=0.0
    )
    propulsor_blades = _p(4.0, "1", "number of blades, 2 to 7 (wageningen-b)")
    propulsor_pitch_ratio = _p(1.0, "1", "P/D, 0.5 to 1.4 (wageningen-b)")
    propulsor_area_ratio = _p(0.7, "1", "A_E/A_O, 0.3 to 1.05 (wageningen-b)")
    propulsor_C_T = _p(
        0.0, "1", "thrust: series of C_T* in beta, cosines a, sines b (four-quadrant)",
        axes=_HARMONICS,
    )  # fmt: skip
    propulsor_C_Q = _p(
        0.0, "1", "moment: series of C_Q* in beta, cosines a, sines b (four-quadrant)",
        axes=_HARMONICS,
    )  # fmt: skip


class FoilCoefficients(FoilSlots):
    """Mix-in: coefficients of lift and drag; see `fins`, `rudder` and `sail`."""

    foil_profile_drag = _f(0.0065, "1", "drag coefficient at no lift (fin)", min=0.0)
    foil_crossflow_drag = _f(0.8, "1", "coefficient of the flow round the tip (fin)", min=0.0)
    foil_stall = _f(0.4, "rad", "angle of attack from which on it stalls (fin)", min=1e-3)
    foil_behind = _f(0.0, "1", "number of the propulsor in whose race it is, 0 for none (rudder)")
    foil_covered = _f(1.0, "1", "eta: share of the span in the race (rudder)", min=0.0, max=1.0)
    foil_race_gain = _f(0.5, "1", "kappa: gain of the race's speed (rudder)", min=0.0)
    foil_wake_ratio = _f(
        1.0, "1", "eps: share of water that follows, beside the propulsor's (rudder)", min=0.0
    )
    foil_straightening = _f(
        1.0, "1", "gamma_R: straightening of the flow, by the sign of the drift (rudder)",
        axes=("positive", "negative"), min=0.0,
    )  # fmt: skip
    foil_flow_aft = _f(0.0, "m", "place whose drift acts, aft of its own (rudder)")
    foil_deduction = _f(0.0, "1", "t_R: deduction of the drag by helm (rudder)", max=1.0)
    foil_hull_share = _f(0.0, "1", "a_H: force of the hull, of its own (rudder)", min=0.0)
    foil_hull_position = _f(0.0, "m", "x_H: where that force acts, along x (rudder)")
    foil_arm = _f(0.0, "m", "centre of effort behind its axis, which is at its position (sail)")


class Coefficients(PropulsorCoefficients, FoilCoefficients, BallastSlots):
    """Mix-in: parameters of all parts."""


class Part(NamedTuple):
    """A part of a craft: its kind, and its parameters by their short names."""

    kind: str
    slot: SimpleNamespace


def fitted(values: Any, sort: str) -> list[Part]:
    """Return the parts of one of the `SORTS`, in order.

    ``values`` has the parameters as attributes: a plant's symbols, or a component's values.
    """
    kinds = getattr(values, f"{sort}s").split()
    return [Part(kind, _slot(vars(values), sort, k)) for k, kind in enumerate(kinds, 1)]


def _slot(values: Mapping[str, Any], sort: str, number: int) -> SimpleNamespace:
    """Return the parameters of one part: ``position`` of foil_position_2."""
    prefix, suffix = f"{sort}_", f"_{number}"
    return SimpleNamespace(
        **{
            name.removeprefix(prefix).removesuffix(suffix): value
            for name, value in values.items()
            if name.startswith(prefix) and name.endswith(suffix)
        }
    )
