"""Wall time of supervised trials beside unsupervised ones: ``python -m benchmarks.supervision``.

The same trial runs supervised and in the calling process, in turn, for some rounds: each in a
fresh Python, whose wall time from start to end is compared for a trial of 0.1 s, and the wall time
of the steps alone for a long one in process. Compared are the fastest of all rounds, since what
else a machine does only adds; the range of the ratios of single rounds says how much that was.
``--write`` puts the table into docs/performance.md. The first round fills the caches and is left
out.
"""

from __future__ import annotations

import argparse
import os
import platform
import subprocess
import sys
import tempfile
import time

from .pages import write_measured

_RUN = """
import sys
from pathlib import Path
from seatrial.trials.{module} import {function} as run
from seatrial.trials.trial import load_trial
trial = load_trial("hydrone-landing", changes={{"stop": sys.argv[1]}}, origin="benchmark")
print(run(trial, Path(sys.argv[2]), engine=sys.argv[3]).wall["run"])
"""
WAYS = {
    "in the calling process": _RUN.format(module="run", function="run_trial"),
    "supervised": _RUN.format(module="supervision", function="run_supervised"),
}
CASES = {
    "start to end of a trial of 0.1 s, engine 'direct'": ("0.1 s", "direct", False),
    "the same, engine 'fmu'": ("0.1 s", "fmu", False),
    "the steps of a trial of 100 s, engine 'direct'": ("100 s", "direct", True),
}
"""Stop time, engine, and whether the time of the steps alone is taken."""


def taken(code: str, stop: str, engine: str, steps_alone: bool, folder: str) -> float:
    """Return the wall time of a run, s."""
    with tempfile.TemporaryDirectory(dir=folder) as out:
        environment = {k: v for k, v in os.environ.items() if k != "PYTHONDONTWRITEBYTECODE"}
        begun = time.perf_counter()
        done = subprocess.run(
            [sys.executable, "-c", code, stop, f"{out}/run", engine],
            env={**environment, "SEATRIAL_CACHE": f"{folder}/cache"},
            capture_output=True,
            text=True,
            check=True,
        )
        whole = time.perf_counter() - begun
    return float(done.stdout.splitlines()[-1]) if steps_alone else whole


def measure(rounds: int) -> dict[str, list[tuple[float, ...]]]:
    """Return the times of each case in each round, in the order of `WAYS`."""
    found: dict[str, list[tuple[float, ...]]] = {name: [] for name in CASES}
    with tempfile.TemporaryDirectory(prefix="seatrial-") as folder:
        for number in range(-1, rounds):
            for name, case in CASES.items():
                codes = list(WAYS.values())
                order = codes if number % 2 else codes[::-1]  # neither is always the second
                times = {code: taken(code, *case, folder) for code in order}
                if number >= 0:
                    found[name].append(tuple(times[code] for code in codes))
    return found


def table(found: dict[str, list[tuple[float, ...]]]) -> str:
    """Return the table in Markdown."""
    rows = [
        "| wall time of | in the calling process, s | supervised, s | difference, ms | ratio |",
        "| --- | --- | --- | --- | --- |",
    ]
    for name, pairs in found.items():
        own, supervised = (min(times) for times in zip(*pairs, strict=True))
        ratios = [b / a for a, b in pairs]
        difference = (supervised - own) * 1e3
        ratio = f"{supervised / own:.3f} ({min(ratios):.3f} to {max(ratios):.3f})"
        rows.append(f"| {name} | {own:.3f} | {supervised:.3f} | {difference:.0f} | {ratio} |")
    return "\n".join(rows)


def main() -> None:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawTextHelpFormatter
    )
    parser.add_argument("--rounds", type=int, default=15)
    parser.add_argument(
        "--write", action="store_true", help="put the table into docs/performance.md"
    )
    arguments = parser.parse_args()
    text = f"Python {platform.python_version()}, {arguments.rounds} rounds.\n\n"
    text += table(measure(arguments.rounds))
    print(text)
    if arguments.write:
        write_measured("performance.md", text, "measured of the supervision")


if __name__ == "__main__":
    main()
