"""A section of reports: heel and trim as the inclinometer shows them."""

from __future__ import annotations

import math
from collections.abc import Iterator

from seatrial.trial.records.run_folder import Run
from seatrial.trial.reports.plots import Line, Panel, time_figure

DEGREES = 180.0 / math.pi


def heel(run: Run) -> Iterator[tuple[str, str]]:
    """Yield title and figure for each inclinometer of a run."""
    for name, entry in run.manifest["components"].items():
        signals = [f"{name}.tilt.{axis}" for axis in ("heel", "trim")]
        if entry["fmu"] == "inclinometer" and all(signal in run.signals for signal in signals):
            lines = [Line(signal, run.signals[signal] * DEGREES) for signal in signals]
            figure = time_figure(run.time, [[Panel("heel and trim", "deg", lines, [])]], [], 1000)
            yield f"Heel and trim by {name}", figure.json()
