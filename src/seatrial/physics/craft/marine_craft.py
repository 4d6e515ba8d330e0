"""A surface or submerged craft in six degrees of freedom."""

from __future__ import annotations

from collections.abc import Mapping
from types import SimpleNamespace
from typing import Any, ClassVar

import casadi as ca

from ...errors import InputError
from ...model.component import Parameter
from ...model.expressions import Vector
from ...model.plant import State
from ...model.ports import Output
from ...model.terminals import MOTION
from ..sea.loads import Response
from ..sea.winds import WindState
from .large_angles import HARMONICS, righting_arms, sine_series
from .seaway import WindySeaway
from .six_dof import LOADS, SixDofCraft, six_dof_motion
from .terms.hydrodynamics import WAVES, WIND
from .wave_hull import HullCoefficients
from .windage import WindLoad


class MarineCraft(WindySeaway, SixDofCraft):
    """Rigid craft in water, surface or submerged: `SixDofCraft` with position and attitude.

    eta = (position, attitude): the body origin in north-east-down, m, and the Euler angles,
    rad; nu = (u, v, w, p, q, r): velocity of the body origin over ground and angular rate, in
    body axes (x bow, y starboard, z down); eta' = J(eta) nu. [Timm2026], eqs 10, 11 and 36.
    Singular at theta = +-90 degrees.

    **Sea.** With a surface form of restoring, the waves of a trial act by ``wave-loads`` on the
    sections of the hull (`wave_hull`), its wind by ``wind-loads`` on the windage (`windage`);
    otherwise the craft moves in the moving water, as `SixDofCraft` says.

    **Current.** The water moves steadily and uniformly in {n}, so that in body axes its
    velocity turns.

    **Terms** (`hydrodynamics`): ``restoring`` and ``coriolis`` say in which form theirs act.
    """

    max_step = Parameter(
        0.01,
        "s",
        "longest integration sub-step; from 0.02 on a small craft's pitch damping diverges",
        min=1e-6,
        max=0.01,
    )
    restoring = Parameter(
        "surface-conservative",
        "1",
        "form of the restoring forces",
        choices=(
            *("surface-linear", "surface-conservative", "surface-curve"),
            *("submerged", "floating"),
        ),
    )
    density = Parameter(1025.0, "kg/m3", "density of the water", min=0.0)
    waterplane_area = Parameter(0.0, "m2", "waterplane area (surface)", min=0.0)
    GM_T = Parameter(0.0, "m", "transverse metacentric height (surface)")
    righting_arm = Parameter(
        0.0, "m", "a_k of GZ = sum a_k sin(k phi) (surface-curve); all 0: of the sections",
        axes=[f"a{k}" for k in range(1, HARMONICS + 1)],
    )  # fmt: skip
    GM_L = Parameter(0.0, "m", "longitudinal metacentric height (surface)")
    center_of_flotation = Parameter(
        0.0, "m", "centroid of the waterplane from the body origin, body axes (surface)", axes="xy"
    )
    buoyancy = Parameter(9.81, "N", "buoyancy force (submerged, floating)", min=0.0)
    center_of_buoyancy = Parameter(
        0.0,
        "m",
        "centre of buoyancy from the body origin, body axes (submerged, floating)",
        axes="xyz",
    )

    position = State("m", "body origin in north-east-down", axes="xyz", frame="n")
    attitude = State("rad", "Euler angles, ZYX", axes=("phi", "theta", "psi"))
    velocity = State(
        "m/s", "velocity of the body origin over ground, body axes", axes=("u", "v", "w")
    )
    rates = State("rad/s", "angular velocity, body axes", axes=("p", "q", "r"))
    acceleration = Output(
        "m/s2",
        "inertial acceleration of the body origin, dv/dt + omega x v, body axes",
        axes="xyz",
        frame="b",
    )

    terminals: ClassVar = {**SixDofCraft.terminals, "motion": MOTION}
    feedthrough: ClassVar = {**SixDofCraft.feedthrough, "acceleration": (*LOADS, "current")}

    def start(self, t: float) -> None:
        """Find the righting arm of a craft that has its curve; raises InputError as `slices`."""
        if self.restoring == "surface-curve" and not any(self.righting_arm):
            arms = sine_series(self.slices(), self.mass / self.density, self.GM_T)
            self.set("righting_arm", arms.tolist())
        super().start(t)

    def righting_arms(self, phi: Vector) -> Vector:
        """Return GZ, m, at angles of heel, rad. Raises InputError as `slices`."""
        return righting_arms(self.slices(), self.mass / self.density, self.GM_T, phi)

    def wave_response(self) -> Response | None:
        """Return the loads of the waves by strips, of a surface form of restoring, else None."""
        if not self._is_at_surface:
            return None
        self._require_term(WAVES, "waves")
        added, turning = self.added_mass, self.added_inertia
        damping, slowing = self.linear_damping_force, self.linear_damping_moment
        own = HullCoefficients(
            heave=(added[2], damping[2]),
            sway=(added[1], damping[1]),
            roll=(turning[0], slowing[0]),
            pitch=(turning[1], slowing[1]),
            roll_by_sway_mass=self.added_coupling[3],
        )
        return self.hull_loads(own, self.density, self.gravity, self.waterplane_area).forces

    def wind_over_it(self) -> tuple[WindState, WindLoad, float] | None:
        """Return wind and its load on a craft that is above water, or None."""
        if not self._is_at_surface:
            return None
        found = super().wind_over_it()
        if found is not None:
            self._require_term(WIND, "wind")
        return found

    def _require_term(self, term: str, met: str) -> None:
        if term not in self.terms.split():
            raise InputError(
                f"{self.name}: it meets {met}, and its terms are {self.terms!r}: {term} is missing"
            )

    @property
    def _is_at_surface(self) -> bool:
        return str(self.restoring).startswith("surface")

    def equations(
        self, x: SimpleNamespace, u: SimpleNamespace, p: SimpleNamespace
    ) -> tuple[Mapping[str, Any], Mapping[str, Any]]:
        """Return the derivatives of eta and nu, the acceleration and the attachment's motion."""
        nu = ca.vertcat(x.velocity, x.rates)
        changes, outputs = six_dof_motion(x.position, x.attitude, nu, u, p)
        return vars(changes), outputs
