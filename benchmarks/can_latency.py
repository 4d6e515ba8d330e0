"""Latency on a CAN bus against its load: ``python -m benchmarks.can_latency``.

Runs the trial ``can-load`` at 10 to 120 % of load, and shows the statistics that each run leaves.
``--write`` puts the table into docs/kits/can/can.md and draws docs/images/can-latency.svg.
Simulated time: the same figures on every machine.
"""

from __future__ import annotations

import argparse
import json
import math
import tempfile
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from seatrial.trial.files.trial import load_trial
from seatrial.trial.running.run import run_trial

from .pages import DOCS, write_measured

IMAGE = DOCS / "images" / "can-latency.svg"
OWN = 0.1
"""Load of the rig's own messages."""
LOADS = [k / 10 for k in range(1, 13)]
FRAMES = {
    "0x0CF00100": ("autopilot's orders", "#0b6e99"),
    "0x0DF80502": ("GNSS position", "#2a9d5c"),
    "0x1DEF0003": ("display's state", "#c06c00"),
    "0x1DEFFF03": ("background", "#8a8a8a"),
}
"""By identifier, the highest priority first."""
LEFT, RIGHT, TOP, BOTTOM = 70, 530, 20, 300
LOWEST, HIGHEST = 2e-4, 1.0
"""Range of the latency axis, s."""


def run(load: float, folder: Path) -> dict[str, Any]:
    """Return the statistics of a run."""
    changes = {"display.load": round(load - OWN, 3)}
    trial = load_trial("can-load").changed(changes, "this figure")
    result = run_trial(trial, folder, engine="direct")
    if result.status != "complete":
        raise SystemExit(result.error)
    found: dict[str, Any] = json.loads((folder / "can.json").read_text("utf-8"))
    return found


def latencies(found: dict[str, Any], identifier: str) -> dict[str, float] | None:
    """Return the latencies of one identifier, s; None if it was never sent."""
    rows = (row for row in found["identifiers"] if row["identifier"] == identifier)
    return next((row["latency_s"] for row in rows), None)


def table(runs: Sequence[dict[str, Any]]) -> str:
    """Return median and largest latencies in Markdown."""
    names = [name for name, _ in FRAMES.values()]
    lines = [
        "| load offered | measured | " + " | ".join(f"{n}, ms" for n in names) + " | dropped |",
        "| --- " * (3 + len(names)) + "|",
    ]
    for load, found in zip(LOADS, runs, strict=True):
        cells = []
        for identifier in FRAMES:
            each = latencies(found, identifier)
            cells.append(
                "" if each is None else f"{1e3 * each['p50']:.2f} / {1e3 * each['max']:.2f}"
            )
        dropped = sum(node["dropped"] for node in found["nodes"])
        lines.append(f"| {load:.0%} | {found['load']:.1%} | {' | '.join(cells)} | {dropped} |")
    return "\n".join(lines)


def figure(runs: Sequence[dict[str, Any]]) -> str:
    """Return the largest and the median latencies as SVG."""
    parts = [
        '<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 720 350" '
        'font-family="sans-serif" font-size="12">',
        '<rect width="720" height="350" fill="white"/>',
    ]
    for k in range(0, 13, 2):
        x = _x(k / 10)
        parts.append(_line((x, TOP), (x, BOTTOM), "#dddddd"))
        parts.append(_text(x, BOTTOM + 18, f"{10 * k} %", "middle"))
    for exponent in range(-3, 1):
        y = _y(10.0**exponent)
        parts.append(_line((LEFT, y), (RIGHT, y), "#dddddd"))
        parts.append(_text(LEFT - 8, y + 4, f"{1000 * 10.0**exponent:g} ms", "end"))
    parts.append(_text((LEFT + RIGHT) / 2, BOTTOM + 40, "load offered", "middle"))
    for place, (identifier, (name, colour)) in enumerate(FRAMES.items()):
        for which, dash in (("max", ""), ("p50", "4 3")):
            points = [
                (_x(load), _y(each[which]))
                for load, found in zip(LOADS, runs, strict=True)
                if (each := latencies(found, identifier)) is not None
            ]
            shown = " ".join(f"{x:.1f},{y:.1f}" for x, y in points)
            parts.append(
                f'<polyline points="{shown}" fill="none" stroke="{colour}" stroke-width="2" '
                f'stroke-dasharray="{dash}"/>'
            )
        y = TOP + 16 + 20 * place
        parts.append(_line((RIGHT + 15, y - 4), (RIGHT + 40, y - 4), colour))
        parts.append(_text(RIGHT + 46, y, name, "start"))
    parts.append(_text(RIGHT + 15, TOP + 106, "largest (line), median (dashes)", "start"))
    return "\n".join([*parts, "</svg>", ""])


def _x(load: float) -> float:
    return LEFT + (RIGHT - LEFT) * load / 1.2


def _y(latency: float) -> float:
    share = math.log(latency / LOWEST) / math.log(HIGHEST / LOWEST)
    return BOTTOM - (BOTTOM - TOP) * share


def _line(start: tuple[float, float], end: tuple[float, float], colour: str) -> str:
    (x1, y1), (x2, y2) = start, end
    return (
        f'<line x1="{x1:.1f}" y1="{y1:.1f}" x2="{x2:.1f}" y2="{y2:.1f}" stroke="{colour}" '
        'stroke-width="1.5"/>'
    )


def _text(x: float, y: float, text: str, anchor: str) -> str:
    return f'<text x="{x:.1f}" y="{y:.1f}" text-anchor="{anchor}">{text}</text>'


def main() -> None:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawTextHelpFormatter
    )
    parser.add_argument("--write", action="store_true", help="put table and figure into docs")
    options = parser.parse_args()
    with tempfile.TemporaryDirectory() as folder:
        runs = [run(load, Path(folder, f"{load:g}")) for load in LOADS]
    text = table(runs)
    print(text)
    if options.write:
        write_measured("kits/can/can.md", text, "latencies")
        IMAGE.write_text(figure(runs), "utf-8")


if __name__ == "__main__":
    main()
