"""A craft with parts by data: propulsors, foils and ballast, each in the flow where it is."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from types import SimpleNamespace
from typing import Any, ClassVar

import casadi as ca

from seatrial.model.component import Input, Parameter, Terminal
from seatrial.model.plant import State
from seatrial.model.ports import Output
from seatrial.physics.craft.around import Around
from seatrial.physics.craft.marine_craft import MarineCraft
from seatrial.physics.craft.six_dof import craft_context, six_dof_motion
from seatrial.physics.craft.terms.hydrodynamics import TERMS
from seatrial.physics.sea.orbital import Orbital

from .parts.ballast import ballasted, points, surface_weight, volumes
from .parts.checks import require_parts
from .parts.coefficients import SORTS, Coefficients, fitted
from .parts.foils import foil_load
from .parts.lags import angle_lag, ballast_lag, foil_lag, follow, order_lag
from .parts.orbital import PARTS_PORTS, waves_at_parts, with_waves
from .parts.propulsors import pushes, steered
from .parts.screws import ADVANCES
from .parts.slots import BALLASTS, COUNT, FOILS, PROPULSORS

_P, _F, _B = (tuple(f"{letter}{k}" for k in range(1, COUNT + 1)) for letter in "pfb")
_ORDERS = ("propulsor_order", "propulsor_angle", "foil_angle", "ballast_order")


class FittedCraft(Coefficients, MarineCraft):
    """Craft with up to 8 propulsors, 8 foils and 8 ballasts: `MarineCraft` and their loads.

    ``propulsors``, ``foils`` and ``ballasts`` name the kinds, in order; parameter NAME of
    propulsor k is ``propulsor_NAME_k``, and so on. What is not named adds nothing.

    **Propulsors** (`thrust`, `screws`) push along their axis, turned by their angle about z, from
    x to y. An order is a share, held to -1 to 1: of the largest thrust (thruster, azimuth,
    outboard, tunnel, jet) or shaft speed (propeller, wageningen-b, four-quadrant), where
    ``propulsor_thrust_k`` is not read. It is limited before it lags. An angle range of a full turn
    or more is endless, from -1e9 to 1e9 say: it turns the shortest way and counts its turns. One
    that ``propulsor_turns_with`` another has that one's angle.
    **Foils** (`fins`, `rudder`, `sail`) have positive angles as there. **Ballast** (`ballast`)
    changes mass, CG, inertia and buoyancy as it fills or moves; `mass_matrix` is that without it.

    **Lags** (`lags`): value' = (order - value) / time constant, held within the rate limit; with
    neither, the order acts at once. ``lagged_*`` are the states of that, and keep their start
    values where nothing lags.

    **Flow.** Each part meets the velocity of its own place through the water: body rates, shear of
    the current and the waves there (`orbital`) included. ``speed_of_advance`` = "over-ground" has
    propellers advance at |v| over ground, as some models do: in a current that is wrong.

    Not modelled: parts that leave the water; one propulsor's race at another; inertia of what
    turns; forces of ballast in motion.

    Raises InputError at the start as `checks` and `SixDofCraft` say.
    """

    surrounding_ports: ClassVar = PARTS_PORTS
    exercised: ClassVar = {
        "terms": " ".join(TERMS),
        "restoring": "floating",
        "mass": 40.0,
        "buoyancy": 400.0,
        "inertia": [1.0, 6.0, 6.0, 0.0, 0.0, 0.0],
        "propulsors": " ".join(PROPULSORS),
        "foils": " ".join(FOILS),
        "ballasts": " ".join(BALLASTS),
        "propulsor_K_T_5": [0.4, -0.3, -0.1],
        "propulsor_K_Q_5": [0.05, -0.03, -0.01],
        "propulsor_C_T_7": [0.0, 0.5, 0.01, 0.0, 0.0, -0.8, 0.0, 0.05, 0.0],
        "propulsor_C_Q_7": [0.0, 0.07, 0.0, 0.0, 0.0, -0.1, 0.0, 0.01, 0.0],
        "foil_lift_2": 0.5,
        "foil_behind_3": 5.0,
        "ballast_volume_1": 1e-4,
        "ballast_mass_2": 0.1,
        "ballast_mass_3": 0.1,
        "ballast_travel_3": 0.1,
    }

    speed_of_advance = Parameter(
        "through-water", "1", "speed that propellers advance at", choices=ADVANCES
    )
    air_density = Parameter(1.225, "kg/m3", "density of the air at sails", min=0.0)

    propulsor_order = Input(
        "1", "share of largest thrust or shaft speed", axes=_P, role="command", optional=True
    )
    propulsor_angle = Input("rad", "angle about z, from x to y", axes=_P, optional=True)
    foil_angle = Input("rad", "angle of the foil", axes=_F, role="command", optional=True)
    ballast_order = Input("1", "share of the range", axes=_B, optional=True)
    wind = Input(
        "m/s", "velocity of the air over ground at sails, {n}", axes=("north", "east"),
        optional=True,
    )  # fmt: skip

    lagged_order = State("1", "order behind its lag", axes=_P)
    lagged_angle = State("rad", "angle of a propulsor behind its lag", axes=_P)
    lagged_foil = State("rad", "angle of a foil behind its lag", axes=_F)
    lagged_ballast = State("1", "share of a ballast behind its rate", axes=_B)

    propulsor_force = Output("N", "thrust that acts, along its direction", axes=_P)
    propulsor_rate = Output("rad/s", "shaft speed", axes=_P)
    propulsor_turned = Output("rad", "angle that it has", axes=_P)
    propulsor_power = Output("W", "power of the shaft", axes=_P)
    foil_turned = Output("rad", "angle that it has", axes=_F)
    ballast_share = Output("1", "share that it has", axes=_B)

    terminals: ClassVar = {
        **MarineCraft.terminals,
        **{
            f"{name}s": Terminal({axis: f"{name}.{axis}" for axis in axes})
            for name, axes in zip(_ORDERS, (_P, _P, _F, _B), strict=True)
        },
    }
    feedthrough: ClassVar = {
        **MarineCraft.feedthrough,
        "acceleration": (*MarineCraft.feedthrough["acceleration"], *_ORDERS, "wind"),
        "propulsor_force": ("propulsor_order", "propulsor_angle", "current"),
        "propulsor_power": ("propulsor_order", "propulsor_angle", "current"),
        "propulsor_rate": ("propulsor_order",),
        "propulsor_turned": ("propulsor_angle",),
        "foil_turned": ("foil_angle",),
        "ballast_share": ("ballast_order",),
    }

    def start(self, t: float) -> None:
        """Start from the start values; raises InputError as the class says."""
        require_parts(self)
        super().start(t)

    def around(self) -> Around | None:
        """Return sea, current and wind around craft and parts, or None. Raises InputError."""
        found = super().around()
        if found is None:
            return None
        values = SimpleNamespace(**{name: getattr(self, name) for name in self.ports})
        waves = self.sea_state().waves()
        orbital = found.orbital or (None if waves is None else Orbital(waves))
        parts = waves_at_parts(orbital, fitted(values, "propulsor"), fitted(values, "foil"))
        return replace(found, parts=parts)

    def equations(
        self, x: SimpleNamespace, u: SimpleNamespace, p: SimpleNamespace
    ) -> tuple[Mapping[str, Any], Mapping[str, Any]]:
        """Return the derivatives of motion and lags, and what motion and parts show."""
        propulsors, foils, ballasts = (fitted(p, sort) for sort in SORTS)
        propulsors, foils = with_waves(propulsors, 0, u), with_waves(foils, 1, u)
        order = follow([order_lag(each) for each in propulsors], u.propulsor_order, x.lagged_order)
        angle = follow([angle_lag(each) for each in propulsors], u.propulsor_angle, x.lagged_angle)
        angles = steered(propulsors, angle.values)
        foil = follow([foil_lag(each) for each in foils], u.foil_angle, x.lagged_foil)
        filled = follow([ballast_lag(each) for each in ballasts], u.ballast_order, x.lagged_ballast)
        masses = points(ballasts, filled.values)
        p = ballasted(p, masses, volumes(ballasts, filled.values))
        nu = ca.vertcat(x.velocity, x.rates)
        c = craft_context(x.position, x.attitude, nu, u, p)
        pushed = pushes(c, propulsors, order.values, angles)
        load = sum((push.load for push in pushed), foil_load(c, foils, foil.values, pushed))
        if p.restoring.startswith("surface"):
            load += surface_weight(c, masses)
        changes, outputs = six_dof_motion(x.position, x.attitude, nu, u, p, parts=load)
        derivatives = {
            **vars(changes),
            "lagged_order": _padded(order.changes),
            "lagged_angle": _padded(angle.changes),
            "lagged_foil": _padded(foil.changes),
            "lagged_ballast": _padded(filled.changes),
        }
        return derivatives, {
            **outputs,
            "propulsor_force": _padded([push.force for push in pushed]),
            "propulsor_rate": _padded([push.rate for push in pushed]),
            "propulsor_turned": _padded(angles),
            "propulsor_power": _padded([push.power for push in pushed]),
            "foil_turned": _padded(foil.values),
            "ballast_share": _padded(filled.values),
        }


def _padded(values: Sequence[Any]) -> Any:
    """Return a column with one value for each of the places of a sort, 0 where there is no part."""
    return ca.vertcat(*values, *[0] * (COUNT - len(values)))
