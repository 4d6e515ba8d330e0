"""A sailing boat in four degrees of freedom: surge, sway, roll and yaw."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from types import SimpleNamespace
from typing import Any, ClassVar

import casadi as ca
import numpy as np

from seatrial.model.component import Input, Parameter, terminal
from seatrial.model.expressions import Vector
from seatrial.model.plant import State
from seatrial.model.ports import Output
from seatrial.physics.craft.around import Places
from seatrial.physics.craft.foils import flow_at, foil_load
from seatrial.physics.craft.inertia import require_positive_definite
from seatrial.physics.craft.planar import (
    PlanarCraft,
    attachment,
    horizontal_rotation,
    kinematics,
    motion_outputs,
    planar_coriolis,
    sea_load,
    water_outputs,
)
from seatrial.physics.craft.wave_hull import HullCoefficients
from seatrial.physics.foils import HIGH_ALPHA, SAIL_ENTRIES, foil_naca63010, sail_naca0015

_LOAD = {"axes": "XYKN"}
_LOAD_UNITS = ("N", "N", "N.m", "N.m")
_HORIZONTAL = ("north", "east")
_INERTIAS = ("mass", "inertia", "X_udot", "Y_vdot", "Y_rdot", "K_pdot", "N_rdot")


class Sailboat(PlanarCraft):
    """Boat with a rigid sail that has a flap, a keel and a rudder.

        eta' = J(phi, psi) nu
        M nu' = -C_RB(nu) nu - C_A(nu_r) nu_r - D nu_r - g(phi) + S + K + R + T + M_A nu_c'

    [Silva2018], eqs 2.2 to 2.29, in the corrected form that docs/kits/sailing/gloria.md lists.
    eta = (x, y, phi, psi): body origin, which is the CG, in {n} (x north, y east), m; heel,
    starboard down, and heading, clockwise from north, rad. nu = (u, v, p, r): velocity of the
    origin over ground and rates in {b} (x bow, y starboard, z down, heeling with the boat).

    **Water and air.** nu_r = nu - nu_c, nu_c = (J_2D^T current, 0, 0) (2.4). Current and wind
    are horizontal velocities over ground, steady and uniform; the wind's is where it blows to.
    In body axes the current turns: nu_c' is its derivative along phi' and psi', which the
    source leaves out. The boat is carried by a current as if it stood still, exactly as long
    as it is level or neither rolls nor turns; with heel the four degrees of freedom themselves
    are not invariant, for heave is left out.

    **Inertia.** M = M_RB + M_A, M_RB = diag(m, m, I_xx, I_zz) (2.8), M_A = -(added mass
    derivatives), Y_rdot in sway and yaw alike (2.10). C_RB and C_A by 2.11 and 2.12.

    **Hull.** D nu_r = -(X_u u_r, Y_v v_r + Y_r r, K_p p, N_v v_r + N_r r) (2.13, with a damping
    of roll that the source has not). g = (0, 0, m g GM_T sin(phi) cos(phi), 0) (2.14).

    **Foils.** S, K, R from 2.15 to 2.29, as `foil_load`: lift and drag by tables at the local
    flow, which the boat's rates turn. The sail's centre of effort is ``sail_arm`` behind its
    axis, along the boom. ``sail`` and ``rudder`` turn their trailing edges to port when
    positive: a positive ``rudder`` turns the boat to port. T is that of a tether or tow.
    ``sail_torque`` = N - x_axis Y is the moment of S about the sail's axis: positive opens a sail
    to port further.

    **Rate of the sail.** With ``sail_swing`` "on" the flow at the sail's centre of effort has what
    it moves against the boat, as the last term of 2.18 has it, its second row with the right sign:

        a -= sail_rate sail_arm sin(sail),    b += sail_rate sail_arm cos(sail)

    ``apparent_wind`` is the flow at the centre of effort of a sail amidships: its speed and
    the direction it blows to, atan2(to starboard, to the bow).

    In the sea of a trial its current is added to ``current``, M R^T V' of the water that speeds
    up and the loads of waves in surge, sway, roll and yaw to the right-hand side.

    Not modelled: heave, pitch; inertia of the sail; what one foil's wake does to another; finite
    span; stall with memory; the righting moment of a real hull at large heel.
    """

    places: ClassVar = Places(x=0, y=1, z=None, psi=3, u=4, v=5)

    mass = Parameter(1.0, "kg", "mass without added mass", min=0.0)
    inertia = Parameter((1.0, 1.0), "kg.m2", "inertia about the CG", axes=("xx", "zz"))
    X_udot = Parameter(0.0, "kg", "added mass in surge, negative")
    Y_vdot = Parameter(0.0, "kg", "added mass in sway, negative")
    Y_rdot = Parameter(0.0, "kg.m", "added mass, sway from yaw and yaw from sway")
    K_pdot = Parameter(0.0, "kg.m2", "added inertia in roll, negative")
    N_rdot = Parameter(0.0, "kg.m2", "added inertia in yaw, negative")
    X_u = Parameter(0.0, "N.s/m", "damping of surge, negative")
    Y_v = Parameter(0.0, "N.s/m", "damping of sway, negative")
    Y_r = Parameter(0.0, "N.s/rad", "sway force per rate of yaw")
    K_p = Parameter(0.0, "N.m.s/rad", "damping of roll by the hull, negative")
    N_v = Parameter(0.0, "N.s", "yaw moment per speed of sway")
    N_r = Parameter(0.0, "N.m.s/rad", "damping of yaw, negative")
    GM_T = Parameter(0.0, "m", "transverse metacentric height")
    gravity = Parameter(9.81, "m/s2", "acceleration of gravity", min=0.0)
    air_density = Parameter(1.225, "kg/m3", "density of the air", min=0.0)
    water_density = Parameter(1000.0, "kg/m3", "density of the water", min=0.0)
    sail_area = Parameter(0.0, "m2", "area of the sail", min=0.0)
    sail_axis = Parameter(
        (0.0, 0.0), "m", "axis of the sail at its centre of effort, body axes", axes="xz"
    )
    sail_arm = Parameter(0.0, "m", "centre of effort of the sail behind its axis")
    keel_area = Parameter(0.0, "m2", "area of the keel", min=0.0)
    keel_place = Parameter((0.0, 0.0), "m", "centre of effort of the keel, body axes", axes="xz")
    rudder_area = Parameter(0.0, "m2", "area of the rudder", min=0.0)
    rudder_place = Parameter(
        (0.0, 0.0), "m", "centre of effort of the rudder, body axes", axes="xz"
    )
    sail_entry = Parameter(
        "patched", "1", "C_L of the sail at flap 15, alpha 175 deg", choices=SAIL_ENTRIES
    )
    high_alpha = Parameter(
        "physical", "1", "C_L beyond 90 deg: as in the tables, or negated", choices=HIGH_ALPHA
    )
    sail_swing = Parameter(
        "off", "1", "whether the rate of the sail acts on its flow", choices=("off", "on")
    )

    sail = Input("rad", "angle of the sail, boom to port positive")
    sail_rate = Input("rad/s", "rate of that angle, with sail_swing", optional=True)
    flap = Input("rad", "size of the flap's angle, towards the side of the lift, 0 to 30 deg")
    rudder = Input("rad", "angle of the rudder, trailing edge to port positive")
    wind = Input(
        "m/s", "velocity of the air over ground: where the wind blows to, {n}", axes=_HORIZONTAL
    )
    current = Input(
        "m/s", "velocity of the water over ground, {n}", axes=_HORIZONTAL, optional=True
    )

    eta = State(
        ("m", "m", "rad", "rad"),
        "body origin in {n}; heel, starboard down; heading, clockwise from north",
        axes=("x", "y", "phi", "psi"),
    )
    nu = State(
        ("m/s", "m/s", "rad/s", "rad/s"),
        "velocity of the body origin over ground and rates, body axes",
        axes=("u", "v", "p", "r"),
    )
    sail_load = Output(_LOAD_UNITS, "force and moment of the sail, body axes", **_LOAD)
    keel_load = Output(_LOAD_UNITS, "force and moment of the keel, body axes", **_LOAD)
    rudder_load = Output(_LOAD_UNITS, "force and moment of the rudder, body axes", **_LOAD)
    sail_torque = Output("N.m", "moment of the sail about its axis, positive opens it to port")
    apparent_wind = Output(
        ("m/s", "rad"),
        "apparent wind at the sail, and where it blows to from the bow, to starboard positive",
        axes=("speed", "angle"),
    )

    terminals: ClassVar = {**PlanarCraft.terminals, "angles": terminal("rudder", "sail", "flap")}
    feedthrough: ClassVar = {
        **PlanarCraft.feedthrough,
        **dict.fromkeys(("nu_r", "flow"), ("current",)),
    }

    def start(self, t: float) -> None:
        """Start from the start values; raises InputError if M is not positive definite."""
        require_positive_definite(self.name, self.mass_matrix(), ", ".join(_INERTIAS))
        super().start(t)

    def wave_coefficients(self) -> tuple[HullCoefficients, float]:
        """Return what the equations have of the hull, and the density of the water, kg/m3."""
        own = HullCoefficients(sway=(-self.Y_vdot, -self.Y_v), roll=(-self.K_pdot, -self.K_p))
        return own, self.water_density

    def mass_matrix(self) -> Vector:
        """Return M (4, 4), from the parameters as they are now; rows u, v, p, r."""
        numbers = SimpleNamespace(**{name: ca.DM(getattr(self, name)) for name in _INERTIAS})
        return np.array(ca.DM(_rigid_body(numbers) + _added_mass(numbers)))

    def steady(self, heading: float, guess: Sequence[float]) -> tuple[Vector, float]:
        """Return the state (8,) and the rudder, rad, that hold ``heading`` without acceleration.

        Sail, flap, wind and current are as set; x = y = 0, p = r = 0. ``guess`` is (u, v, phi,
        rudder) to start from: upwind there are several such states. Levenberg-Marquardt with
        the exact Jacobian. Raises ArithmeticError if none is found (an acceleration above
        1e-9 m/s2 or rad/s2 is left).
        """
        from scipy.optimize import root

        rudder = self.ports["rudder"].offset - self._u_slice.start
        inputs = self._stacked_u(None)

        def state(z: Vector) -> Vector:
            inputs[rudder] = z[3]
            return np.array([0.0, 0.0, z[2], heading, z[0], z[1], 0.0, 0.0])

        def jacobian(z: Vector) -> Vector:
            linear = self.linearise(state(z), inputs)
            return np.column_stack([linear.A[4:, [4, 5, 2]], linear.B[4:, rudder]])

        found = root(
            lambda z: self.derivatives(state(z), inputs)[4:],
            np.array(guess, dtype=float),
            jac=jacobian,
            method="lm",
            options={"xtol": 1e-15, "ftol": 1e-15},
        )
        residual = np.abs(found.fun).max()
        if residual > 1e-9:
            raise ArithmeticError(f"no steady state found: an acceleration of {residual:.3g} left")
        return state(found.x), float(found.x[3])

    def equations(
        self, x: SimpleNamespace, u: SimpleNamespace, p: SimpleNamespace
    ) -> tuple[Mapping[str, Any], Mapping[str, Any]]:
        """Return the derivatives of eta and nu, motion, loads and apparent wind."""
        into_body = horizontal_rotation(x.eta[2], x.eta[3]).T
        at_sea = hasattr(u, "water_velocity")
        current = u.current + u.water_velocity[:2] if at_sea else u.current
        air, water = into_body @ u.wind, into_body @ current
        eta_dot = kinematics(x.eta, x.nu)
        nu_c = ca.vertcat(water, 0, 0)
        nu_c_dot = ca.jtimes(nu_c, x.eta, eta_dot)
        foils = _foil_loads(x.nu, air, water, u, p)
        M_A = _added_mass(p)
        attached, pull = attachment(x, u, p)
        tau = (
            sum(foils.values())
            + _hull(x.eta[2], x.nu, x.nu - nu_c, p)
            - _coriolis((M_A @ (x.nu - nu_c))[:2], x.nu - nu_c)
            + M_A @ nu_c_dot
            + pull
            + sea_load(u, (0, 1, 3, 5))
        )
        if at_sea:
            rate = into_body @ u.water_acceleration[:2]
            tau = tau + (_rigid_body(p) + M_A) @ ca.vertcat(rate, 0, 0)
        nu_dot = ca.ldl_solve(tau, *ca.ldl(_rigid_body(p) + M_A))
        a, b = ca.vertsplit(flow_at(_sail_place(0.0, p), air, x.nu))
        apparent_wind = ca.vertcat(ca.sqrt(a * a + b * b), ca.atan2(b, a))
        return {"eta": eta_dot, "nu": nu_dot}, {
            **motion_outputs(x.eta, x.nu, nu_dot),
            **water_outputs(x.eta, x.nu - nu_c, u, p),
            **attached,
            **foils,
            "sail_torque": foils["sail_load"][3] - p.sail_axis[0] * foils["sail_load"][1],
            "apparent_wind": apparent_wind,
        }


def _rigid_body(p: SimpleNamespace) -> Any:
    """Return M_RB (4, 4): [Silva2018], eq. 2.8."""
    return ca.diag(ca.vertcat(p.mass, p.mass, p.inertia))


def _added_mass(p: SimpleNamespace) -> Any:
    """Return M_A (4, 4): [Silva2018], eq. 2.10."""
    return -ca.vertcat(
        ca.horzcat(p.X_udot, 0, 0, 0),
        ca.horzcat(0, p.Y_vdot, 0, p.Y_rdot),
        ca.horzcat(0, 0, p.K_pdot, 0),
        ca.horzcat(0, p.Y_rdot, 0, p.N_rdot),
    )


def _coriolis(h: Any, nu: Any) -> Any:
    """Return C nu (4,) of the momentum h = (h_u, h_v): [Silva2018], eqs 2.11 and 2.12."""
    X, Y, N = ca.vertsplit(planar_coriolis(h, nu[[0, 1, 3]]))
    return ca.vertcat(X, Y, 0, N)


def _hull(phi: Any, nu: Any, nu_r: Any, p: SimpleNamespace) -> Any:
    """Return -C_RB nu - D nu_r - g (4,): [Silva2018], eqs 2.11, 2.13 and 2.14."""
    u_r, v_r, roll, r = ca.vertsplit(nu_r)
    damping = ca.vertcat(
        p.X_u * u_r, p.Y_v * v_r + p.Y_r * r, p.K_p * roll, p.N_v * v_r + p.N_r * r
    )
    righting = p.mass * p.gravity * p.GM_T * ca.sin(phi) * ca.cos(phi)
    return damping - ca.vertcat(0, 0, righting, 0) - _coriolis(p.mass * nu[:2], nu)


def _foil_loads(
    nu: Any, air: Any, water: Any, u: SimpleNamespace, p: SimpleNamespace
) -> dict[str, Any]:
    """Return the loads (X, Y, K, N) of sail, keel and rudder by port: 2.18 to 2.29."""
    sail, foil = sail_naca0015(p.sail_entry, p.high_alpha), foil_naca63010(p.high_alpha)
    places = {
        "sail": _sail_place(u.sail, p),
        "keel": ca.vertcat(p.keel_place[0], 0, p.keel_place[1]),
        "rudder": ca.vertcat(p.rudder_place[0], 0, p.rudder_place[1]),
    }
    flows = {
        name: flow_at(place, air if name == "sail" else water, nu) for name, place in places.items()
    }
    if p.sail_swing == "on":
        swing = u.sail_rate * p.sail_arm
        flows["sail"] += swing * ca.vertcat(-ca.sin(u.sail), ca.cos(u.sail))
    half_air, half_water = 0.5 * p.air_density, 0.5 * p.water_density
    return {
        "sail_load": foil_load(
            sail, places["sail"], flows["sail"], u.sail, half_air * p.sail_area, u.flap
        ),
        "keel_load": foil_load(foil, places["keel"], flows["keel"], 0.0, half_water * p.keel_area),
        "rudder_load": foil_load(
            foil, places["rudder"], flows["rudder"], u.rudder, half_water * p.rudder_area
        ),
    }


def _sail_place(angle: Any, p: SimpleNamespace) -> Any:
    """Return the centre of effort (x, y, z) of the sail at ``angle``, body axes, m."""
    x, z = ca.vertsplit(p.sail_axis)
    return ca.vertcat(x - p.sail_arm * ca.cos(angle), -p.sail_arm * ca.sin(angle), z)
