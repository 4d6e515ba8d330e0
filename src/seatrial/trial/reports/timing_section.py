"""Wall time of a run, for its report: tables and histograms from ``timing.json``."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from html import escape
from typing import Any

from ...model.readable import number
from .figure import Figure
from .plots import COLOURS, layout

_UNITS = ((1.0, "s"), (1e-3, "ms"), (1e-6, "µs"), (1e-9, "ns"))
_PATTERNS = ("", "/", "x", ".")
_PACING = {
    "overruns": "late: steps that ended after their deadline",
    "slack": "slack: steps that ended before it, and waited",
    "wake_ups": "woken late: from the deadline to the end of the wait",
}


@dataclass(frozen=True)
class Durations:
    """A row of a table: how many, and how long, as text."""

    name: str
    count: int
    mean: str
    p50: str
    p99: str
    longest: str
    longest_at: str


@dataclass(frozen=True)
class Distribution:
    """A table of durations with its histogram, JSON for Plotly."""

    rows: list[Durations]
    figure: str


def step_times(timing: Mapping[str, Any]) -> Distribution | None:
    """Return how long the steps of each component took, None if ``timing.json`` lacks it."""
    found = timing.get("step_times")
    return _distribution(found) if found else None


def pacing(timing: Mapping[str, Any]) -> Distribution | None:
    """Return how the run kept to wall time, None if it was free."""
    found = timing.get("pacing")
    return _distribution({label: found[key] for key, label in _PACING.items()}) if found else None


def duration_text(value: float) -> str:
    """Return a time in s as a person reads it: 3.1 ms, 850 ns.

    >>> duration_text(0.0031), duration_text(8.5e-7), duration_text(0.0)
    ('3.1 ms', '850 ns', '0 s')
    """
    for factor, unit in _UNITS:
        if value >= factor:
            return f"{number(value / factor, 3)} {unit}"
    return "0 s"


def _distribution(found: Mapping[str, Mapping[str, Any]]) -> Distribution:
    rows = [_durations(name, entry) for name, entry in found.items()]
    return Distribution(rows, _histogram({n: e["bins"] for n, e in found.items()}).json())


def _durations(name: str, entry: Mapping[str, Any]) -> Durations:
    if not entry["steps"]:
        return Durations(name, 0, "–", "–", "–", "–", "–")
    return Durations(
        name,
        entry["steps"],
        mean=duration_text(entry["mean_s"]),
        p50=duration_text(entry["p50_at_most_s"]),
        p99=duration_text(entry["p99_at_most_s"]),
        longest=duration_text(entry["longest_s"]),
        longest_at=f"{number(entry['longest_at_s'], 9)} s",
    )


def _histogram(bins: Mapping[str, list[int]]) -> Figure:
    """Return grouped bars, one group for each duration from 2^(b-1) to 2^b ns."""
    used = [b for counts in bins.values() for b, count in enumerate(counts) if count]
    shown = range(min(used, default=0), max(used, default=-1) + 1)
    labels = [f"< {duration_text((1 << b) * 1e-9)}" for b in shown]
    figure = Figure()
    for index, (name, counts) in enumerate(bins.items()):
        figure.trace(
            "bar",
            x=labels,
            y=[counts[b] if b < len(counts) else 0 for b in shown],
            name=escape(name.partition(":")[0]),
            marker={
                "color": COLOURS[index % len(COLOURS)],
                "pattern": {"shape": _PATTERNS[index // len(COLOURS) % len(_PATTERNS)]},
            },
            hovertemplate="%{y} steps",
        )
    figure.lay_out(
        height=280,
        barmode="group",
        bargap=0.15,
        showlegend=True,
        legend={"orientation": "h", "y": 1.15},
        **layout(),
    )
    figure.x_axis(title={"text": "duration"}, type="category")
    figure.y_axis(title={"text": "steps"})
    return figure
