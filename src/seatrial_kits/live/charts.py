"""Charts of signals over time in the page's panel, chosen by search."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
from viser import uplot

from seatrial.errors import InputError
from seatrial.model.readable import from_si, person_scale
from seatrial.trial.criteria.expressions import FloatArray

_MOST = 6
_POINTS = 600
_COLOURS = ("#0b6fb2", "#c62f24")
_LIMIT = "#d79a00"
CHOOSE = "add a chart ..."


class Charts:
    """Charts of a run's signals; `update` draws what is recorded."""

    def __init__(self, gui: Any, manifest: Mapping[str, Any], limits: Any = ()) -> None:
        self._gui = gui
        self._signals = {
            name: of["unit"]
            for name, of in manifest["signals"].items()
            if of.get("type") in (None, "Real", "Integer", "Boolean")
        }
        self._limits = [(signal, value) for signal, value, _ in limits]
        self._charts: dict[str, Any] = {}
        self._folder = gui.add_folder("Charts")
        with self._folder:
            self._choice = gui.add_dropdown(
                "signal", (CHOOSE, *sorted(self._signals)), hint="type to search"
            )
            self._clear = gui.add_button("remove all charts", visible=False)
        self._choice.on_update(lambda _: self._chosen())
        self._clear.on_click(lambda _: self.clear())
        self.changed = True
        """Whether there is a chart that has not been drawn."""

    @property
    def shown(self) -> list[str]:
        """Names of the signals that are drawn."""
        return list(self._charts)

    def add(self, signal: str) -> None:
        """Draw a signal below the others; the first one goes if there are too many."""
        if signal not in self._signals or signal in self._charts:
            return
        if len(self._charts) >= _MOST:
            self._charts.pop(next(iter(self._charts))).remove()
        _, unit = _scale(self._signals[signal])
        limits = [v for s, v in self._limits if s == signal]
        series = [
            uplot.Series(label="t, s"),
            uplot.Series(label="run", stroke=_COLOURS[0], width=2),
        ]
        series.append(uplot.Series(label="other", stroke=_COLOURS[1], width=1))
        limit = uplot.Series(label="limit", stroke=_LIMIT, width=1, dash=(6.0, 4.0))
        series += [limit] * len(limits)
        empty = np.zeros(1)
        with self._folder:
            self._charts[signal] = self._gui.add_uplot(
                tuple(empty for _ in series),
                tuple(series),
                title=f"{signal}{f', {unit}' if unit not in ('', '1') else ''}",
                scales={"x": uplot.Scale(time=False)},
                legend=uplot.Legend(show=False),
                height=170,
            )
        self._clear.visible = True
        self.changed = True

    def clear(self) -> None:
        """Remove all charts."""
        for chart in self._charts.values():
            chart.remove()
        self._charts.clear()
        self._clear.visible = False

    def update(self, time: FloatArray, signals: Mapping[str, Any], other: Any = None) -> None:
        """Draw rows of a record, and those (time, signals) of a second run beside it."""
        self.changed = False
        rows = np.unique(np.linspace(0, len(time) - 1, min(len(time), _POINTS)).astype(int))
        x = time[rows] if len(time) else np.zeros(1)
        for signal, chart in list(self._charts.items()):
            factor, unit = _scale(self._signals[signal])
            column = signals.get(signal)
            y = np.full(len(x), np.nan)
            if isinstance(column, np.ndarray) and len(time):
                y = column[rows] * factor
            y2 = np.full(len(x), np.nan)
            second = None if other is None else other[1].get(signal)
            if other is not None and isinstance(second, np.ndarray):
                y2 = np.interp(x, other[0], second * factor, right=np.nan)
            limits = [np.full(len(x), from_si(v, unit)) for s, v in self._limits if s == signal]
            chart.data = (x, y, y2, *limits)

    def _chosen(self) -> None:
        signal = self._choice.value
        if signal != CHOOSE:
            self.add(signal)
            self._choice.value = CHOOSE


def _scale(unit: str) -> tuple[float, str]:
    try:
        return person_scale(unit)
    except InputError:  # of somebody else's FMU
        return 1.0, ""
