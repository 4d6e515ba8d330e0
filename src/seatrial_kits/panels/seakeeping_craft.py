"""A surface craft by the tables of a panel code: added mass, memory of waves, excitation."""

from __future__ import annotations

from collections.abc import Mapping
from functools import lru_cache, partial
from pathlib import Path
from types import SimpleNamespace
from typing import Any, ClassVar

import casadi as ca
import numpy as np

from seatrial.errors import InputError
from seatrial.files.whole_file import stamp
from seatrial.model.component import Parameter
from seatrial.model.plant import State
from seatrial.model.ports import Output
from seatrial.physics.craft.marine_craft import MarineCraft
from seatrial.physics.craft.six_dof import six_dof_motion, velocity_through_water
from seatrial.physics.craft.symbolic import rotation_matrix
from seatrial.physics.craft.terms.context import Context
from seatrial.physics.craft.terms.hydrodynamics import TERMS, WAVES, Term, read_terms
from seatrial.physics.sea.loads import Response

from .memory import GROUPS, MODES, MOTIONS, Memory, memories
from .panel_files import read_panels
from .panels import PanelTables

RADIATION = "radiation"
_MODES = [f"{group}{mode}" for group in ("x", "y") for mode in range(1, MODES + 1)]
_COUPLINGS = [f"{mode}{axis}" for mode in _MODES for axis in range(1, 4)]
_ROWS, _COLUMNS = np.tril_indices(MODES)
_PAIRS = [
    f"{group}{i + 1}_{j + 1}" for group in ("x", "y") for i, j in zip(_ROWS, _COLUMNS, strict=True)
]
_TENSOR = ((0, 0), (1, 1), (2, 2), (0, 1), (0, 2), (1, 2))
_LONG_WAVES = 0.15
"""Of the waterplane's stiffness: else table and restoring are of different hulls, or units."""


def radiation(c: Context) -> Any:
    """Return what radiated waves hold the hull back with: -B^T p of `memory`, 0 at rest.

    Limits: zero speed, small motions about the mean water line.
    """
    return -_coupling(c.parameters).T @ c.inputs.memory[: 2 * MODES]


_TERMS: dict[str, Term] = {**TERMS, RADIATION: radiation}


class SeakeepingCraft(MarineCraft):
    """`MarineCraft` with the frequency-dependent hydrodynamics of a panel code ([Cummins1962]).

        (M_RB + A_inf) nu_r' + integral of K(t - s) nu_r(s) ds = tau + the terms

    ``panel_file`` is Capytaine's NetCDF or WAMIT's .1 with its .3 beside it (`panel_files`).
    From it come A_inf (``added_mass``, ``added_inertia``, ``added_coupling``, which the vehicle's
    file leaves out), the memory K as states (`memory`, term ``radiation``), fitted at the
    start (``radiation_missed`` says how nearly, motion by motion), and in waves the excitation with
    its diffraction (term ``wave-loads``), no strips.
    ``linear_damping_force`` and its like then hold what is not potential flow: viscous damping,
    above all in roll. Restoring is the vehicle file's.

    The hull has a centre plane; ``panel_place`` is the origin of the panel code's axes, on the
    water line, whose moments it gives.
    """

    terms = Parameter(
        "restoring coriolis damping radiation wave-loads",
        "1",
        "terms of the equations, by the names of seatrial.physics.craft.terms.hydrodynamics, with "
        "spaces; and radiation",
        check=partial(read_terms, known=_TERMS),
    )
    panel_file = Parameter(
        "",
        "1",
        "tables of a panel code: Capytaine's .nc, or WAMIT's .1 with .3 beside",
        role="file",
    )
    panel_place = Parameter(
        0.0, "m", "origin of the panel code's axes from the body origin, body axes", axes="xz"
    )
    panel_length = Parameter(1.0, "m", "length that WAMIT's tables are made of (ULEN)", min=1e-6)
    memory_omega = Parameter(
        0.0, "rad/s", "modes of the memory; from panel_file", axes=_MODES, min=0.0
    )
    memory_coupling = Parameter(
        0.0,
        "1",
        "B of the memory, kg^0.5 and kg^0.5 m, of surge, heave, pitch (x) and sway, roll, yaw "
        "(y); from panel_file",
        axes=_COUPLINGS,
    )
    memory_damping = Parameter(
        0.0, "rad/s", "R of the memory, lower half by rows; from panel_file", axes=_PAIRS
    )

    memory_missed = Parameter(
        0.0, "1", "share of each motion's radiation that the memory misses; from panel_file",
        axes=MOTIONS, min=0.0,
    )  # fmt: skip
    radiation_missed = Output(
        "1", "share of each motion's radiation in the tables that the memory misses", axes=MOTIONS
    )

    memory = State(
        "1",
        "p and q of the memory of radiated waves, J^0.5",
        axes=[s + m for s in "pq" for m in _MODES],
    )

    terminals: ClassVar = MarineCraft.terminals
    feedthrough: ClassVar = {**MarineCraft.feedthrough, "radiation_missed": ()}

    def start(self, t: float) -> None:
        """Fill added mass and memory from the file. Raises InputError for one that is not fit."""
        if self.panel_file:
            self._require_term(RADIATION, "radiated waves")
            self._fill(self._tables())
        super().start(t)

    def wave_response(self) -> Response | None:
        """Return the excitation of the file, or that of strips without one."""
        if not self.panel_file:
            return super().wave_response()
        if not self._is_at_surface:
            raise InputError(
                f"{self.name}: restoring is {self.restoring!r}: panel_file is of a hull at the "
                "surface, surface-linear or surface-conservative is needed"
            )
        self._require_term(WAVES, "waves")
        return self._tables().response(self.panel_place[0], self.gravity)

    def equations(
        self, x: SimpleNamespace, u: SimpleNamespace, p: SimpleNamespace
    ) -> tuple[Mapping[str, Any], Mapping[str, Any]]:
        """Return the derivatives of eta, nu and the memory, the acceleration and the attachment."""
        nu = ca.vertcat(x.velocity, x.rates)
        u = SimpleNamespace(**vars(u), memory=x.memory)
        changes, outputs = six_dof_motion(x.position, x.attitude, nu, u, p, known=_TERMS)
        modes, springs = x.memory[: 2 * MODES], x.memory[2 * MODES :]
        driven = _coupling(p) @ velocity_through_water(rotation_matrix(x.attitude), nu, u)
        p_dot = driven - _damping(p) @ modes - p.memory_omega * springs
        memory = ca.vertcat(p_dot, p.memory_omega * modes)
        return {**vars(changes), "memory": memory}, {**outputs, "radiation_missed": p.memory_missed}

    # ------------------------------------------------------------------ inside

    def _tables(self) -> PanelTables:
        path = Path(self.panel_file)
        x, z = self.panel_place
        stamps = stamp(path), stamp(path.with_suffix(".3"))
        tables = _read(path, stamps, self.density, self.gravity, self.panel_length, x, z)
        k = self.density * self.gravity * self.waterplane_area
        # In long waves the craft is to follow the surface: F + A w^2 - i w B tends to k.
        w = tables.wave_omega[0]
        lifted = -tables.excitation[2, 0]
        still = lifted.mean() + np.interp(w, tables.omega, tables.added[:, 2, 2]) * w**2
        if self._is_at_surface and not abs(still.real - k) <= _LONG_WAVES * k:
            raise InputError(
                f"{self.name}: in long waves the tables of {path} lift the hull by "
                f"{still.real:.4g} N/m, and its waterplane has {k:.4g} N/m: check panel_length, "
                "density and waterplane_area"
            )
        return tables

    def _fill(self, tables: PanelTables) -> None:
        """Set the parameters that the file says; they are 0 in the vehicle's file, or the same."""
        infinite = 0.5 * (tables.infinite + tables.infinite.T)
        found = {
            "added_mass": [infinite[i, j] for i, j in _TENSOR],
            "added_inertia": [infinite[3 + i, 3 + j] for i, j in _TENSOR],
            "added_coupling": infinite[:3, 3:].ravel().tolist(),
            **_parameters(_memories(Path(self.panel_file), tables)),
        }
        for name, values in found.items():
            now = np.array(getattr(self, name))
            if now.any() and not np.array_equal(now, values):
                raise InputError(
                    f"{self.name}: {name} is given, and panel_file has it too: leave one out"
                )
            self.set(name, values)


@lru_cache(16)
def _read(
    path: Path,
    stamps: tuple[tuple[int, int], ...],
    density: float,
    gravity: float,
    length: float,
    x: float,
    z: float,
) -> PanelTables:
    return read_panels(path, density, gravity, length).moved(np.array([x, 0.0, z]))


@lru_cache(16)
def _memories(path: Path, tables: PanelTables) -> list[Memory]:
    try:
        return memories(tables.omega, tables.added, tables.damping, tables.infinite)
    except InputError as error:
        raise InputError(f"{path}: {error}") from None


def _parameters(found: list[Memory]) -> dict[str, list[float]]:
    """Return the parameters of the memories of both groups."""
    missed = np.zeros(len(MOTIONS))
    for memory, group in zip(found, GROUPS, strict=True):
        missed[[*group]] = memory.missed
    return {
        "memory_missed": missed.tolist(),
        "memory_omega": np.concatenate([m.omega for m in found]).tolist(),
        "memory_coupling": np.concatenate([m.coupling.ravel() for m in found]).tolist(),
        "memory_damping": np.concatenate([m.damping[_ROWS, _COLUMNS] for m in found]).tolist(),
    }


def _coupling(p: SimpleNamespace) -> Any:
    """Return B (2 modes, 6) of both groups."""
    rows = ca.reshape(p.memory_coupling, 3, 2 * MODES).T
    whole = ca.SX(2 * MODES, 6)
    for n, group in enumerate(GROUPS):
        part = slice(n * MODES, (n + 1) * MODES)
        for column, motion in enumerate(group):
            whole[part, motion] = rows[part, column]
    return whole


def _damping(p: SimpleNamespace) -> Any:
    """Return R (2 modes, 2 modes) of both groups."""
    size = len(_ROWS)
    whole = ca.SX(2 * MODES, 2 * MODES)
    for n in range(2):
        for k, (i, j) in enumerate(zip(_ROWS.tolist(), _COLUMNS.tolist(), strict=True)):
            value = p.memory_damping[n * size + k]
            whole[n * MODES + i, n * MODES + j] = value
            whole[n * MODES + j, n * MODES + i] = value
    return whole
