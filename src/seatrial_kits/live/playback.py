"""``seatrial play``: the page of a record, with a time line and the ghost of a second run."""

from __future__ import annotations

import time
from collections.abc import Callable
from html import escape
from typing import Any

import numpy as np

from seatrial.errors import InputError
from seatrial.trial.records.run_folder import Run
from seatrial.trial.reports.event_marks import events_of

from .cameras import Cameras
from .charts import Charts
from .lights import Lights, html_of
from .map_view import Map
from .motion import Motion
from .scene import Scene
from .server import PageServer, look
from .views import html_of_words

FRAME_S = 1.0 / 30.0
"""Least wall time between two frames."""
_PANEL_S = 0.5
"""Wall time between two looks of charts, map and lights."""
_SPEEDS = ("0.1", "0.25", "0.5", "1", "2", "5", "10", "30", "100")
_MARKS = 12
"""Events on the time line; more would lie on each other."""


class Playback:
    """A page that plays a run, with another one as its ghost.

    Raises InputError for a run without a craft whose position and attitude were recorded.
    """

    def __init__(self, server: PageServer, run: Run, ghost: Run | None = None) -> None:
        self._server, self._run = server, run
        self._motion = motion_of(run)
        self._begin, self._end = self._motion.span
        self.time = self._begin
        self.is_playing = True
        self._speed = 1.0
        self._frame_time = float("nan")
        self._scene = Scene(server.scene, self._motion, run.folder)
        self._scene.draw_tracks()
        self._ghost: Scene | None = None
        if ghost is not None:
            self._ghost = Scene(server.scene, motion_of(ghost), ghost.folder, ghost="/ghost")
            self._ghost.draw_tracks()
        self._controls(server.gui, ghost)
        self._cameras = Cameras(server, self._scene)
        self._panel_at = 0.0

    def run(self, stop_requested: Callable[[], int]) -> None:
        """Play until a stop is requested."""
        before = time.monotonic()
        while not stop_requested():
            now = time.monotonic()
            self.advance(now - before)
            before = now
            time.sleep(max(0.0, FRAME_S - (time.monotonic() - now)))

    def advance(self, wall: float) -> None:
        """Go on by wall time, s, and show it if there is anybody to see it."""
        if not self._server.get_clients():
            return
        if self.is_playing:
            self.time = min(self.time + wall * self._speed, self._end)
            if self.time >= self._end:
                self._set_playing(False)
        if self.time != self._frame_time:
            self._frame_time = self.time
            self._show()

    # ------------------------------------------------------------------ inside

    def _controls(self, gui: Any, ghost: Run | None) -> None:
        look(gui)
        gui.set_panel_label(self._run.name)
        gui.add_html(f'<div style="padding:0 .8em">{escape(self._title(ghost))}</div>')
        self._slider = gui.add_slider(
            "time, s",
            self._begin,
            self._end,
            max((self._end - self._begin) / 1000.0, 1e-6),
            self._begin,
            marks=self._timeline(),
        )
        self._words = gui.add_html("")
        self._button = gui.add_button("Pause")
        step = gui.add_button_group("step", ("-1 row", "+1 row", "to start"))
        self._speeds = gui.add_dropdown("times real time", _SPEEDS, initial_value="1")
        stays = gui.add_checkbox("keep the craft in the middle", True)
        dark = gui.add_checkbox("dark", False)
        self._scene.forces.add_switch(gui)
        with gui.add_folder("Criteria"):
            self._lights_html = gui.add_html("")
        with gui.add_folder("Map"):
            self._map_html = gui.add_html("")
        self._lights, self._map = Lights(self._run.manifest), Map(self._motion, self._scene.size)
        limits = [limit for verdict in self._run.verdicts for limit in verdict["limits"]]
        self._charts = Charts(gui, self._run.manifest, limits)
        for signal in dict.fromkeys(limit[0] for limit in limits):
            self._charts.add(signal)
        with gui.add_folder("Events", expand_by_default=False):
            gui.add_html(self._events())

        self._slider.on_update(lambda event: self._seek(event))
        self._button.on_click(lambda _: self._set_playing(not self.is_playing))
        step.on_click(lambda event: self._step(event.target.value))
        self._speeds.on_update(lambda _: setattr(self, "_speed", float(self._speeds.value)))
        stays.on_update(lambda _: setattr(self._scene, "keeps", stays.value))
        dark.on_update(lambda _: look(gui, dark=dark.value))

    def _title(self, ghost: Run | None) -> str:
        title = str(self._run.manifest["trial"].get("title") or self._run.name)
        return title if ghost is None else f"{title} (ghost: {ghost.name}, {ghost.folder.name})"

    def _timeline(self) -> tuple[Any, ...] | None:
        """Return events, and the times at which criteria were broken, on the time line."""
        marks = [(event.at, event.label or "·") for event in events_of(self._run)]
        marks += [
            (verdict["time"], "✗")
            for verdict in self._run.verdicts
            if not verdict["passed"] and verdict["time"] is not None
        ]
        inside = [(at, label) for at, label in marks if self._begin <= at <= self._end]
        return tuple(sorted(inside)[:_MARKS]) or None

    def _events(self) -> str:
        rows = "".join(
            f"<tr><td style='padding-right:.8em'>{event.at:g} s</td>"
            f"<td>{escape(event.text)}</td></tr>"
            for event in events_of(self._run)
        )
        rows = rows or "<tr><td>none</td></tr>"
        return f"<table style='font-size:.8em;margin:0 .8em'>{rows}</table>"

    def _seek(self, event: Any) -> None:
        if event.client is not None:  # a person moved it, not `_show`
            self.time = float(self._slider.value)

    def _step(self, what: str) -> None:
        self._set_playing(False)
        rows, frame = self._run.time, self._motion.at(self.time)
        if what == "to start":
            self.time = self._begin
        else:
            row = frame.row + (1 if what.startswith("+") else -1)
            self.time = float(rows[min(max(row, 0), len(rows) - 1)])

    def _set_playing(self, wanted: bool) -> None:
        if wanted and self.time >= self._end:
            self.time = self._begin
        self.is_playing = wanted
        self._button.label = "Pause" if wanted else "Play"

    def _show(self) -> None:
        frame = self._motion.at(self.time)
        with self._server.atomic():
            self._scene.show(frame)
            if self._ghost is not None:
                self._ghost.show(self._ghost.motion.at(self.time))
        self._cameras.follow(frame)
        if time.monotonic() - self._panel_at < _PANEL_S and self.is_playing:
            return
        self._panel_at = time.monotonic()
        self._slider.value = self.time
        self._words.content = html_of_words(self._scene.views.words(frame))
        rows = slice(0, frame.row + 1)
        so_far = {name: column[rows] for name, column in self._run.signals.items()}
        is_over = frame.row == len(self._run.time) - 1
        states = self._lights.states(self._run.time[rows], so_far, is_over=is_over)
        self._lights_html.content = html_of(states)
        self._map_html.content = self._map.html(frame)
        other = None
        if self._ghost is not None:
            other = self._ghost.motion.run.time, self._ghost.motion.run.signals
        self._charts.update(self._run.time[rows], so_far, other)


def motion_of(run: Run) -> Motion:
    """Return where the craft of a run are. Raises InputError if none was recorded."""
    motion = Motion(run) if len(run.time) else None
    if motion is None or not motion.crafts:
        raise InputError(
            f"{run.folder}: no craft to show: a component's position and attitude must be recorded"
        )
    for craft in motion.crafts:
        if not (np.isfinite(craft.position).all() and np.isfinite(craft.orientation).all()):
            raise InputError(f"{run.folder}: {craft.component}: a position is not finite")
    return motion
