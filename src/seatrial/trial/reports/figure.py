"""Figures as Plotly's JavaScript reads them: plain dictionaries, written as JSON.

Attributes are those of Plotly's reference, nested as there; nothing checks them here.
"""

from __future__ import annotations

import base64
import json
from collections.abc import Sequence
from typing import Any

import numpy as np

_FONT = {"size": 16}
_VISIBLE = 1e-4
"""Share of an array's range that rounding may move a point by: a hundredth of a pixel."""


class Figure:
    """Traces and layout, on one pair of axes or on several side by side.

    ``column`` says which pair, from 1 on. ``titles`` are those of the pairs, ``gap`` is the
    share of the width between them.
    """

    def __init__(self, titles: Sequence[str] = (), gap: float | None = None) -> None:
        self.data: list[dict[str, Any]] = []
        self.layout: dict[str, Any] = {}
        self._columns = max(1, len(titles))
        if titles:
            self._place(titles, 0.2 / len(titles) if gap is None else gap)

    def _place(self, titles: Sequence[str], gap: float) -> None:
        width = (1.0 - gap * (len(titles) - 1)) / len(titles)
        for column, title in enumerate(titles, start=1):
            left = (column - 1) * (width + gap)
            x, y = _axes(column)
            self.x_axis(column, anchor=y, domain=[left, min(left + width, 1.0)])
            self.y_axis(column, anchor=x, domain=[0.0, 1.0])
            self.annotate(
                x=left + width / 2,
                y=1.0,
                xref="paper",
                yref="paper",
                xanchor="center",
                yanchor="bottom",
                text=title,
                showarrow=False,
                font=_FONT,
            )

    def trace(self, kind: str, column: int = 0, **attributes: Any) -> None:
        """Add a trace of a kind: ``scatter``, ``bar``, ``scatterpolar``."""
        x, y = _axes(column)
        on = {"xaxis": x, "yaxis": y} if column else {}
        self.data.append({"type": kind, **attributes, **on})

    def annotate(self, column: int = 0, **attributes: Any) -> None:
        """Add an annotation, at axes if a column is named."""
        x, y = _axes(column)
        on = {"xref": x, "yref": y} if column else {}
        self.layout.setdefault("annotations", []).append({**on, **attributes})

    def shape(self, column: int = 1, **attributes: Any) -> None:
        """Add a shape."""
        x, y = _axes(column)
        self.layout.setdefault("shapes", []).append({"xref": x, "yref": y, **attributes})

    def horizontal(self, at: float, line: dict[str, Any]) -> None:
        """Add a line over the whole width."""
        self.shape(type="line", xref="x domain", x0=0, x1=1, y0=at, y1=at, line=line)

    def vertical(self, at: float, line: dict[str, Any], column: int = 1) -> None:
        """Add a line over the whole height."""
        y = f"{_axes(column)[1]} domain"
        self.shape(column, type="line", yref=y, y0=0, y1=1, x0=at, x1=at, line=line)

    def x_axis(self, column: int = 1, **attributes: Any) -> None:
        """Set attributes of a horizontal axis."""
        self.lay_out(**{_axis_key("x", column): attributes})

    def y_axis(self, column: int = 1, **attributes: Any) -> None:
        """Set attributes of a vertical axis."""
        self.lay_out(**{_axis_key("y", column): attributes})

    def lay_out(self, **attributes: Any) -> None:
        """Set attributes of the layout; those of a nested one are added to it."""
        _merge(self.layout, attributes)

    def json(self) -> str:
        """Return the figure as JSON that may stand inside a script element."""
        text = json.dumps({"data": self.data, "layout": self.layout}, default=_encoded)
        return text.replace("<", "\\u003c")


def _axes(column: int) -> tuple[str, str]:
    number = "" if column <= 1 else str(column)
    return f"x{number}", f"y{number}"


def _axis_key(letter: str, column: int) -> str:
    return f"{letter}axis{'' if column == 1 else column}"


def _merge(into: dict[str, Any], attributes: dict[str, Any]) -> None:
    for key, value in attributes.items():
        if isinstance(value, dict) and isinstance(into.get(key), dict):
            _merge(into[key], value)
        else:
            into[key] = dict(value) if isinstance(value, dict) else value


def _encoded(value: Any) -> Any:
    """Return an array as Plotly's typed array, of singles where nobody sees the difference."""
    if isinstance(value, np.generic):
        return value.item()
    if not isinstance(value, np.ndarray):
        raise TypeError(f"{type(value).__name__} in a figure")
    values = np.asarray(value, dtype="<f8")
    with np.errstate(over="ignore"):
        singles = values.astype("<f4")
    finite = values[np.isfinite(values)]
    error = np.abs(singles[np.isfinite(values)] - finite).max(initial=0.0)
    if not finite.size or error <= _VISIBLE * np.ptp(finite):
        values = singles
    return {"dtype": values.dtype.str[1:], "bdata": base64.b64encode(values.tobytes()).decode()}


DARK = {
    "#0b6ea8": "#58b4ea",
    "#d1690e": "#f2a154",
    "#3a8f5c": "#6fcf97",
    "#8a4fa3": "#c792df",
    "#8c6d31": "#d9b66b",
    "#4a5a68": "#b3c1cc",
    "#1f7a4d": "#5cc58d",
    "#b3261e": "#ff8a80",
    "#a15c00": "#e8a84a",
    "#5b6770": "#a3b0ba",
    "#1d2730": "#e6ebef",
    "#9aa5af": "#6b7883",
    "#b4bdc5": "#6b7883",
    "#c9d1d8": "#4a5862",
    "#e6eaee": "#2e3a43",
    "#f1f4f7": "#26323b",
    "#ffffff": "#182128",
}
"""Names of CSS custom properties are not known to Plotly: it draws with what it is given."""
