"""Terms of the equations of motion in six degrees of freedom, each with its equation and limits.

A term is a function of a `Context` that returns a load (6,): forces, N, and moments about the
body origin, N.m, in body axes, on the right-hand side of

    M nu_r' = tau_ext + sum of the terms

Its coefficients are the craft's parameters. A vehicle's file names the terms that it takes
(parameter ``terms``) and fills their coefficients. To add a term, write its function, enter it
in `TERMS` and declare its parameters in `six_dof.SixDofCraft`. A kit adds terms in the table
``terms`` of its manifest; those with parameters of their own come with a craft of the kit, which
declares them. Source numbers are those of the vehicles' pages.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from typing import Any

import casadi as ca

from ....errors import InputError, unknown
from ....plugins import Registry
from .context import Context
from .coupled_damping import coupled_damping
from .hull_points import floating, point_drag, wave_making, wet
from .morison import morison
from .slender import body_lift, fading_damping, hull_lift
from .winged_body import winged_body

Term = Callable[[Context], Any]
_LEVEL = 1e-12
"""Keeps the heel of a craft that stands on its bow finite."""


def restoring(c: Context) -> Any:
    """Return weight and buoyancy in the form that ``restoring`` names.

    W = mass gravity, k = density gravity waterplane_area, z the sinkage from the floating
    equilibrium, n the vertical in {b}, r_F = ``center_of_flotation``:

    - "surface-linear": Z = -k z, K = -W GM_T sin(phi), M = -W GM_L sin(theta), in body axes
      ([Timm2026], eqs 26 and 41, with the heave stiffness that eq. 41 omits). With r_F the
      force is Z = -k (z + y_F phi - x_F theta) at r_F.
    - "surface-conservative": force -k z n, moment n x (W GM_L n1, W GM_T n2, 0). Its potential
      is k z^2 / 2 + W (GM_L n1^2 + GM_T n2^2) / 2; it agrees with the former to first order
      and has no moment about the vertical. With r_F, z is that of the point r_F, z + n . r_F,
      and the force acts there (Fossen, Handbook of Marine Craft Hydrodynamics and Motion
      Control, 2nd ed., 2021, has its first order).
    - "surface-curve": as "surface-conservative", with the righting arm GZ(phi) of the sections to
      capsize in the place of GM_T (`large_angles`): potential W GM_L n1^2 / 2 + W integral of GZ,
      phi = atan2(n2, n3), its moment about x at level pitch -W GZ(phi).
    - "submerged": weight W n at the CG, buoyancy -B n at the centre of buoyancy: force
      (W - B) n, moment (r_G W - r_B B) x n (Fossen; [Paulino2015], eqs 3.25 to 3.28).
    - "floating": between the two, by eight cells (`hull_points.floating`).

    Limits: in the surface forms the moment of GM is a couple, and the waterplane is that of
    the upright craft at every sinkage. "submerged" has no surface.
    """
    p, n = c.parameters, c.vertical
    W = p.mass * p.gravity
    if p.restoring == "floating":
        return floating(c)
    if p.restoring == "submerged":
        weight, buoyancy = W * n, -p.buoyancy * n
        moment = ca.cross(p.center_of_gravity, weight) + ca.cross(p.center_of_buoyancy, buoyancy)
        return ca.vertcat(weight + buoyancy, moment)
    k = p.density * p.gravity * p.waterplane_area
    r_F = ca.vertcat(p.center_of_flotation, 0)
    z, phi, theta = c.position[2], c.attitude[0], c.attitude[1]
    if p.restoring == "surface-linear":
        force = ca.vertcat(0, 0, -k * (z + r_F[1] * phi - r_F[0] * theta))
        couple = ca.vertcat(-W * p.GM_T * ca.sin(phi), -W * p.GM_L * ca.sin(theta), 0)
    else:
        force = -k * (z + ca.dot(n, r_F)) * n
        across = ca.vertcat(W * p.GM_T * n[1], 0)
        if p.restoring == "surface-curve":
            across = W * _curve(n[1], n[2], p.righting_arm)
        couple = ca.cross(n, ca.vertcat(W * p.GM_L * n[0], across))
    return ca.vertcat(force, couple + ca.cross(r_F, force))


def _curve(n2: Any, n3: Any, sines: Any) -> Any:
    """Return the gradient of the integral of GZ(phi) by n2 and n3, m."""
    phi = ca.atan2(n2, n3)
    arm = sum(a * ca.sin(k * phi) for k, a in enumerate(ca.vertsplit(sines), 1))
    return arm / (n2**2 + n3**2 + _LEVEL) * ca.vertcat(n3, -n2)


def coriolis(c: Context) -> Any:
    """Return -C(nu_r) nu_r in the form that ``coriolis`` names.

    C nu = (omega x h1, omega x h2 + v x h1) of the momentum h = (h1, h2), v and omega those of
    nu_r: C = [[0, -S(h1)], [-S(h1), -S(h2)]] ([Timm2026], eq. 19; [Paulino2015], eq. 3.24).

    - "full": h = M nu_r, which conserves momentum.
    - "diagonal": h = diag(M) nu_r, the form of [Timm2026], eq. 56, which loses the coupling
      terms of M.
    - "without-munk": as "full", less v x A v, the moment of the translational added mass A on
      a body in steady oblique translation (Munk). Does not conserve energy, and is no flow's: some
      simulators leave it out because a bluff body's wake takes much of it back.
    - "without-cross-pairs": as "full", less the terms of A that couple u or w with q and u or v
      with r: of A v are left its force by the rate of roll, (p, 0, 0) x A v, and its moment about
      x. So does T. I. Fossen's model of REMUS-100, to whose damping they do not fit. Does not
      conserve energy.

    Limits: ideal fluid, even flow, no memory.
    """
    h = ca.diag(c.M) * c.nu_r if c.parameters.coriolis == "diagonal" else c.M @ c.nu_r
    load = coriolis_load(h, c.nu_r)
    v, omega = c.nu_r[:3], c.nu_r[3:]
    carried = symmetric(c.parameters.added_mass) @ v
    if c.parameters.coriolis == "without-munk":
        load = load - ca.vertcat(0, 0, 0, ca.cross(v, carried))
    elif c.parameters.coriolis == "without-cross-pairs":
        across = ca.vertcat(0, omega[1:])
        munk = ca.cross(v, carried)
        load = load - ca.vertcat(ca.cross(across, carried), 0, munk[1:])
    return -load


def coriolis_load(h: Any, nu: Any) -> Any:
    """Return C(nu) nu (6,) of a momentum h = (h1, h2) and a velocity nu = (v, omega)."""
    h1, h2, v, omega = h[:3], h[3:], nu[:3], nu[3:]
    return ca.vertcat(ca.cross(omega, h1), ca.cross(omega, h2) + ca.cross(v, h1))


def damping(c: Context) -> Any:
    """Return linear and quadratic drag, axis by axis: -(linear + quadratic |nu_r|) nu_r.

    [Timm2026], eq. 49; [Paulino2015], eq. 3.38. Either is left out by coefficients of 0. Limits: no
    axis damps another; the drag of a component does not know the whole speed. Of a hull that
    floats, the share under water is damped.
    """
    p = c.parameters
    linear = ca.vertcat(p.linear_damping_force, p.linear_damping_moment)
    quadratic = ca.vertcat(p.quadratic_damping_force, p.quadratic_damping_moment)
    load = -((linear + quadratic * ca.fabs(c.nu_r)) * c.nu_r)
    return wet(c) * load if c.is_floating else load


_STRIPS = 20


def crossflow_drag(c: Context) -> Any:
    """Return the drag of the flow across a slender hull in sway and yaw, by 20 strips.

    Y = -a sum |v + x_i r| (v + x_i r) dx, N the same with the arm x_i; a = density
    crossflow_draught crossflow_coefficient / 2, dx = crossflow_length / 20, x_i the middles of
    the strips from -L/2 to L/2, v and r of nu_r (Faltinsen's strip theory, as in Fossen, 2021).

    Limits: one draught and coefficient along the hull, no shielding of one hull by another, no
    heave or pitch. Beside the integral the strips lack 0.5 % in pure yaw.
    """
    return _drag_across(c, [i + 0.5 for i in range(_STRIPS)])


def station_drag(c: Context) -> Any:
    """Return the same by the 21 ends of these strips, each with the whole width of a strip.

    T. I. Fossen's quadrature in MSS and PythonVehicleSimulator, for their craft: the end stations
    have twice the weight that the trapezoidal rule gives them. Sway alone has 5 % more than the
    integral, yaw alone 21 %.
    """
    return _drag_across(c, range(_STRIPS + 1))


def _drag_across(c: Context, places: Iterable[float]) -> Any:
    """Return the sum of `crossflow_drag` at ``places`` from the stern, in strips' widths."""
    p = c.parameters
    a = p.density * p.crossflow_draught * p.crossflow_coefficient / 2
    dx = p.crossflow_length / _STRIPS
    sway: Any = 0
    yaw: Any = 0
    for place in places:
        x = place * dx - p.crossflow_length / 2
        across = c.nu_r[1] + x * c.nu_r[5]
        drag = -a * ca.fabs(across) * across * dx
        sway, yaw = sway + drag, yaw + x * drag
    return ca.vertcat(0, sway, 0, 0, 0, yaw)


WAVES, WIND = "wave-loads", "wind-loads"


def wave_loads(c: Context) -> Any:
    """Return the load of the waves on a surface craft by strips (`seaway`); 0 in calm water.

    Limits: zero speed, mean wetted surface; see `sea.strips`. The load acts in body axes, as the
    hull's own added mass and damping do, while a conservative ``restoring`` is vertical: products
    of pitch and heave then give a mean force that is no drift of second order. An Otter at rest in
    regular waves of 0.2 m and 2.5 s moves astern by 0.13 to 0.34 m/s, whatever their direction.
    """
    return getattr(c.inputs, "wave_load", ca.DM(6, 1))


def wind_loads(c: Context) -> Any:
    """Return the load of the wind on what the craft shows to it (`windage`); 0 without wind."""
    return getattr(c.inputs, "wind_load", ca.DM(6, 1))


TERMS: dict[str, Term] = {
    "restoring": restoring,
    "coriolis": coriolis,
    "damping": damping,
    "coupled-damping": coupled_damping,
    "morison": morison,
    "crossflow-drag": crossflow_drag,
    "station-drag": station_drag,
    "point-drag": point_drag,
    "hull-lift": hull_lift,
    "body-lift": body_lift,
    "winged-body": winged_body,
    "fading-damping": fading_damping,
    "wave-making": wave_making,
    WAVES: wave_loads,
    WIND: wind_loads,
}
"""Terms by the name that a vehicle's file writes."""
OF_KITS = Registry("seatrial.terms", "term", {})
"""Terms that kits add."""


def read_terms(text: str, known: Mapping[str, Term] = TERMS) -> list[Term]:
    """Return the terms that ``text`` names, separated by spaces, in the order of the ``known``.

    Terms of kits follow, by name: the order of the text does not matter, so that the same terms
    give the same bits. Raises InputError for a name that is unknown or stands twice.
    """
    names = text.split()
    added = sorted({name for name in names if name not in known})
    for name in names:
        if name in added and name not in OF_KITS.names():
            raise InputError(f"terms: {unknown('term', name, [*known, *OF_KITS.names()])}")
        if names.count(name) > 1:
            raise InputError(f"terms: {name!r} stands twice in {text!r}; each acts once")
    own = [term for name, term in known.items() if name in names]
    return [*own, *(OF_KITS.load(name) for name in added)]


def symmetric(elements: Any) -> Any:
    """Return the symmetric matrix (3, 3) of its elements xx, yy, zz, xy, xz, yz."""
    xx, yy, zz, xy, xz, yz = ca.vertsplit(elements)
    return ca.vertcat(ca.horzcat(xx, xy, xz), ca.horzcat(xy, yy, yz), ca.horzcat(xz, yz, zz))
