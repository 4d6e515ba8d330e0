"""Tables of sea trials in the vehicles' pages, of the figures that docs/sea_trials.py has kept."""

from __future__ import annotations

import json
import tomllib
from collections.abc import Iterator
from functools import partial
from pathlib import Path
from typing import Any

from parts import part
from parts.markdown import table
from seatrial.model.readable import number, person_scale

FOLDER = Path(__file__).resolve().parents[1] / "vehicles/sea-trials"
ROWS = {
    "turning-circle": ("advance", "transfer", "tactical_diameter", "steady_diameter", "speed_loss",
                       "steady_drift", "largest_heel"),
    "zig-zag-10": ("overshoot_1", "overshoot_2", "nomoto_K'", "nomoto_T'"),
    "zig-zag-20": ("overshoot_1", "overshoot_2"),
    "initial-turning": ("initial_turning_track",),
    "pull-out": ("residual_share",),
    "williamson": ("offset", "turn_time"),
    "spiral": ("loop_height", "loop_width"),
    "reverse-spiral": ("neutral_helm", "loop_width"),
    "crash-stop": ("track_reach", "stopping_time"),
    "stopping": ("track_reach", "stopping_time"),
    "acceleration": ("final_speed", "acceleration_time", "acceleration_distance"),
    "speed-trial": ("speed_1", "power_1", "speed_2", "power_2", "speed_3", "power_3", "speed_4",
                    "power_4", "speed_power_exponent"),
    "turn-on-the-spot": ("rate_of_turn", "time_360", "largest_drift"),
    "bollard-pull": ("bollard_pull", "power"),
    "station-keeping": ("radius_95", "heading_error_95", "power"),
    "depth-step": ("rise_time", "overshoot", "settling_time"),
    "vertical-zig-zag": ("execute_time", "overshoot_pitch", "overshoot_depth"),
}  # fmt: skip
"""Figures of the tables, by trial."""


def _part(vehicle: str) -> str:
    """Return the table of a vehicle, and what is said of it."""
    trials = json.loads((FOLDER / f"{vehicle}.json").read_text("utf-8"))
    known = tomllib.loads((FOLDER / "published.toml").read_text("utf-8")).get(vehicle, {})
    head = ("trial", "figure", "to starboard", "to port", "of the real one")
    width = len(head) if "published" in known else len(head) - 1
    rows = _rows(trials, known.get("published", {}))
    text = table(head[:width], [row[:width] for row in rows])
    remarks = "".join(f"- {remark}\n" for remark in known.get("remarks", []))
    return f"{text}\n{remarks}" if remarks else text


def _rows(trials: list[dict[str, Any]], published: dict[str, str]) -> Iterator[tuple[str, ...]]:
    for name, figures in ROWS.items():
        runs = {run["side"]: run for run in trials if run["trial"] == name}
        for run in runs.values():
            if run["error"]:
                yield f"`{name}`", run["error"].replace("|", "/"), "–", "–", ""
        for figure in figures:
            cells = [_shown(runs.get(side), figure) for side in ("starboard", "port")]
            if any(cell != "–" for cell in cells):
                real = published.get(f"{name}.{figure}", "")
                yield f"`{name}`", figure.replace("_", " "), *cells, real


def _shown(run: dict[str, Any] | None, figure: str) -> str:
    """Return a figure as a person writes it, in ship lengths too, or a dash without."""
    if run is None or figure not in run["figures"]:
        return "–"
    value, si = run["figures"][figure]
    factor, unit = person_scale(si)
    text = f"{number(factor * value)} {unit if unit != '1' else ''}".rstrip()
    return f"{text} ({number(value / run['length'])} L)" if si == "m" and run["length"] else text


for _path in sorted({*FOLDER.glob("*.json")} - {FOLDER / "measured.json"}):
    part(f"sea-trials-{_path.stem}")(partial(_part, _path.stem))
