"""The tether of a remotely operated vehicle."""

from __future__ import annotations

import itertools
import math
from collections.abc import Mapping
from typing import Any, ClassVar

import numpy as np

from seatrial.errors import InputError, SimulationError
from seatrial.model.component import NS, Component, Input, Output, Parameter, seconds, terminal
from seatrial.model.expressions import Vector
from seatrial.physics.sea.parameters import MeetsCurrent, MeetsWaves

from .cable import Cable
from .cable_shape import static_shape
from .cable_solver import Chain, Moved, implicit_step

_NED = ("north", "east", "down")
_STATIONS = tuple(f"s{tenth}" for tenth in range(11))
_LAYERS = tuple(f"d{number}" for number in range(1, 9))
_ENDS = ("top", "bottom")
_ACTING = ("top_position", "top_velocity", "bottom_position", "bottom_velocity", "current")


class Tether(MeetsWaves, MeetsCurrent):
    """A cable in a current between two ends that others move: N segments, lumped masses.

    [Paulino2015], eqs 3.46 to 3.53, corrected; the equations are those of `Cable`. Node 0 is the
    top (at the surface), node N the bottom (at the vehicle). All vectors are in {n}.

    **Ends.** An end is at its position input, and goes on with its velocity input until
    the next communication point, so that lengths and rates are smooth; what a prediction missed
    is made up within the next step. A position that has not changed since the last step is taken
    for one that nobody has measured since, and the end moves on from where it is: so an end with
    a velocity alone is towed along.

    **Start.** The cable starts in the static shape between the ends as they are at the first
    step, with velocities linear between those of the ends (`static_shape`).

    **Step.** Linearly implicit Euler, in equal steps not longer than ``max_step`` (see
    `implicit_step`): first order, numerically damped, stable for stiff cables.

    **Forces on the ends.** ``force`` (on the vehicle) and ``surface_force`` are what the cable
    pulls with on the mean over the coming step, of the length of the last one, if the ends move
    on as their inputs have it. They depend on the inputs at once, and with them the coupling is
    implicit in time: a force held from the end of the last step lets the longest axial wave of
    vehicle and cable grow at a rate of omega^2 h / 4. Without numbers of this instant (a master
    that reads nothing again) the ends are predicted from the step before. Half a segment at each
    end goes with the force: its weight and drag, not its inertia, m L / (2 N), which belongs to
    the body.

    **Water.** ``current`` everywhere, plus a profile over depth, piecewise linear between
    ``profile_points`` depths and constant outside them, plus current and waves of the trial at
    the middle of each segment, as they are at the end of each step of the integration (with
    stretching, `Waves.motion`).

    **Shape.** ``north``, ``east`` and ``down`` are the cable at tenths of its unstretched length,
    s0 the top, s10 the bottom, linear between nodes, whatever the number of segments. ``tension``
    is that in the first and in the last segment, and ``greatest_tension`` over all (damping
    included, 0 where slack).

    Not modelled: bending and torsion, lift, vortices, inertia of accelerating water, bottom,
    cable out of the water, ship's winch, rupture.
    """

    max_step = Parameter(
        0.01,
        "s",
        "longest step of the integration; the error is of first order",
        min=1e-6,
        max=0.01,
    )
    length = Parameter(40.0, "m", "length of the unstretched cable", min=1e-3)
    segments = Parameter(20.0, "1", "number of segments (a whole number)", min=5.0, max=200.0)
    diameter = Parameter(8.18e-3, "m", "diameter", min=1e-6)
    mass_per_length = Parameter(0.0525529, "kg/m", "mass per unstretched length", min=1e-9)
    axial_stiffness = Parameter(2e4, "N", "EA: tension per strain", min=1e-3)
    damping_ratio = Parameter(0.2, "1", "axial damping of the shortest wave", min=0.0)
    normal_drag = Parameter(1.2, "1", "drag coefficient across the cable, on d Ls", min=0.0)
    tangential_drag = Parameter(0.02, "1", "drag coefficient along the cable, on d Ls", min=0.0)
    added_mass = Parameter(1.0, "1", "added mass across the cable over displaced mass", min=0.0)
    density = Parameter(1000.0, "kg/m3", "density of the water", min=0.0)
    gravity = Parameter(9.81, "m/s2", "acceleration of gravity", min=0.0)
    profile_points = Parameter(
        0.0, "1", "depths of the current profile in use; 0 for none", min=0.0, max=len(_LAYERS)
    )
    profile_depth = Parameter(0.0, "m", "depths of the current profile, rising", axes=_LAYERS)
    profile_north = Parameter(0.0, "m/s", "current northwards at these depths", axes=_LAYERS)
    profile_east = Parameter(0.0, "m/s", "current eastwards at these depths", axes=_LAYERS)

    top_position = Input("m", "end at the surface, {n}", axes=_NED)
    top_velocity = Input("m/s", "velocity of the end at the surface over ground, {n}", axes=_NED)
    bottom_position = Input("m", "end at the vehicle, {n}", axes=_NED, start=(0.0, 0.0, 40.0))
    bottom_velocity = Input("m/s", "velocity of the end at the vehicle over ground, {n}", axes=_NED)
    current = Input("m/s", "velocity of the water, uniform part, {n}", axes=_NED, optional=True)

    force = Output("N", "force on the vehicle, mean over the coming step, {n}", axes=_NED)
    surface_force = Output(
        "N", "force on the end at the surface, mean over the coming step, {n}", axes=_NED
    )
    tension = Output("N", "tension in the first and in the last segment", axes=_ENDS)
    greatest_tension = Output("N", "greatest tension of all segments")
    north = Output("m", "cable at tenths of its length from the top: north", axes=_STATIONS)
    east = Output("m", "cable at tenths of its length from the top: east", axes=_STATIONS)
    down = Output("m", "cable at tenths of its length from the top: down", axes=_STATIONS)

    terminals: ClassVar = {
        "top": terminal(point="top_position", velocity="top_velocity", force="surface_force"),
        "bottom": terminal(point="bottom_position", velocity="bottom_velocity", force="force"),
    }
    # Positions are taken at instants, forces hold for a step: a master must not extrapolate them.
    discrete = True
    views: ClassVar = {"line": {"north": "north", "east": "east", "down": "down"}}
    # From the first step on these follow from the nodes.
    feedthrough: ClassVar = dict.fromkeys(
        ("tension", "greatest_tension", "north", "east", "down"), ()
    )
    transient = Component.transient | {"_cable", "_chain", "_known", "_waves", "_stream"}

    _x: Vector | None
    _v: Vector | None
    _seen: list[float]
    _h_ns: int
    _known: tuple[object, Moved] | None

    def start(self, t: float) -> None:
        """Prepare the cable; raises InputError for segments, a profile or a sea that cannot be."""
        for name in ("segments", "profile_points"):
            if getattr(self, name) % 1.0:
                raise InputError(
                    f"{self.name}.{name} is {getattr(self, name)!r}, a whole number is needed"
                )
        depths = self.profile_depth[: int(self.profile_points)]
        if any(b <= a for a, b in itertools.pairwise(depths)):
            raise InputError(f"{self.name}.profile_depth is {depths!r} m, depths must rise")
        self._x, self._v = None, None
        self._seen = []
        self._h_ns = 0
        self._prepare()

    def step(self, t: float, h: float) -> None:
        """Move the cable from ``t`` to ``t + h``."""
        moved = self._moved(t, h)
        self._seen = [*self.top_position, *self.bottom_position]
        self._h_ns = round(h * NS)
        self._x, self._v = moved.x, moved.v
        self._known = None

    def outputs(self, t: float) -> None:
        """Publish the cable as it is, and the forces of the step to come."""
        x, v = self._state(t)
        s = self._cable.forces(x, v, self._water(t, x))
        if self._h_ns:
            pull = self._moved(t, seconds(self._h_ns)).pull
        else:
            pull = self._cable.node_forces(s)[:, [0, -1]]
        self.surface_force, self.force = pull.T.tolist()
        tensions = np.where(s.tension > 0.0, s.axial, 0.0)
        self.tension = tensions[[0, -1]].tolist()
        self.greatest_tension = float(tensions.max())
        nodes = np.linspace(0.0, len(_STATIONS) - 1.0, x.shape[1])
        for name, row in zip(_NED, x, strict=True):
            setattr(self, name, np.interp(range(len(_STATIONS)), nodes, row).tolist())

    def set_state(self, state: Mapping[str, Any]) -> None:
        """Restore what `get_state` returned."""
        super().set_state(state)
        if "_x" in state:
            self._prepare()

    # ------------------------------------------------------------------ inside

    def _prepare(self) -> None:
        points = int(self.profile_points)
        self._cable = Cable(
            length=self.length,
            segments=int(self.segments),
            diameter=self.diameter,
            mass_per_length=self.mass_per_length,
            axial_stiffness=self.axial_stiffness,
            damping_ratio=self.damping_ratio,
            normal_drag=self.normal_drag,
            tangential_drag=self.tangential_drag,
            added_mass=self.added_mass,
            density=self.density,
            gravity=self.gravity,
            profile_depth=self.profile_depth[:points],
            profile_velocity=(self.profile_north[:points], self.profile_east[:points]),
        )
        self._chain = Chain(int(self.segments) - 1)
        self._known = None
        self._waves, stream = self.sea_state().waves(), self.current_state()
        self._stream = None if stream.is_absent else stream

    def _water(self, t: float, x: Vector) -> Vector:
        """Return the velocity of the water but for the profile, m/s in {n}: (3, 1) or (3, N)."""
        uniform = np.array(self.current)[:, None]
        if self._waves is None and self._stream is None:
            return uniform
        middles = 0.5 * (x[:, 1:] + x[:, :-1])
        water = np.repeat(uniform, middles.shape[1], axis=1)
        if self._waves is not None:
            water += self._waves.motion(t, middles.T).velocity.T
        if self._stream is not None:
            water[:2] += np.transpose([self._stream.velocity(t, z) for z in middles[2].tolist()])
        return water

    def _state(self, t: float) -> tuple[Vector, Vector]:
        """Return node positions and velocities; before the first step they follow from inputs."""
        if self._x is not None and self._v is not None:
            return self._x, self._v
        velocities = np.linspace(self.top_velocity, self.bottom_velocity, int(self.segments) + 1).T
        top, bottom = np.array(self.top_position), np.array(self.bottom_position)
        straight = np.linspace(top, bottom, int(self.segments) + 1).T
        water = self._water(t, straight)
        shape = static_shape(self._cable, top, bottom, velocities, water)
        return shape, velocities

    def _moved(self, t: float, h: float) -> Moved:
        """Return where the cable is ``h`` s after ``t``, and its mean pull until then.

        Outputs and step ask for the same: it is computed once as long as nothing changes.
        """
        asked = (t, h, *(getattr(self, name) for name in _ACTING))
        if self._known is not None and self._known[0] == asked:
            return self._known[1]
        moved = self._integrated(t, h)
        self._known = asked, moved
        return moved

    def _integrated(self, t: float, h: float) -> Moved:
        x, v = self._state(t)
        count = max(1, math.ceil(h / self.max_step - 1e-9))
        goals = self._goals(x, h)
        v = v.copy()
        v[:, [0, -1]] = (goals - x[:, [0, -1]]) / h
        pull = np.zeros((3, 2))
        try:
            for number in range(count):
                water = self._water(t + (number + 1) * h / count, x)
                moved = implicit_step(self._cable, self._chain, x, v, water, h / count)
                x, v, pull = moved.x, moved.v, pull + moved.pull
        except ArithmeticError as error:
            raise SimulationError(f"{self.name}: {error} at t = {self.now!r} s") from None
        x[:, [0, -1]] = goals  # without the round-off of the sum
        return Moved(x, v, pull / count)

    def _goals(self, x: Vector, h: float) -> Vector:
        """Return where the two ends are after ``h`` s, (3, 2)."""
        goals = np.empty((3, 2))
        for end, node in ((0, 0), (1, -1)):
            position = (self.top_position, self.bottom_position)[end]
            velocity = (self.top_velocity, self.bottom_velocity)[end]
            known = self._seen[3 * end : 3 * end + 3]
            begin = x[:, node] if list(position) == known else np.array(position)
            goals[:, end] = begin + h * np.array(velocity)
        return goals
