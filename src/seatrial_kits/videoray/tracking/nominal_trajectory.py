"""Nominal trajectory of a vessel without sway force, and its feedforward commands."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any, ClassVar

from seatrial.errors import InputError
from seatrial.model.component import Output, Parameter
from seatrial.model.sampled import Sampled

from .vessel_nominal import Nominal, Profile, VesselModel, nominal_motion

_UVR = ("m/s", "m/s", "rad/s")
_PROFILES = ("constant", "polynomial")


class NominalTrajectory(Sampled):
    """Nominal velocities (U, V, R) of a `SurfaceVessel` and the commands that give them.

    Surge U and yaw rate R each have a profile: "constant", or "polynomial", which rises from 0
    to the value within ``duration`` T and is held from then on ([Paulino2015], section 6.1):

        value (10 x^3 - 15 x^4 + 6 x^5),   x = t / T,   t from the start of the run

    Sway V and the commands follow from the model (6.1 to 6.3, corrected):

        m22 V' + d22 V + m11 U R = 0,   at the start V = -m11 U R / d22
        X = m11 U' + d11 U - m22 V R,   N = m33 R' + d33 R - s (m11 - m22) U V
        t1 = (X + N / l) / (2 E1),      t2 = (X - N / l) / (2 E2)

    Everything is computed at the start, sample by sample, and looked up afterwards; after the
    last row the motion is steady. ``nominal_command`` is not limited: what is beyond +-1 no
    thruster can give. Used by itself this is control without feedback.

    The model's parameters are those of `SurfaceVessel` and have its signs: a vehicle file's
    table for the vessel serves here too. s = ``yaw_coupling_sign`` = 1 unless table 8.1 of the
    source is to be reproduced.

    Raises InputError at the start without damping of sway, for a full thrust of 0, a sign
    other than 1 and -1, or a trajectory of more than 500000 samples.
    """

    exercised: ClassVar = {"surge_profile": "polynomial", "duration": 1.0}

    transient = Sampled.transient | {"_rows"}
    structural: ClassVar[Sequence[str]] = (
        *("period", "mass", "damping", "thrust", "lever_arm", "yaw_coupling_sign"),
        *("surge", "yaw_rate", "duration"),
    )
    tabulated: ClassVar = {"_prepare": ("_rows",)}

    period = Parameter(0.1, "s", "sample period", min=1e-6)
    mass = Parameter(
        1.0, ("kg", "kg", "kg.m2"), "mass and inertia with added mass", axes="uvr", min=1e-9
    )
    damping = Parameter(
        (0.0, 1.0, 0.0),
        ("N.s/m", "N.s/m", "N.m.s/rad"),
        "linear damping",
        axes="uvr",
        min=0.0,
    )
    thrust = Parameter(1.0, "N", "thrust of each thruster at command 1", axes=("t1", "t2"))
    lever_arm = Parameter(1.0, "m", "thrusters from the centre line", min=1e-9)
    yaw_coupling_sign = Parameter(
        1.0, "1", "s: 1, or -1 to reproduce table 8.1 of the source", min=-1.0, max=1.0
    )
    surge_profile = Parameter("constant", "1", "how U goes over time", choices=_PROFILES)
    surge = Parameter(0.05, "m/s", "U, in the end")
    yaw_profile = Parameter("constant", "1", "how R goes over time", choices=_PROFILES)
    yaw_rate = Parameter(0.2, "rad/s", "R, in the end, positive to starboard")
    duration = Parameter(240.0, "s", "T, in which a polynomial rises", min=1e-6)

    nominal = Output(_UVR, "nominal velocity ahead and to starboard and yaw rate", axes="uvr")
    nominal_command = Output(
        "1", "share of each thruster's full thrust that the trajectory needs", axes=("t1", "t2")
    )

    def reset(self, t: float) -> None:
        """Compute the trajectory; raises InputError for a model that has none."""
        self._prepare()

    def set_state(self, state: Mapping[str, Any]) -> None:
        """Restore what `get_state` returned; the trajectory is computed again."""
        super().set_state(state)
        if "_next" in state:
            self._prepare()

    def sample(self, t: float, k: int) -> None:
        """Publish the trajectory."""
        row = self._row(k)
        self.nominal, self.nominal_command = row.velocity, row.command

    def _prepare(self) -> None:
        """Compute what is only looked up during the run."""
        if abs(self.yaw_coupling_sign) != 1.0:
            raise InputError(
                f"{self.name}.yaw_coupling_sign is {self.yaw_coupling_sign!r}, allowed -1.0 or 1.0"
            )
        if not all(self.thrust):
            raise InputError(
                f"{self.name}.thrust is {list(self.thrust)} N: each thruster needs one other than 0"
            )
        surge, yaw = (
            Profile(value, self.duration if profile == "polynomial" else 0.0)
            for value, profile in (
                (self.surge, self.surge_profile),
                (self.yaw_rate, self.yaw_profile),
            )
        )
        try:
            self._rows = nominal_motion(self.vessel(), surge, yaw, self.period)
        except InputError as error:
            raise InputError(f"{self.name}: {error}") from None

    def vessel(self) -> VesselModel:
        """Return the model of the vessel that the parameters are."""
        return VesselModel(
            self.mass, self.damping, self.thrust, self.lever_arm, self.yaw_coupling_sign
        )

    def _row(self, k: int) -> Nominal:
        return self._rows[min(k, len(self._rows) - 1)]
