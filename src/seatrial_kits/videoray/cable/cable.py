"""Forces in a cable of lumped masses, and their Jacobians.

Arrays have one column per node or per segment: (3, N + 1) or (3, N), north-east-down rows. Node 0
is the end at the surface, node N the end at the vehicle; segment i (from 1) joins nodes i - 1 and
i and is column i - 1.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from seatrial.model.expressions import Vector

_TINY = 1e-300
"""Added to lengths that may be zero where a vector of length zero is divided by them."""


class Segments(NamedTuple):
    """Motion and forces of the N segments; vectors are (3, N), {n}, the rest (N,).

    ``tangent`` t towards the vehicle; ``length`` Ls (m); ``parting`` w, velocity of the far node
    less that of the near one, and ``stretching`` w . t (m/s); ``tension`` T and ``axial`` T + P
    (N), and ``stiffness`` dT/dLs (N/m); flow ``along`` U . t and ``across`` Un with
    ``speed_across`` |Un|, and ``drag`` on the whole segment (N); ``shear`` d v_c / d z (1/s).
    """

    tangent: Vector
    length: Vector
    parting: Vector
    stretching: Vector
    tension: Vector
    axial: Vector
    stiffness: Vector
    along: Vector
    across: Vector
    speed_across: Vector
    drag: Vector
    shear: Vector


class Slopes(NamedTuple):
    """Jacobians of a segment's forces, (3, 3, N): row = force, column = motion.

    ``pull`` of (T + P) t and ``drag`` to the position difference R (N/m); ``damping`` of P t to
    the velocity difference w, ``flow`` of the drag to U (N.s/m); ``shear`` (3, N) of the drag to
    the depth of the middle (N/m).
    """

    pull: Vector
    drag: Vector
    damping: Vector
    flow: Vector
    shear: Vector


@dataclass(frozen=True)
class Cable:
    """A cable of N equal segments: [Paulino2015], eqs 3.46 to 3.53, corrected.

    With R = x_i - x_(i-1), Ls = |R|, t = R / Ls, l0 = L / N, k = EA / l0:

        T  = k (Ls - l0), 0 where slack                                                  (3.47)
        P  = c (x'_i - x'_(i-1)) . t,  c = damping_ratio sqrt(EA m)                      (3.49)
        U  = v_c - (x'_i + x'_(i-1)) / 2,  Ut = (U . t) t,  Un = U - Ut                  (3.52-53)
        Fd = density d (Cn |Un| Un + Ct |Ut| Ut) Ls / 2                                  (3.51)
        F_i = (T + P)_(i+1) t_(i+1) - (T + P)_i t_i + (Fd_i + Fd_(i+1)) / 2 + weight l   (3.46)
        M_i = m l I + density A Ca l (I - t t^T)

    l = l0 for a node between two segments and l0 / 2 for an end, t in M_i the mean tangent of the
    two, weight = (m - density A) g downwards per length. v_c is the current at the depth of the
    segment's middle. P acts on a slack segment too.

    Corrections to the source: R is a difference of positions (3.48), the bracket of 3.47 has the
    scalar |R|, the lower segment pulls with a minus sign (3.46), velocities have no dots (3.52).
    Not in the source and assumed: added mass across the cable only, and c by a damping ratio of
    the shortest wave: omega = 2 sqrt(k / (m l0)), c omega / 2 k = damping_ratio.
    """

    length: float
    segments: int
    diameter: float
    mass_per_length: float
    axial_stiffness: float
    damping_ratio: float
    normal_drag: float
    tangential_drag: float
    added_mass: float
    density: float
    gravity: float
    profile_depth: tuple[float, ...] = ()
    """Depths (m), rising, at which ``profile_velocity`` holds; none for a uniform current."""
    profile_velocity: tuple[tuple[float, ...], tuple[float, ...]] = ((), ())
    """Northward and eastward current (m/s) at these depths, to be added to the uniform one."""

    @cached_property
    def l0(self) -> float:
        """Length of an unstretched segment, m."""
        return self.length / self.segments

    @cached_property
    def area(self) -> float:
        """Area of the cross-section, m2."""
        return math.pi / 4.0 * self.diameter**2

    @cached_property
    def spring(self) -> float:
        """Stiffness of a segment, EA / l0, N/m."""
        return self.axial_stiffness / self.l0

    @cached_property
    def damper(self) -> float:
        """Axial damping of a segment, c, N.s/m."""
        return self.damping_ratio * math.sqrt(self.axial_stiffness * self.mass_per_length)

    @cached_property
    def lumps(self) -> Vector:
        """Length of cable that each node stands for, (N + 1,), m."""
        lumps = np.full(self.segments + 1, self.l0)
        lumps[0] = lumps[-1] = self.l0 / 2.0
        return lumps

    @cached_property
    def weight(self) -> Vector:
        """Weight less buoyancy of each node's lump, downwards, (N + 1,), N."""
        in_water = self.mass_per_length - self.density * self.area
        return in_water * self.gravity * self.lumps

    @cached_property
    def _half_drag(self) -> float:
        return 0.5 * self.density * self.diameter

    def water(self, depth: Vector, current: Vector) -> tuple[Vector, Vector]:
        """Return velocity and shear d v_c / d z of the water at depths (n,) m: (3, n) each.

        ``current``, m/s, (3, 1) or (3, n), is added. The profile is piecewise linear and
        constant above its first and below its last depth.
        """
        shear = np.zeros((3, depth.size))
        velocity = shear + current
        if self.profile_depth:
            for axis, values in enumerate(self.profile_velocity):
                velocity[axis] += np.interp(depth, self.profile_depth, values)
                slopes = np.diff(values) / np.diff(self.profile_depth)
                layer = np.searchsorted(self.profile_depth, depth)
                shear[axis] = np.concatenate(([0.0], slopes, [0.0]))[layer]
        return velocity, shear

    def forces(
        self, x: Vector, v: Vector, current: Vector, *, compression: bool = False
    ) -> Segments:
        """Return the forces at node positions ``x`` and velocities ``v``, (3, N + 1), {n}.

        ``current`` (3, 1) or (3, N), m/s. With ``compression`` a segment pushes as it pulls.
        """
        R = x[:, 1:] - x[:, :-1]
        length = np.sqrt(np.einsum("ij,ij->j", R, R)) + _TINY
        tangent = R / length
        parting = v[:, 1:] - v[:, :-1]
        stretching = np.einsum("ij,ij->j", parting, tangent)
        tension = self.spring * (length - self.l0)
        stiffness = np.full(self.segments, self.spring)
        if not compression:
            slack = tension <= 0.0
            tension[slack] = stiffness[slack] = 0.0
        water, shear = self.water(0.5 * (x[2, 1:] + x[2, :-1]), current)
        U = water - 0.5 * (v[:, 1:] + v[:, :-1])
        along = np.einsum("ij,ij->j", U, tangent)
        across = U - along * tangent
        speed_across = np.sqrt(np.einsum("ij,ij->j", across, across))
        normal = (self._half_drag * self.normal_drag) * length * speed_across
        tangential = (self._half_drag * self.tangential_drag) * length * np.abs(along) * along
        return Segments(
            tangent=tangent,
            length=length,
            parting=parting,
            stretching=stretching,
            tension=tension,
            axial=tension + self.damper * stretching,
            stiffness=stiffness,
            along=along,
            across=across,
            speed_across=speed_across,
            drag=normal * across + tangential * tangent,
            shear=shear,
        )

    def switched(self, s: Segments, taut: NDArray[np.bool_]) -> Segments:
        """Return the forces with other segments taken for taut, (N,), than those that are.

        A segment that is taken for taut too early pushes.
        """
        tension = np.where(taut, self.spring * (s.length - self.l0), 0.0)
        return s._replace(
            tension=tension,
            axial=tension + self.damper * s.stretching,
            stiffness=np.where(taut, self.spring, 0.0),
        )

    def node_forces(self, s: Segments) -> Vector:
        """Return the force on every node, ends included, (3, N + 1), N.

        Those on the two ends, which have no reaction in them, are what the cable pulls with.
        """
        return self.gathered(s.axial * s.tangent, s.drag)

    def gathered(self, pull: Vector, drag: Vector) -> Vector:
        """Return the force on every node, (3, N + 1), of segments' ``pull`` and ``drag`` (3, N), N.

        A segment pulls at its near node and, the other way, at its far one; its drag and weight
        are shared by both.
        """
        half = 0.5 * drag
        force = np.zeros((3, self.segments + 1))
        force[2] = self.weight
        force[:, :-1] += half + pull
        force[:, 1:] += half - pull
        return force

    def slopes(self, s: Segments, geometric: Vector) -> Slopes:
        """Return the Jacobians of a segment's forces.

        ``geometric`` (N,), N, is the axial force that turns with the segment: ``s.axial``, or an
        estimate of it.
        """
        t, across, eye = s.tangent, s.across, _EYE
        tt = t[:, None] * t
        turn = geometric / s.length
        damped = self.damper / s.length * (s.parting - s.stretching * t)
        pull = (s.stiffness - turn) * tt + turn * eye + t[:, None] * damped
        speed, along = s.speed_across, s.along
        kn, kt = self._half_drag * self.normal_drag, self._half_drag * self.tangential_drag
        # Un Un^T / |Un|; zero where there is no flow across.
        rest = across[:, None] * (across / (speed + _TINY))
        projected = speed * (eye - tt)
        drag = (
            kn * (speed * across)[:, None] * t
            + t[:, None] * ((2.0 * kt * np.abs(along) - kn * speed) * across)
            - (kn * along) * (rest + projected)
            + (kt * np.abs(along) * along) * eye
        )
        flow = s.length * (kn * (projected + rest) + (2.0 * kt * np.abs(along)) * tt)
        shear = np.einsum("ijk,jk->ik", flow, s.shear)
        return Slopes(pull, drag, self.damper * tt, flow, shear)

    def masses(self, s: Segments) -> Vector:
        """Return the mass matrix of every node, (3, 3, N + 1), kg."""
        t = self._mean_tangent(s)
        return (self._own + self._added) * _EYE - (self._added * t[:, None]) * t

    def accelerations(self, s: Segments) -> Vector:
        """Return the acceleration of every node as if it were free, (3, N + 1), m/s2.

        M_i is inverted by Sherman and Morrison's formula.
        """
        t, force = self._mean_tangent(s), self.node_forces(s)
        along = np.einsum("ij,ij->j", t, force)
        square = np.einsum("ij,ij->j", t, t)  # 1, or 0 where the cable is folded
        share = self._added * along / (self._own + self._added * (1.0 - square))
        accelerations: Vector = (force + share * t) / (self._own + self._added)
        return accelerations

    @cached_property
    def _own(self) -> Vector:
        return self.mass_per_length * self.lumps

    @cached_property
    def _added(self) -> Vector:
        return self.density * self.area * self.added_mass * self.lumps

    def _mean_tangent(self, s: Segments) -> Vector:
        total = np.zeros((3, self.segments + 1))
        total[:, :-1] += s.tangent
        total[:, 1:] += s.tangent
        mean: Vector = total / (np.sqrt(np.einsum("ij,ij->j", total, total)) + _TINY)
        return mean


_EYE = np.eye(3)[:, :, None]
