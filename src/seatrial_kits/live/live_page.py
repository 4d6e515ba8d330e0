"""The page of a run under way: the scene, charts, criteria, and a person's hands on it."""

from __future__ import annotations

import contextlib
import time
from collections.abc import Callable, Iterable, Mapping, Sequence
from html import escape
from pathlib import Path
from typing import Any

import numpy as np

from seatrial.errors import InputError
from seatrial.model.readable import number
from seatrial.trial.criteria.expressions import FloatArray
from seatrial.trial.records.run_folder import Run, load_run

from .by_hand import ByHand
from .cameras import Cameras
from .charts import Charts
from .controls import Controls
from .helm import Helm
from .lights import Lights, html_of
from .map_view import Map
from .motion import Frame, Motion
from .pilot import Pilot
from .scene import Scene
from .server import PageServer, look
from .views import html_of_words

_PANEL_S = 0.5
_MOST_LINES = 100


class LivePage:
    """What viewers of a run see; ``command`` sends the run what they do."""

    def __init__(
        self,
        server: PageServer,
        described: dict[str, Any],
        command: Callable[..., None],
        done: ByHand,
        may_command: bool,
    ) -> None:
        self._server, self._described = server, described
        self._manifest, self._folder = described["manifest"], Path(described["folder"])
        self._history = History(self._manifest, self._folder, described["signals"])
        self._lights = Lights(self._manifest)
        self._scene: Scene | None = None
        self._lines: list[str] = []
        self._has_missed = True
        self._panel_at, self._rate_at = 0.0, (time.monotonic(), 0.0)
        gui = server.gui
        look(gui)
        gui.set_panel_label(f"{self._manifest['trial']['name']}, live")
        title = self._manifest["trial"].get("title") or self._manifest["trial"]["name"]
        gui.add_html(f'<div style="padding:0 .8em">{escape(str(title))}</div>')
        self._state = gui.add_html("")
        self._lost = gui.add_html("")
        self.helm = Helm(server, may_command)
        if may_command:
            self._controls = Controls(gui, self.helm, command, described, done)
            self._pilot = Pilot(gui, self.helm, command, described["orders"])
        with gui.add_folder("Criteria"):
            self._lights_html = gui.add_html("")
        with gui.add_folder("Map"):
            self._map_html = gui.add_html("")
        self._charts = Charts(gui, self._manifest)
        with gui.add_folder("Log", expand_by_default=False):
            self._log_html = gui.add_html("")

    def show(self, now: float, values: FloatArray) -> None:
        """Show a frame: the time, s, and the numbers in the order of the signals."""
        run = self._history.add(now, values)
        if not self._server.get_clients():
            return
        motion = Motion(run)
        frame = motion.at(now)
        if self._scene is None and motion.crafts:
            self._scene = Scene(self._server.scene, motion, self._folder)
            self._scene.forces.add_switch(self._server.gui)
            self._cameras = Cameras(self._server, self._scene)
            self._map = Map(motion, self._scene.size)
        if self._scene is not None:
            self._scene.motion = motion
            with self._server.atomic():
                self._scene.show(frame)
            self._cameras.follow(frame)
        if time.monotonic() - self._panel_at > _PANEL_S or self._charts.changed:
            self._panel_at = time.monotonic()
            self._show_panel(now, frame)

    def watched_by(self, viewers: int) -> None:
        """Note how many look. What nobody saw is read from the record, for who comes now."""
        if not viewers:
            self._has_missed = True
        elif self._has_missed:
            self._has_missed = False
            with contextlib.suppress(InputError):  # nothing is recorded yet
                self._history.fill(load_run(self._folder))

    def log(self, now: float, what: str, key: Any, written: Any) -> None:
        """Note what the run has done."""
        said = {
            "set": lambda: f"{key} = {written}",
            "fault": lambda: f"{written['what']} on {written['where']}",
            "clear": lambda: f"fault {key} ended",
        }[what]()
        self._add_line(f"{number(now, 6)} s: {said}")

    def lost(self, now: float, components: Sequence[str]) -> None:
        """Show which components have lost a link; there may be none any more."""
        said = f"link lost: {', '.join(components)}" if components else ""
        self._add_line(f"{number(now, 6)} s: {said or 'no link is lost'}")
        style = "padding:0 .8em;font-weight:bold;color:#c62f24"
        self._lost.content = said and f'<div class="lost" style="{style}">{escape(said)}</div>'

    def refused(self, why: str) -> None:
        """Say that a command was refused, and why."""
        self._add_line(f"refused: {why}")
        for client in self._server.get_clients().values():
            client.add_notification("refused", why, color="red", auto_close_seconds=8.0)

    # ------------------------------------------------------------------ inside

    def _add_line(self, line: str) -> None:
        self._lines = [*self._lines, line][-_MOST_LINES:]
        rows = "".join(f"<div>{escape(row)}</div>" for row in reversed(self._lines))
        self._log_html.content = f'<div style="font-size:.8em;padding:0 .8em">{rows}</div>'

    def _show_panel(self, now: float, frame: Frame) -> None:
        wall, before = self._rate_at
        passed = time.monotonic() - wall
        if passed > 1.0:
            self._rate = (now - before) / passed
            self._rate_at = time.monotonic(), now
        rate = getattr(self, "_rate", 0.0)
        self._state.content = (
            f'<div class="state" data-time="{now!r}" style="padding:0 .8em;font-size:1.1em">'
            f"<b>{number(now, 6)} s</b> of {number(self._manifest['stop'])} s, "
            f"{number(rate, 2)} &times; real time</div>"
            + html_of_words("" if self._scene is None else self._scene.views.words(frame))
        )
        names = {*self._charts.shown, *self._lights.signals, *self._places()}
        times, columns = self._history.columns(names)
        self._lights_html.content = html_of(self._lights.states(times, columns, is_over=False))
        self._charts.update(times, columns)
        if self._scene is not None:
            tracks = self._tracks(columns)
            self._map_html.content = self._map.html(frame, tracks)
            self._scene.draw_tracks(tracks)

    def _places(self) -> list[str]:
        crafts = self._scene.motion.crafts if self._scene is not None else []
        return [f"{craft.component}.position.{axis}" for craft in crafts for axis in "xyz"]

    def _tracks(self, columns: dict[str, Any]) -> list[FloatArray]:
        """Return the tracks in the world, (east, north, up)."""
        assert self._scene is not None
        tracks = self._scene.motion.tracks(columns)
        return [track[np.isfinite(track).all(axis=1)] for track in tracks]  # a record may lack it


_MOST_ROWS = 4000


class History:
    """Rows of a run under way; of more than `_MOST_ROWS` every second one is dropped."""

    def __init__(self, manifest: Mapping[str, Any], folder: Path, names: Sequence[str]) -> None:
        self._manifest, self._folder = dict(manifest), folder
        self._names = {name: place for place, name in enumerate(names)}
        self._units = {name: manifest["signals"][name]["unit"] for name in names}
        self._rows: list[FloatArray] = []
        self._times: list[float] = []
        self._every = 0.0

    def add(self, time: float, row: FloatArray) -> Run:
        """Keep a row, and return a run of it alone."""
        if not self._times or time - self._times[-1] >= self._every:
            self._times.append(time)
            self._rows.append(row)
        if len(self._rows) > _MOST_ROWS:
            self._times, self._rows = self._times[::2], self._rows[::2]
            self._every = 1.5 * (self._times[1] - self._times[0])
        signals = {name: row[place : place + 1] for name, place in self._names.items()}
        return self._run(np.array([time]), signals)

    def fill(self, record: Run) -> None:
        """Take the rows of a record that are later than those here; what it lacks is NaN."""
        since = self._times[-1] if self._times else -np.inf
        later = np.flatnonzero(record.time > since)
        chosen = later[:: max(1, len(later) // (_MOST_ROWS // 2))]
        rows = np.full((len(chosen), len(self._names)), np.nan)
        for name, place in self._names.items():
            column = record.signals.get(name)
            if isinstance(column, np.ndarray):
                rows[:, place] = column[chosen]
        self._times += record.time[chosen].tolist()
        self._rows += list(rows)

    def columns(self, names: Iterable[str]) -> tuple[FloatArray, dict[str, Any]]:
        """Return the times, and those of the signals that there are."""
        wanted = [name for name in names if name in self._names]
        places = [self._names[name] for name in wanted]
        table = np.array([row[places] for row in self._rows]).reshape(len(self._rows), len(places))
        return np.array(self._times), dict(zip(wanted, table.T, strict=True))

    def _run(self, time: FloatArray, signals: dict[str, Any]) -> Run:
        units = self._units
        return Run(self._folder, time, signals, units, self._manifest, [], {}, False, ())
