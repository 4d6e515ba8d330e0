"""Accuracy of the coupling, for the report: a table of outputs and their errors over the step."""

from __future__ import annotations

from dataclasses import dataclass
from html import escape
from typing import Any

from ...model.readable import number, person_scale
from ..records.accuracy import Accuracy, by_port, order_text, spread_text
from ..running.convergence import Convergence
from .figure import Figure
from .plots import COLOURS, layout

_PLOTTED = 6


@dataclass(frozen=True)
class Row:
    """An output in the table, as text."""

    signal: str
    unit: str
    behaviour: str
    order: str
    spread: str
    """Least and greatest order; empty with two halvings."""
    differences: list[str]
    errors: list[str]
    relative: str


@dataclass(frozen=True)
class AccuracySection:
    """What the page shows of a convergence."""

    steps: list[str]
    rows: list[Row]
    """Worst first, without the exact ones."""
    exact: list[str]
    discrete: list[tuple[str, str]]
    """(signal, first time at which runs differ)."""
    failed: int
    """Outputs that do not converge."""
    figure: str | None
    """JSON for Plotly."""


def accuracy_section(found: Convergence) -> AccuracySection:
    """Return the section's content."""
    moving = [output for output in found.outputs if output.behaviour != "exact"]
    return AccuracySection(
        steps=[f"{number(step * 1e3, 9)} ms" for step in found.steps],
        rows=[_row(output) for output in moving],
        exact=[output.signal for output in found.outputs if output.behaviour == "exact"],
        discrete=[
            (one.signal, f"{number(next(at for at in one.differs_at if at is not None), 9)} s")
            for one in found.discrete
        ],
        failed=sum(output.behaviour == "not converging" for output in moving),
        figure=_figure(found, moving).json() if moving else None,
    )


def _row(output: Accuracy) -> Row:
    factor, unit = person_scale(output.unit)
    orders = output.orders
    return Row(
        signal=output.signal,
        unit="" if unit == "1" else unit,
        behaviour=output.behaviour,
        order=order_text(orders[-1]),
        spread=spread_text(orders),
        differences=[number(difference * factor, 3) for difference in output.differences],
        errors=[number(error * factor, 3) for error in output.errors],
        relative=f"{number(100 * output.relative, 3)} %" if output.range else "constant",
    )


def _figure(found: Convergence, moving: list[Accuracy]) -> Figure:
    """Return how the worst outputs differ from their runs at half the step, over the step."""
    figure = Figure()
    steps = [step * 1e3 for step in found.steps[:-1]]
    worst = [output for output in by_port(moving, found.components) if output.range][:_PLOTTED]
    for index, output in enumerate(worst):
        figure.trace(
            "scatter",
            x=steps,
            y=[d / output.range if d else None for d in output.differences],
            name=escape(output.signal),
            mode="lines+markers",
            line={"width": 1.6, "color": COLOURS[index % len(COLOURS)]},
            hovertemplate="%{y:.3g} of the range",
        )
    top = max((d / o.range for o in worst for d in o.differences), default=1.0)
    for order, dash in ((1, "dash"), (2, "dot")):
        figure.trace(
            "scatter",
            x=steps,
            y=[2 * top * (step / steps[0]) ** order for step in steps],
            name=f"slope {order}",
            mode="lines",
            line={"width": 1.2, "color": "#5b6770", "dash": dash},
            hoverinfo="skip",
        )
    figure.lay_out(height=380, showlegend=True, **layout())
    ticks: dict[str, Any] = {"tickvals": steps, "ticktext": [number(s, 6) for s in steps]}
    figure.x_axis(type="log", title={"text": "communication step, ms"}, **ticks)
    figure.y_axis(type="log", dtick="D2", title={"text": "difference, share of the range"})
    return figure
