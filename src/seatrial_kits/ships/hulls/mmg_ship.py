"""A ship by the MMG standard method: hull, propeller and rudder by coefficients of their own."""

from __future__ import annotations

from collections.abc import Mapping
from types import SimpleNamespace
from typing import Any, ClassVar

import casadi as ca
import numpy as np

from seatrial.errors import InputError
from seatrial.model.component import Input, Parameter
from seatrial.model.expressions import Vector
from seatrial.model.ports import Output
from seatrial.physics.craft.inertia import require_positive_definite
from seatrial.physics.craft.planar import (
    ThreeDofCraft,
    attachment,
    carried,
    kinematics,
    motion_outputs,
    sea_load,
    water_outputs,
)
from seatrial.physics.craft.wave_hull import HullCoefficients

from .mmg import SURGE_TERMS, SWAY_TERMS, flow_of, hull_load, propeller_load, rudder_load

_INERTIAS = (
    *("mass", "inertia", "center_of_gravity", "added_mass", "added_inertia"),
    *("length", "draught", "water_density"),
)
_BY_SIGN = ("positive", "negative")


class MmgShip(ThreeDofCraft):
    """Ship by the MMG standard method (Yasukawa & Yoshimura, J. Mar. Sci. Technol. 20, 2015).

    eta = (x, y, psi): body origin (midships) in {n} (x north, y east), m, and heading, clockwise
    from north, rad, any number of turns; nu = (u, v, r): velocity over ground, m/s, and rate of
    yaw, rad/s, in {b} (x bow, y starboard, z down). eta' = R(psi) nu. In the equations u, v, r
    are those through the water:

        (m + m_x) u' - (m + m_y) v r - x_G m r^2               = X_H + X_P + X_R
        (m + m_y) v' + (m + m_x) u r + x_G m r'                = Y_H + Y_R
        (I_zG + x_G^2 m + J_z) r' + x_G m (v' + u r)           = N_H + N_R

    with ``added_mass`` (m_x', m_y') of rho/2 L^2 d and ``added_inertia`` J_z' of rho/2 L^4 d.

    ``rudder`` is the angle of its blade, trailing edge to port positive: it turns the ship to
    port, as on every ship here, so that steering gears, autopilots and networks fit. The method
    has it the other way round: delta = -``rudder`` turns to starboard.

    **Hull.** U^2 = u^2 + v^2, v' = v / U, r' = r L / U; X_H = rho/2 L d U^2 (-R0' + sum of ``X``),
    Y_H alike with ``Y``, N_H = rho/2 L^2 d U^2 sum of ``N``; names of the coefficients spell
    their products, and R0' is ``resistance``.

    **Propeller.** X_P = (1 - t_P) T, T and Q by `open_water` at V_a = u (1 - w_P); n is the share
    ``propeller_order``, held to -1 to 1, of ``propeller_speed``. With the drift beta = atan2(-v, u)

        (1 - w_P) / (1 - w_P0) = 1 + (1 - exp(-C1 |beta_P|)) (C2 - 1),   beta_P = beta - x_P' r'

    C1 = ``wake_change_rate``, C2 = ``wake_change`` by the sign of beta_P.

    ``propeller_curves`` = "four-quadrant": T and Q by `all_quadrants` with the series of
    `wageningen_b4_70`, read at beta + ``propeller_series_turn`` and times
    ``propeller_series_share``, which fit it to another pitch and blade area. A shaft that turns
    astern pulls the stern aside (paddle-wheel effect), c = ``propeller_side_force``, T < 0:

        Y_P = c T,   N_P = x_P Y_P:   c > 0 (right-handed) takes the stern to port

    **Rudder.** `in_race` with eta = D / H_R, u_R = eps times it, v_R = gamma_R U (beta - l_R' r'),
    gamma_R by the sign of that; F_N by `blade` with f_alpha = ``rudder_lift_slope``.

        X_R = -(1 - t_R) F_N sin(delta)
        Y_R = -(1 + a_H) F_N cos(delta),   N_R = -(x_R + a_H x_H) F_N cos(delta)

    **Beyond the method**, for stopping and slow turns: where |r'| would be above 2, the U of the
    hull's forces is |r| L / 2; from |u| < U / 10 on R0' changes its sign with u; astern the drift
    at propeller and rudder is that of |u|. Hull coefficients astern are those ahead.

    In the sea of a trial its waves and wind and a tether or tow are further terms on the right.

    Not modelled: added resistance in waves, shallow water, heel and trim; side force of the
    propeller ahead; the engine, see `Motor` and `MarineEngine`, and rudder machinery, see
    `RudderMachine`.

    Raises InputError at the start for a mass matrix that is not positive definite, and for a
    propeller larger than the rudder's height.
    """

    exercised: ClassVar = {
        "mass": 300.0,  # of the default length and draught; lighter it diverges at long steps
        "inertia": 30.0,
        "resistance": 0.02,
        "X": [-0.04, 0.002, 0.01, 0.8],
        "Y": [-0.3, 0.08, -1.6, 0.4, -0.4, 0.01],
        "N": [-0.14, -0.05, -0.03, -0.3, 0.05, -0.01],
        "propeller_K_T": [0.3, -0.3, -0.1],
        "propeller_K_Q": [0.03, -0.02, -0.01],
        "propeller_order": 0.1,
        "rudder": 0.1,
        "nu_start": [1.0, 0.1, 0.1],
    }

    max_step = Parameter(0.1, "s", "longest integration sub-step", min=1e-6)
    water_density = Parameter(1025.0, "kg/m3", "rho", min=1e-9)
    length = Parameter(1.0, "m", "L, between perpendiculars", min=1e-9)
    draught = Parameter(1.0, "m", "d", min=1e-9)
    mass = Parameter(1.0, "kg", "m, of the displaced water", min=0.0)
    inertia = Parameter(1.0, "kg.m2", "I_zG, in yaw about the centre of gravity", min=0.0)
    center_of_gravity = Parameter(0.0, "m", "x_G, ahead of the body origin")
    added_mass = Parameter(0.0, "1", "m_x' and m_y', of rho/2 L^2 d", axes="xy", min=0.0)
    added_inertia = Parameter(0.0, "1", "J_z', of rho/2 L^4 d", min=0.0)

    resistance = Parameter(0.0, "1", "R0', straight ahead", min=0.0)
    X = Parameter(0.0, "1", "surge: coefficients of products of v', r'", axes=SURGE_TERMS)
    Y = Parameter(0.0, "1", "sway: coefficients of products of v', r'", axes=SWAY_TERMS)
    N = Parameter(0.0, "1", "yaw: coefficients of products of v', r'", axes=SWAY_TERMS)

    propeller_diameter = Parameter(1.0, "m", "D", min=1e-6)
    propeller_position = Parameter(-0.5, "1", "x_P', ahead of the body origin, of L")
    propeller_speed = Parameter(
        (10.0, 10.0), "rad/s", "shaft speed at orders 1 and -1, both positive",
        axes=("ahead", "astern"), min=0.0,
    )  # fmt: skip
    propeller_K_T = Parameter(0.0, "1", "thrust: K_T = k0 + k1 J + k2 J^2", axes=("k0", "k1", "k2"))
    propeller_K_Q = Parameter(0.0, "1", "moment: K_Q = k0 + k1 J + k2 J^2", axes=("k0", "k1", "k2"))
    propeller_advance_limit = Parameter(
        1.6, "1", "J from which on the coefficients are held", min=0.0
    )
    propeller_curves = Parameter(
        "open-water", "1", "of thrust and moment", choices=("open-water", "four-quadrant")
    )
    propeller_series_turn = Parameter(0.0, "rad", "of the four-quadrant series, in beta")
    propeller_series_share = Parameter(
        1.0, "1", "of the four-quadrant series that acts", axes=("C_T", "C_Q"), min=0.0
    )
    propeller_side_force = Parameter(
        0.0, "1", "c, of the thrust astern: takes the stern to port, less than 0 to starboard"
    )
    propeller_deduction = Parameter(0.0, "1", "t_P: (1 - t_P) of the thrust acts", max=1.0)
    propeller_wake = Parameter(0.0, "1", "w_P0, wake fraction straight ahead", max=1.0)
    wake_change_rate = Parameter(0.0, "1", "C1, of the wake by drift", min=0.0)
    wake_change = Parameter(
        1.0, "1", "C2, of the wake at large drift, by its sign", axes=_BY_SIGN, min=0.0
    )

    rudder_area = Parameter(1.0, "m2", "A_R, of the movable part", min=0.0)
    rudder_height = Parameter(1.0, "m", "H_R, span", min=1e-6)
    rudder_lift_slope = Parameter(2.5, "1/rad", "f_alpha, of the normal force", min=0.0)
    rudder_position = Parameter(-0.5, "1", "x_R', ahead of the body origin, of L")
    rudder_flow_position = Parameter(
        -0.7, "1", "l_R', place whose drift the rudder meets, of L; it is measured"
    )
    rudder_straightening = Parameter(
        1.0, "1", "gamma_R, straightening of the flow, by the sign of the drift",
        axes=_BY_SIGN, min=0.0,
    )  # fmt: skip
    rudder_wake_ratio = Parameter(
        1.0, "1", "eps: water that follows, beside the propeller's", min=0.0
    )
    rudder_race_gain = Parameter(0.5, "1", "kappa: gain of the race's speed", min=0.0)
    rudder_deduction = Parameter(0.0, "1", "t_R: deduction of the drag by helm", max=1.0)
    rudder_hull_share = Parameter(0.0, "1", "a_H: force of the hull, of its own", min=0.0)
    rudder_hull_position = Parameter(0.0, "1", "x_H': where that force acts, of L")

    rudder = Input(
        "rad", "angle of the rudder, trailing edge to port positive: turns to port", role="command"
    )
    propeller_order = Input("1", "share of the shaft speed, -1 to 1", role="command")

    propeller_rate = Output("rad/s", "shaft speed")
    propeller_thrust = Output("N", "thrust T of the propeller, before deduction")
    propeller_torque = Output("N.m", "moment Q of the shaft")
    propeller_power = Output("W", "power of the shaft, 2 pi n Q")
    rudder_inflow = Output(
        "m/s", "effective flow (u_R, v_R) past the rudder, aft and to starboard", axes="uv"
    )
    rudder_force = Output("N", "normal force F_N of the rudder, positive where it acts to port")

    feedthrough: ClassVar = {
        **ThreeDofCraft.feedthrough,
        "acceleration": ("rudder", "propeller_order", "attachment_force"),
        **dict.fromkeys(
            ("propeller_rate", "propeller_thrust", "propeller_torque", "propeller_power"),
            ("propeller_order",),
        ),
        "rudder_inflow": ("propeller_order",),
        "rudder_force": ("rudder", "propeller_order"),
    }

    def start(self, t: float) -> None:
        """Start from the start values; raises InputError as the class says."""
        require_positive_definite(self.name, self.mass_matrix(), ", ".join(_INERTIAS))
        if self.propeller_diameter > self.rudder_height:
            raise InputError(
                f"{self.name}.propeller_diameter is {self.propeller_diameter!r} m; at most "
                f"rudder_height, {self.rudder_height!r} m, is allowed"
            )
        super().start(t)

    def wave_coefficients(self) -> tuple[HullCoefficients, float]:
        """Return what the equations have of the hull, and the density of the water, kg/m3."""
        scale = 0.5 * self.water_density * self.length**2 * self.draught
        return HullCoefficients(sway=(self.added_mass[1] * scale, 0.0)), self.water_density

    def mass_matrix(self) -> Vector:
        """Return M (3, 3) about the body origin, with added mass, from the parameters.

        Rows and columns u, v, r; kg, kg.m and kg.m2.
        """
        numbers = SimpleNamespace(**{name: ca.DM(getattr(self, name)) for name in _INERTIAS})
        return np.array(ca.DM(_mass_matrix(numbers)))

    def equations(
        self, x: SimpleNamespace, u: SimpleNamespace, p: SimpleNamespace
    ) -> tuple[Mapping[str, Any], Mapping[str, Any]]:
        """Return the derivatives of eta and nu, the motion, and what propeller and rudder do."""
        attached, pull = attachment(x, u, p)
        nu_r, carrying = carried(x.eta, x.nu, u)
        flow = flow_of(nu_r, p)
        screw, screwed = propeller_load(flow, u.propeller_order, p)
        steering, steered = rudder_load(flow, screw, -u.rudder, p)
        load = hull_load(flow, p) + screwed + steering + pull + sea_load(u)
        M = _mass_matrix(p)
        nu_dot = ca.solve(M, load - _turning(M, nu_r, p)) + carrying
        motion = {**motion_outputs(x.eta, x.nu, nu_dot), **attached}
        motion |= water_outputs(x.eta, nu_r, u, p) | steered
        motion |= {
            "propeller_rate": screw.rate,
            "propeller_thrust": screw.thrust,
            "propeller_torque": screw.torque,
            "propeller_power": screw.rate * screw.torque,
        }
        return {"eta": kinematics(x.eta, x.nu), "nu": nu_dot}, motion


def _turning(M: Any, nu_r: Any, p: SimpleNamespace) -> Any:
    """Return the terms of motion on the left-hand sides; the Munk moment is in the hull's N."""
    u, v, r = ca.vertsplit(nu_r)
    moment = p.mass * p.center_of_gravity
    return ca.vertcat(-M[1, 1] * v * r - moment * r**2, M[0, 0] * u * r, moment * u * r)


def _mass_matrix(p: SimpleNamespace) -> Any:
    """Return M from CasADi numbers or symbols."""
    scale = p.water_density / 2 * p.length**2 * p.draught
    moment = p.mass * p.center_of_gravity
    return ca.vertcat(
        ca.horzcat(p.mass + p.added_mass[0] * scale, 0, 0),
        ca.horzcat(0, p.mass + p.added_mass[1] * scale, moment),
        ca.horzcat(
            0,
            moment,
            p.inertia + moment * p.center_of_gravity + p.added_inertia * scale * p.length**2,
        ),
    )
