"""The hull of a surface craft in waves, by sections: what its wave loads are computed from."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any

import numpy as np

from ...errors import InputError
from ...model.component import Component, Parameter
from ...model.expressions import Vector
from ..sea.loads import Drift
from ..sea.numbers import Array, Complex, Numbers
from ..sea.strips import Strips
from .large_angles import Slice, outline

STATIONS = 11
_STRIPS = 20
_AXES = [f"s{i}" for i in range(STATIONS)]
_DRIFT_AXES = [f"w{i}" for i in range(1, 9)]
_LARGEST_ERROR = 0.05
"""Of the waterplane area between hull and restoring: else the craft would not follow long waves."""


@dataclass(frozen=True)
class HullCoefficients:
    """Added mass and linear damping of a craft's own equations: its wave loads are of the same.

    SI; heave, roll and pitch then turn relative to the surface on both sides of the equations.
    """

    heave: tuple[float, float] = (0.0, 0.0)
    sway: tuple[float, float] = (0.0, 0.0)
    roll: tuple[float, float] = (0.0, 0.0)
    pitch: tuple[float, float] = (0.0, 0.0)
    roll_by_sway_mass: float = 0.0


class WaveHull(Component):
    """Mix-in: one slender hull or two alike, by 11 sections evenly spaced from stern to bow.

    ``side_spacing`` adds a pair of side hulls with sections of their own, a trimaran's; their
    water line is that of the others, and what their sections are of, ``section_form`` too.

    ``drift_head`` and ``drift_beam`` are mean drift forces by frequency, of a panel code or
    measured; the slow drift of an irregular sea follows by Newman's approximation.
    """

    hull_length = Parameter(
        0.0, "m", "length of the hull at the water line, first to last section; 0: no hull given"
    )
    hull_middle = Parameter(0.0, "m", "middle of that length ahead of the body origin")
    hull_waterline = Parameter(0.0, "m", "water line above the body origin")
    hull_freeboard = Parameter(
        0.0, "m", "deck above the water line, of a hull that holds the water out; 0: not given",
        min=0.0,
    )  # fmt: skip
    hull_spacing = Parameter(
        0.0, "m", "between the centre planes of two hulls alike; 0: one hull", min=0.0
    )
    section_beam = Parameter(0.0, "m", "beam of one hull at the water line", axes=_AXES, min=0.0)
    section_draught = Parameter(0.0, "m", "draught", axes=_AXES, min=0.0)
    section_area = Parameter(0.0, "m2", "area of one hull under water", axes=_AXES, min=0.0)
    side_spacing = Parameter(
        0.0, "m", "between the centre planes of a pair of side hulls; 0: none", min=0.0
    )
    side_length = Parameter(0.0, "m", "length of a side hull at the water line", min=0.0)
    side_middle = Parameter(0.0, "m", "middle of that length ahead of the body origin")
    side_beam = Parameter(0.0, "m", "beam of one side hull", axes=_AXES, min=0.0)
    side_draught = Parameter(0.0, "m", "draught of one side hull", axes=_AXES, min=0.0)
    side_area = Parameter(0.0, "m2", "area of one side hull under water", axes=_AXES, min=0.0)
    section_form = Parameter(
        "box", "1", "sections are boxes, or arcs about their middle", choices=("box", "arc")
    )

    drift_frequency = Parameter(
        0.0, "rad/s", "frequencies of the drift's table, rising; all 0: no drift", axes=_DRIFT_AXES
    )
    drift_head = Parameter(
        0.0, "N/m2", "mean force aft in head seas, per amplitude squared", axes=_DRIFT_AXES
    )
    drift_beam = Parameter(
        0.0, "N/m2", "mean force along beam seas, per amplitude squared", axes=_DRIFT_AXES
    )

    def slices(self) -> list[Slice]:
        """Return all hulls by slices with their decks, for `large_angles`.

        Raises InputError for a hull that is not given, and one without ``hull_freeboard``.
        """
        if not self.hull_freeboard > 0.0:
            raise InputError(
                f"{self.name}: its righting arm at large angles needs the height of its deck: "
                "hull_freeboard"
            )
        return [
            Slice(outline(b, T, S, self.hull_freeboard, y), body.dx)
            for body in self._bodies("it has a righting arm at large angles")
            for y in body.hulls
            for b, T, S in zip(body.beam, body.draught, body.area, strict=True)
            if min(b, T, S) > 0.0
        ]

    def drift(self) -> Drift | None:
        """Return the mean drift forces of the table, linear in frequency; None without one.

        X = D_head cos(chi) |cos(chi)|, Y = D_beam sin(chi) |sin(chi)|, no moment; from 0 at 0
        rad/s, beyond the table its end. Raises InputError for frequencies that do not rise.
        """
        omega = np.array(self.drift_frequency)
        if not omega.any():
            return None
        if omega[0] < 0.0 or (np.diff(omega) <= 0.0).any():
            raise InputError(f"{self.name}: drift_frequency is {omega.tolist()}: it must rise")
        omega = np.concatenate([[0.0], omega]) if omega[0] > 0.0 else omega
        head, beam = (
            np.concatenate([np.zeros(len(omega) - len(values)), values])
            for values in (self.drift_head, self.drift_beam)
        )

        def coefficients(w: Array, chi: Numbers) -> Array:
            cos, sin = np.cos(chi), np.sin(chi)
            ahead = np.interp(w, omega, head) * cos * np.abs(cos)
            aside = np.interp(w, omega, beam) * sin * np.abs(sin)
            return np.stack([ahead, aside, np.zeros_like(ahead)])

        return coefficients

    def hull_loads(
        self, own: HullCoefficients, density: float, gravity: float, waterplane: float | None
    ) -> HullInWaves:
        """Return the strips of the hulls, with the coefficients of the craft.

        Added mass and damping in heave are shared out over the strips by beam squared, in sway
        by length.
        ``waterplane`` is that of the craft's restoring, m2, if it has one. Raises InputError for
        a hull that is not given, or whose waterplane is another.
        """
        bodies = self._bodies("it meets waves")
        plane = sum(body.plane for body in bodies)
        if waterplane is not None and not abs(plane - waterplane) <= _LARGEST_ERROR * waterplane:
            raise InputError(
                f"{self.name}: the sections have a waterplane of {plane:.4g} m2, and "
                f"waterplane_area is {waterplane:.4g} m2: in long waves the craft would not "
                "follow the surface"
            )
        shares = _Shares(own, bodies)
        form = {"round": self.section_form == "arc", "density": density, "gravity": gravity}
        return HullInWaves([shares.in_waves(body, self.hull_waterline, form) for body in bodies])

    def _bodies(self, why: str) -> list[_Sections]:
        """Return the hulls, one or two alike, then a pair at the sides. Raises InputError."""
        if not self.hull_length > 0.0:
            raise InputError(
                f"{self.name}: {why}, and its hull is not given: hull_length, "
                "section_beam, section_draught and section_area"
            )
        bodies = [self._sections("section", self.hull_length, self.hull_middle, self.hull_spacing)]
        if self.side_spacing > 0.0:
            if not self.side_length > 0.0:
                raise InputError(f"{self.name}: side_spacing is given, and side_length is 0")
            bodies.append(
                self._sections("side", self.side_length, self.side_middle, self.side_spacing)
            )
        return bodies

    def _sections(self, prefix: str, length: float, middle: float, spacing: float) -> _Sections:
        """Return the strips of one hull or two alike. Raises InputError for sections of 0."""
        edges = np.linspace(-0.5, 0.5, _STRIPS + 1) * length
        x, dx = 0.5 * (edges[:-1] + edges[1:]), length / _STRIPS
        stations = np.linspace(-0.5, 0.5, STATIONS) * length
        names = [f"{prefix}_{name}" for name in ("beam", "draught", "area")]
        beam, draught, area = (np.interp(x, stations, np.array(getattr(self, n))) for n in names)
        for name, values in zip(names, (beam, draught, area), strict=True):
            if not values.max() > 0.0:
                raise InputError(f"{self.name}: {name} is 0 everywhere: give the hull's")
        return _Sections(x, dx, beam, draught, area, length, middle, 0.5 * spacing)


@dataclass(frozen=True, eq=False)
class _Sections:
    """Strips of one hull, or of two alike ``half`` off the centre plane; m and m2."""

    x: Array
    dx: float
    beam: Array
    draught: Array
    area: Array
    length: float
    middle: float
    half: float

    @property
    def hulls(self) -> tuple[float, ...]:
        """y of the centre planes, m."""
        return (-self.half, self.half) if self.half else (0.0,)

    @property
    def plane(self) -> float:
        """Waterplane, m2."""
        return float(self.beam.sum()) * self.dx * len(self.hulls)


class _Shares:
    """What each strip of several hulls has of the craft's own coefficients."""

    def __init__(self, own: HullCoefficients, bodies: list[_Sections]) -> None:
        self.own = own
        self.square = sum(np.square(b.beam).sum() * b.dx * len(b.hulls) for b in bodies)
        self.length = sum(b.length * len(b.hulls) for b in bodies)
        self.lever = sum(
            float((np.square(b.x) * self.broad(b)).sum()) * b.dx * len(b.hulls) for b in bodies
        )
        self.aside = sum(
            np.square(b.beam).sum() * b.dx * len(b.hulls) / self.square * b.half**2 for b in bodies
        )

    def broad(self, body: _Sections) -> Array:
        """Return the share of each metre by beam squared, 1/m."""
        return np.asarray(np.square(body.beam) / self.square)

    def in_waves(self, body: _Sections, waterline: float, form: Mapping[str, Any]) -> _OneInWaves:
        """Return one hull, or two alike, in waves."""
        own, broad = self.own, self.broad(body)
        even = np.full(_STRIPS, 1.0 / self.length)
        strips = Strips(
            body.x,
            body.beam,
            body.area,
            body.draught,
            a33=own.heave[0] * broad,
            b33=own.heave[1] * broad,
            a22=own.sway[0] * even,
            b22=own.sway[1] * even,
            a42=own.roll_by_sway_mass * even,
            b42=0.0 * even,
            hulls=body.hulls,
            **form,
        )
        in_pitch = replace(
            strips, a33=own.pitch[0] / self.lever * broad, b33=own.pitch[1] / self.lever * broad
        )
        in_roll = strips
        if body.half:
            in_roll = replace(
                strips, a33=own.roll[0] / self.aside * broad, b33=own.roll[1] / self.aside * broad
            )
        middle = np.array([body.middle, 0.0, -waterline])
        return _OneInWaves(
            strips, in_pitch, in_roll, (0.0, 0.0) if self.aside else own.roll, middle
        )


@dataclass(frozen=True, eq=False)
class HullInWaves:
    """Wave loads of several hulls on their craft, about its body origin."""

    hulls: list[_OneInWaves]

    def forces(self, omega: Array, k: Array, chi: Numbers) -> Complex:
        """Return X, Y, Z, K, M, N per metre of amplitude, (6, components); see `Strips`."""
        first, *others = (hull.forces(omega, k, chi) for hull in self.hulls)
        return sum(others, first)


@dataclass(frozen=True, eq=False)
class _OneInWaves:
    """Wave loads of strips on a craft, about its body origin, with its own coefficients."""

    strips: Strips
    in_pitch: Strips
    """The same, with a33 and b33 such that their moments are the craft's own in pitch."""
    in_roll: Strips
    """The same for roll, of two hulls."""
    roll: tuple[float, float]
    """Added inertia, kg.m2, and damping, N.m.s, of one hull in roll."""
    place: Vector
    """Middle of the hull at the water line, m in {b}."""

    def forces(self, omega: Array, k: Array, chi: Numbers) -> Complex:
        """Return X, Y, Z, K, M, N per metre of amplitude, (6, components); see `Strips`."""
        force = self.strips.forces(omega, k, chi)
        if self.in_roll is not self.strips:
            force[3] = self.in_roll.forces(omega, k, chi)[3]
        force[3] += self._by_slope(omega, k, chi)
        force[4] = self.in_pitch.forces(omega, k, chi)[4]
        # The craft's added mass and damping act at its body origin, pressure on the hull here.
        pressure = self._bare.forces(omega, k, chi)[:3]
        force[3:] += np.cross(self.place, pressure, axis=0).reshape(3, -1)
        return np.asarray(force * np.exp(-1j * k * self.place[0] * np.cos(chi)))

    @cached_property
    def _bare(self) -> Strips:
        none = 0.0 * self.strips.x
        return replace(self.strips, a33=none, b33=none, a22=none, b22=none)

    def _by_slope(self, omega: Array, k: Array, chi: Numbers) -> Complex:
        """Roll moment of one hull by the slope across it: it rolls relative to the surface."""
        added, damping = self.roll
        if not (added or damping):
            return np.zeros(len(omega), dtype=complex)
        s, sine = self.strips, np.sin(chi)
        wave = np.exp(-1j * k * s.x[:, None] * np.cos(chi)).mean(0)
        wave = wave * np.sinc(k * s.beam.mean() * sine / (2.0 * np.pi))
        wave = wave * np.exp(-k * s.area.sum() / s.beam.sum())
        return np.asarray((1j * omega * damping - omega**2 * added) * 1j * k * sine * wave)
