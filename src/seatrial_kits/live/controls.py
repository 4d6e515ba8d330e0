"""Hands on a run: pause, step, speed, restart, set-points, tunables and faults."""

from __future__ import annotations

import itertools
import math
from collections.abc import Callable
from typing import Any

from seatrial.errors import InputError
from seatrial.model.faults.catalogue import kinds
from seatrial.model.readable import person_scale

from .by_hand import ByHand
from .helm import Helm

_FASTEST = "as fast as it can"
_SPEEDS = ("0.1", "0.25", "0.5", "1", "2", "5", "10", "30", "100", _FASTEST)
CHOOSE_SETTING = "add a control ..."
_STEPS = 200
"""Of a slider."""


class Controls:
    """Widgets that command a run; who has the helm, uses them."""

    def __init__(
        self,
        gui: Any,
        helm: Helm,
        command: Callable[..., None],
        described: dict[str, Any],
        done: ByHand,
    ) -> None:
        self._gui, self._helm, self._command = gui, helm, command
        self._paused = False
        self._run_buttons(described, done)
        self._settings(described["settables"])
        self._faults(described)

    # ------------------------------------------------------------------ the run

    def _run_buttons(self, described: dict[str, Any], done: ByHand) -> None:
        gui = self._gui
        self._pause = gui.add_button("Pause")
        step = gui.add_button("Single step")
        self._pause.on_click(self._on_pause)
        step.on_click(self._on_step)
        if not described["paced"]:  # else the trial says how it keeps to wall time
            pace = described["pace"]
            now = _FASTEST if pace is None else f"{pace:g}"
            speed = gui.add_dropdown("times real time", _SPEEDS, initial_value=now)
            speed.on_update(lambda event: self._on_speed(event, speed.value))
        with gui.add_folder("Begin anew", expand_by_default=False):
            seed = gui.add_number("seed", int(described["manifest"]["seed"]), min=0, step=1)
            restart = gui.add_button("Restart")
            restart.on_click(lambda event: self._send(event, "restart", int(seed.value)))
            save = gui.add_button("Save what was done as a trial")
            save.on_click(lambda event: _download(event, done))

    def _send(self, event: Any, *message: Any) -> bool:
        if self._helm.may(event):
            self._command(*message)
            return True
        return False

    def _on_pause(self, event: Any) -> None:
        if self._send(event, "pause", not self._paused):
            self._show_paused(not self._paused)

    def _on_step(self, event: Any) -> None:
        if self._send(event, "step"):
            self._show_paused(True)

    def _on_speed(self, event: Any, written: str) -> None:
        if event.client is not None:
            self._send(event, "speed", None if written == _FASTEST else float(written))

    def _show_paused(self, paused: bool) -> None:
        self._paused = paused
        self._pause.label = "Go on" if paused else "Pause"

    # ------------------------------------------------------------------ set-points, tunables

    def _settings(self, settables: list[dict[str, Any]]) -> None:
        self._settables = {one["key"]: one for one in settables}
        self._shown: set[str] = set()
        if not settables:
            return
        self._folder = self._gui.add_folder("Set-points and tunables")
        with self._folder:
            choice = self._gui.add_dropdown(
                "port", (CHOOSE_SETTING, *sorted(self._settables)), hint="type to search"
            )

        def chosen(_: Any) -> None:
            key = choice.value
            if key != CHOOSE_SETTING:
                self._add_setting(self._settables[key])
                choice.value = CHOOSE_SETTING

        choice.on_update(chosen)

    def _add_setting(self, one: dict[str, Any]) -> None:
        key = one["key"]
        if key in self._shown:
            return
        self._shown.add(key)
        with self._folder:
            widget, written = self._widget(one)
        widget.on_update(
            lambda event: (
                event.client is not None and self._send(event, "set", key, written(widget.value))
            )
        )

    def _widget(self, one: dict[str, Any]) -> tuple[Any, Callable[[Any], Any]]:
        """Return a switch, a slider or a number, and what its value is written as."""
        key, hint = one["key"], one["description"] or None
        if one["is_switch"]:
            return self._gui.add_checkbox(key, bool(one["value"]), hint=hint), bool
        try:
            factor, unit = person_scale(one["unit"])
        except InputError:  # of somebody else's FMU
            factor, unit = 1.0, one["unit"]
        bare = unit in ("", "1")
        label = key if bare else f"{key}, {unit}"
        value = float(one["value"]) * factor
        low, high = (None if limit is None else limit * factor for limit in one["limits"])

        def written(shown: float) -> Any:
            return float(shown) if bare else f"{float(shown)!r} {unit}"

        if low is not None and high is not None and low < high:
            inside = min(max(value, low), high)
            step = (high - low) / _STEPS
            return self._gui.add_slider(label, low, high, step, inside, hint=hint), written
        step = 10.0 ** math.floor(math.log10(abs(value) or 1.0) - 1.0)
        return self._gui.add_number(label, value, min=low, max=high, step=step, hint=hint), written

    # ------------------------------------------------------------------ faults

    def _faults(self, described: dict[str, Any]) -> None:
        numbers = itertools.count()
        manifest = described["manifest"]
        places = [*manifest["components"], *sorted(manifest["signals"])]
        with self._gui.add_folder("Faults", expand_by_default=False):
            what = self._gui.add_dropdown("what", tuple(kinds()))
            where = self._gui.add_dropdown("where", tuple(places))
            settings = self._gui.add_text("settings", "", hint="as in a trial: value = 0.5")
            meaning = self._gui.add_html("")
            inject = self._gui.add_button("Inject")
            acting = self._gui.add_folder("acting")

        def explain(_: Any) -> None:
            kind = kinds()[what.value]
            takes = ", ".join(kind.settings) or "no settings"
            meaning.content = (
                f'<div style="font-size:.8em;padding:0 .8em">{kind.title}<br>takes: {takes}</div>'
            )

        what.on_update(explain)
        explain(None)

        def injected(event: Any) -> None:
            entry = {"what": what.value, "where": where.value}
            try:
                entry.update(_settings(settings.value))
            except InputError as error:
                event.client.add_notification("not understood", str(error), color="red")
                return
            number = next(numbers)
            if not self._send(event, "fault", number, entry):
                return
            with acting:
                end = self._gui.add_button(f"End: {entry['what']} on {entry['where']}")

            def ended(event: Any) -> None:
                if self._send(event, "clear", number):
                    end.remove()

            end.on_click(ended)

        inject.on_click(injected)


def _settings(text: str) -> dict[str, Any]:
    """Return settings written as ``value = 0.5, grows_over = "2 s"``, quotes or none."""
    from seatrial.system.fault_entry import read_fault

    if not text.strip():
        return {}
    found = read_fault(f"x=x, {text}", "settings")
    return {key: value for key, value in found.items() if key not in ("what", "where")}


def _download(event: Any, done: ByHand) -> None:
    if event.client is not None:
        event.client.send_file_download("by-hand.toml", done.text().encode())
