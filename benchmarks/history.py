"""History of what benchmarks measured, one line of JSON per run in ``benchmarks/history.jsonl``.

A line has the commit, when it was, and ratios of one run by name, each the larger the worse. A
ratio that is 1.5 times that of the line before is reported, and is no failure: machines differ.
"""

from __future__ import annotations

import datetime
import json
import platform
import subprocess
from collections.abc import Mapping
from pathlib import Path

HISTORY = Path(__file__).with_name("history.jsonl")
_WORSE = 1.5


def noted(what: str, ratios: Mapping[str, float]) -> str:
    """Add a line for the benchmark ``what``; return what has worsened since, as Markdown."""
    before = last(what)
    line = {
        "what": what,
        "commit": _commit(),
        "date": datetime.datetime.now(datetime.UTC).date().isoformat(),
        "python": platform.python_version(),
        "machine": platform.machine(),
        "ratios": {name: round(value, 4) for name, value in ratios.items()},
    }
    with HISTORY.open("a", encoding="utf-8") as file:
        file.write(json.dumps(line) + "\n")
    worse = [
        f"{name}: {before[name]:.3g} to {value:.3g}"
        for name, value in ratios.items()
        if name in before and value > _WORSE * before[name]
    ]
    if not worse:
        return "No ratio has worsened by half since the run before."
    return f"Worse by half or more than in the run before: {'; '.join(worse)}."


def last(what: str) -> dict[str, float]:
    """Return the ratios of the last line of a benchmark, none if there is no line."""
    if not HISTORY.is_file():
        return {}
    lines = [json.loads(line) for line in HISTORY.read_text("utf-8").splitlines()]
    found = [line["ratios"] for line in lines if line["what"] == what]
    return dict(found[-1]) if found else {}


def _commit() -> str:
    command = ["git", "rev-parse", "--short", "HEAD"]
    done = subprocess.run(command, capture_output=True, text=True, cwd=HISTORY.parent)
    return done.stdout.strip() or "?"
