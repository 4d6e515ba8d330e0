"""The scene of a run: water, bed, grid, north, craft, tracks, marks, wind, current, tethers."""

from __future__ import annotations

import math
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np

from seatrial.trial.criteria.expressions import FloatArray
from seatrial.trial.records.run_folder import viewed
from seatrial.trial.records.scene import waypoints
from seatrial.trial.reports.sea_section import Surroundings, surroundings_of

from .bodies import Bodies, extent
from .bottom import bottom, obstacles
from .forces import Forces
from .meshes import mesh_of
from .motion import NED_IN_ENU, Frame, Motion
from .views import Views
from .water import CELLS, Water, followed

WORLD = "/world"
"""Node of all that moves against the page's middle."""
TRACKS = ((217, 72, 54), (31, 111, 178), (31, 122, 77), (161, 92, 0), (123, 67, 151))
_WATER, _BED, _SKY = (38, 110, 150), (150, 132, 98), (196, 221, 236)
_DEEP = (34, 96, 124)
_MARK, _WIND, _CURRENT = (240, 176, 32), (244, 246, 247), (64, 196, 200)
_LONGEST_TRACK = 2000
"""Points of a track."""
_HEIGHT_OF_WIND = 10.0
_MOST_BED = 400.0
"""Depth down to which a bed is drawn, in lengths of the craft."""


class Scene:
    """All that is seen of a run. `show` moves it to a frame; ``scene`` is that of viser.

    The world is east, north, up, m, as in `trial.records.scene`. ``cells`` are those of the water.
    """

    def __init__(
        self, scene: Any, motion: Motion, folder: Path, *, cells: int = CELLS, ghost: str = ""
    ) -> None:
        run = motion.run
        self.motion, self._scene = motion, scene
        self._is_ghost, self._root = bool(ghost), f"{WORLD}{ghost}"
        self.anchor = 0
        """Number of the craft that is kept in the middle of the page."""
        self.keeps = True
        """Whether it is kept there; else the world stands still from now on."""
        components = run.manifest["components"]
        self.size = max([extent(components[c.component]) for c in motion.crafts], default=1.0)
        """How far the largest craft reaches from its origin, m."""
        if not ghost:
            self._world = scene.add_frame(WORLD, show_axes=False)
        self._bodies = Bodies(scene, motion, folder, self._root, ghost=self._is_ghost)
        self._lines = list(self._tethers())
        self._water: Water | None = None
        if not ghost:
            self._far: Any = None
            self._met: Surroundings = surroundings_of(run)
            self._surface(cells)
            self._bottom()
            self._marks()
            self._rose()
            self._arrows()
            self.views = Views(scene, motion, self._root, self.size, self._crest)
            self.forces = Forces(scene, motion, self._root, WORLD, self.size)

    def show(self, frame: Frame) -> None:
        """Move everything to where it is in a frame."""
        self._bodies.show(frame)
        for handle, signals in self._lines:
            if all(name in self.motion.run.signals for axis in signals for name in axis):
                handle.points = _segments(_line(frame, signals))
        if self._is_ghost or not self.motion.crafts:
            return
        middle = frame.pose(self.anchor).position
        east, north, up = middle.tolist()
        if self.keeps:
            up = 0.0 if abs(up) < self.size else up  # what floats heaves
            self._world.position = (-east, -north, -up)
            cells = 10.0 * self.cell
            self._grid.position = (-(east % cells), -(north % cells), self._floor - up)
            if self._far is not None:
                self._far.position = (0.0, 0.0, 1.5 * self._floor - up)
        if self._water is not None:
            self._sea.vertices = self._water.vertices(frame.time, east, north).astype(np.float32)
        self._compass.position = (east, north, self._crest)
        self._show_arrows(frame, east, north)
        self.views.show(frame)
        self.forces.show(frame)

    @property
    def has_waves(self) -> bool:
        """Whether the water moves."""
        return self._water is not None and self._water.waves is not None

    def draw_tracks(self, tracks: Sequence[FloatArray] | None = None) -> None:
        """Draw the track of each craft, (east, north, up): by default as it is recorded."""
        for number, track in enumerate(tracks or [c.position for c in self.motion.crafts]):
            points = track[:: -(-len(track) // _LONGEST_TRACK) or 1]
            if len(points) < 2:
                continue
            colour = (150, 150, 150) if self._is_ghost else TRACKS[number % len(TRACKS)]
            self._scene.add_line_segments(
                f"{self._root}/track{number}",
                _segments(points),
                colour,
                thickness=2.0,
                thickness_units="screen",
            )

    # ------------------------------------------------------------------ inside

    def _surface(self, cells: int) -> None:
        sea = self._met.sea
        waves = sea.waves() if sea is not None else followed(self.motion.run)
        reach = (200.0 if waves is None else 40.0) * self.size
        self._scene.set_background_image(_sky(self._is_under_water()), format="png")
        self._scene.configure_default_lights(cast_shadow=False)
        self._scene.configure_fog(
            20.0 * self.size, 160.0 * self.size, color=_DEEP if self._is_under_water() else _SKY
        )
        self._water = Water(waves, reach, cells if waves is not None else 1)
        self._sea = self._scene.add_mesh_simple(
            f"{WORLD}/water",
            self._water.vertices(0.0, 0.0, 0.0),
            self._water.faces(),
            color=_WATER,
            opacity=0.72,
            flat_shading=waves is not None,
            side="double",
        )
        if waves is not None:  # beyond the waves that are drawn
            half = 100.0 * self.size
            corners = np.array(
                [[-half, -half, 0], [half, -half, 0], [half, half, 0], [-half, half, 0]]
            )
            self._far = self._scene.add_mesh_simple(
                "/far",
                corners,
                np.array([[0, 1, 2], [0, 2, 3]]),
                color=_WATER,
                opacity=0.72,
                side="double",
            )
        height = 2.0 * float(np.sqrt(0.5 * np.sum(waves.amplitude**2))) if waves else 0.0
        self._crest = height + 0.01 * self.size
        cell = _round(0.5 * self.size)
        self._floor = -height - 0.004 * self.size
        self._grid = self._scene.add_grid(
            "/grid",
            width=16.0 * 10.0 * cell,
            height=16.0 * 10.0 * cell,
            plane="xy",
            cell_size=cell,
            section_size=10.0 * cell,
            cell_color=(120, 165, 188),
            section_color=(225, 236, 242),
            cell_thickness=0.6,
            fade_distance=60.0 * self.size,
            position=(0.0, 0.0, self._floor),
            shadow_opacity=0.0,
        )
        self.cell = cell
        """Of the grid, m."""

    def _is_under_water(self) -> bool:
        """Say whether most of what the first craft does is well below the surface."""
        craft = self.motion.crafts
        return bool(craft) and float(np.median(craft[0].position[:, 2])) < -2.0 * self.size

    def _bottom(self) -> None:
        craft = self.motion.crafts
        east, north, _ = np.mean(craft[0].position, axis=0).tolist() if craft else (0.0, 0.0, 0.0)
        span = float(np.ptp(craft[0].position[:, :2], axis=0).max()) if craft else 0.0
        bed = bottom(self.motion.run, east, north, span + 60.0 * self.size)
        if bed is not None and -bed.vertices[:, 2].max() < _MOST_BED * self.size:
            self._scene.add_mesh_simple(
                f"{WORLD}/bed", bed.vertices, bed.faces, color=_BED, side="double"
            )
        self._scene.add_frame(f"{WORLD}/n", show_axes=False, wxyz=NED_IN_ENU)
        for number, (part, place, turn) in enumerate(obstacles(self.motion.run)):
            mesh = mesh_of(part)
            assert mesh is not None
            self._scene.add_mesh_simple(
                f"{WORLD}/n/o{number}",
                mesh.vertices,
                mesh.faces,
                color=(120, 112, 100),
                flat_shading=True,
                position=place,
                wxyz=turn,
                side="double",
            )

    def _marks(self) -> None:
        for number, (_, places) in enumerate(waypoints(self.motion.run)):
            points = np.array(places, dtype=float).reshape(-1, 3)
            route = f"{WORLD}/route{number}"
            for at, place in enumerate(points):
                lift = 1.5 * self.size
                self._scene.add_cylinder(
                    f"{route}/m{at}",
                    radius=0.12 * self.size,
                    height=lift,
                    color=_MARK,
                    position=place + np.array([0.0, 0.0, 0.5 * lift]),
                )
                self._scene.add_label(
                    f"{route}/l{at}", str(at + 1), position=place + np.array([0.0, 0.0, 1.3 * lift])
                )
            if len(points) > 1:
                self._scene.add_line_segments(
                    f"{route}/legs",
                    _segments(points),
                    _MARK,
                    thickness=1.0,
                    thickness_units="screen",
                )

    def _rose(self) -> None:
        """Draw north, and a circle about the first craft."""
        radius = 2.4 * self.size
        angle = np.linspace(0.0, math.tau, 73)
        ring = np.stack([radius * np.cos(angle), radius * np.sin(angle), 0.0 * angle], 1)
        self._compass = self._scene.add_frame(f"{WORLD}/rose", show_axes=False)
        self._scene.add_line_segments(
            f"{WORLD}/rose/ring",
            _segments(ring),
            (235, 241, 244),
            thickness=1.0,
            thickness_units="screen",
        )
        self._scene.add_arrows(
            f"{WORLD}/rose/north",
            np.array([[[0.0, radius, 0.0], [0.0, 1.25 * radius, 0.0]]]),
            (217, 72, 54),
            shaft_radius=0.02 * self.size,
            head_radius=0.09 * self.size,
            head_length=0.25 * self.size,
        )
        self._scene.add_label(f"{WORLD}/rose/n", "N", position=(0.0, 1.4 * radius, 0.0))

    def _arrows(self) -> None:
        """Add arrows of wind and current, which show where they go to."""
        self._drawn: list[tuple[Any, Any, float]] = []
        made = (("wind", _WIND, self._wind, 2.2), ("current", _CURRENT, self._current, 0.03))
        for name, colour, velocity, height in made:
            if velocity(0.0, None) is None:
                continue
            handle = self._scene.add_arrows(
                f"{WORLD}/{name}",
                np.array([[[0.0, 0.0, 0.0], [0.0, self.size, 0.0]]]),
                colour,
                shaft_radius=0.035 * self.size,
                head_radius=0.11 * self.size,
                head_length=0.3 * self.size,
            )
            label = self._scene.add_label(f"{WORLD}/{name}/label", name)
            self._drawn.append((handle, (velocity, label), height))

    def _show_arrows(self, frame: Frame, east: float, north: float) -> None:
        for handle, (velocity, label), height in self._drawn:
            found = velocity(frame.time, frame)
            speed = math.hypot(*found) if found is not None else 0.0
            handle.visible = label.visible = speed > 0.0
            if found is None or not speed:
                continue
            to_north, to_east = found[0] / speed, found[1] / speed
            handle.position = (east, north, self._crest + height * self.size)
            length = 1.8 * self.size
            way = np.array([to_east, to_north, 0.0])
            begin = -2.6 * self.size * way if height > 1.0 else 0.6 * self.size * way
            handle.points = np.array([[begin, begin + length * way]], dtype=np.float32)
            label.position = tuple(begin)
            text = f"{label_of(height)} {speed:.2g} m/s"
            if label.text != text:
                label.text = text

    def _wind(self, time: float, frame: Frame | None) -> tuple[float, float] | None:
        """Return the air's velocity to north and east: as recorded, or that of the trial."""
        for name, _, ports in viewed(self.motion.run.manifest, "wind"):
            found = [f"{name}.{ports['velocity']}.{axis}" for axis in ("north", "east")]
            frame = frame or self.motion.at(time)
            values = [frame.value(signal) for signal in found]
            if None not in values:
                return values[0] or 0.0, values[1] or 0.0
        if self._met.wind is None:
            return None
        north, east, *_ = self._met.wind.velocity(time, _HEIGHT_OF_WIND)
        return float(north), float(east)

    def _current(self, time: float, _frame: Frame | None) -> tuple[float, float] | None:
        if self._met.current is None:
            return None
        north, east, *_ = self._met.current.velocity(time, 0.0)
        return float(north), float(east)

    def _tethers(self) -> Any:
        for number, (name, _, ports) in enumerate(viewed(self.motion.run.manifest, "line")):
            first = f"{name}.{ports['north']}."
            known = [s for s in self.motion.run.manifest["signals"] if s.startswith(first)]
            stations = [s.removeprefix(first) for s in known]
            if len(stations) < 2:
                continue
            axes = [f"{name}.{ports[axis]}" for axis in ("north", "east", "down")]
            signals = [[f"{axis}.{s}" for s in stations] for axis in axes]
            handle = self._scene.add_line_segments(
                f"{self._root}/line{number}",
                np.zeros((len(stations) - 1, 2, 3)),
                (242, 195, 46),
                thickness=3.0,
                thickness_units="screen",
            )
            yield handle, signals


def label_of(height: float) -> str:
    """Return what an arrow at a height shows."""
    return "wind" if height > 1.0 else "current"


def _line(frame: Frame, signals: list[list[str]]) -> FloatArray:
    north, east, down = (frame.values(axis) for axis in signals)
    return np.stack([east, north, -down], 1)


def _segments(points: FloatArray) -> Any:
    """Return the segments between points, one after the other."""
    return np.stack([points[:-1], points[1:]], 1).astype(np.float32)


def _round(length: float) -> float:
    """Return the nearest of 1, 2 and 5 with zeros."""
    power = 10.0 ** math.floor(math.log10(length))
    return min((power * digit for digit in (1.0, 2.0, 5.0, 10.0)), key=lambda x: abs(x - length))


def _sky(under_water: bool) -> Any:
    """Return a picture of a sky, lighter towards the horizon, or of water, darker with depth."""
    share = np.linspace(0.0, 1.0, 128)[:, None, None]
    top, low = np.array([112.0, 164.0, 204.0]), np.array([226.0, 238.0, 245.0])
    if under_water:
        top, low = np.array([64.0, 150.0, 178.0]), np.array([10.0, 48.0, 72.0])
    return np.broadcast_to(top + share * (low - top), (128, 4, 3)).astype(np.uint8)
