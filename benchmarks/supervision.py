"""Wall time of supervised trials beside unsupervised ones: ``python -m benchmarks.supervision``.

The same trial runs in the calling process and supervised, in turn, in one Python that has run both
before: what differs is the copy of the process, what the copy changes of the memory that they
share, the frames between them, and the end. In a fresh Python the import of the supervisor comes
on top, measured in some of them. The start ends when the run's folder is there: the components
are initialised, and the first step follows. Given are the medians, that of the differences of
pairs, and as a control the ratio of two runs that are both in the calling process.
``--write`` puts the table into docs/performance.md.
"""

from __future__ import annotations

import argparse
import platform
import statistics
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

from seatrial.system.system import Engine
from seatrial.trial.files.trial import load_trial
from seatrial.trial.running.hooks import Hooks
from seatrial.trial.running.run import run_trial
from seatrial.trial.running.supervision import run_supervised

from .pages import write_measured

_IMPORT = """
import gc, time
gc.set_threshold(200_000)  # as the command line has it
import seatrial.trial.running.run, seatrial.system.assembling.assembly, seatrial.fmi.loading.load
begun = time.perf_counter()
import seatrial.trial.running.supervision
print(time.perf_counter() - begun)
"""
_TRIAL = "hydrone-landing"
_SHORT, _LONG = "0.1 s", "10 s"

Times = tuple[float, float, float]
"""In the calling process, supervised, and in the calling process once more, s."""


@dataclass
class Run:
    """Wall times of one run, s."""

    start: float
    """From the call until the first step is next."""
    steps: float
    whole: float
    """From the call to the result."""


def measured(stop: str, engine: Engine) -> list[Run]:
    """Return the times of one run in each way: in the calling process, supervised, and again."""
    trial = load_trial(_TRIAL, changes={"stop": stop}, origin="benchmark")
    runs = []
    for run in (run_trial, run_supervised, run_trial):
        with tempfile.TemporaryDirectory(prefix="seatrial-") as out:
            claimed: list[float] = []
            hooks = Hooks(claimed=lambda _, at=claimed: at.append(time.perf_counter()))
            begun = time.perf_counter()
            result = run(trial, Path(out, "run"), engine=engine, hooks=hooks)
            whole = time.perf_counter() - begun
            runs.append(Run(claimed[0] - begun, result.wall["run"], whole))
    return runs


def _times(attribute: str) -> Callable[[list[Run]], Times]:
    def taken(runs: list[Run]) -> Times:
        first, supervised, again = (getattr(run, attribute) for run in runs)
        return first, supervised, again

    return taken


CASES: list[tuple[str, str, Engine, Callable[[list[Run]], Times]]] = [
    ("the start, engine 'direct'", _SHORT, "direct", _times("start")),
    ("the start, engine 'fmu'", _SHORT, "fmu", _times("start")),
    ("a whole trial of 0.1 s, engine 'direct'", _SHORT, "direct", _times("whole")),
    ("a whole trial of 0.1 s, engine 'fmu'", _SHORT, "fmu", _times("whole")),
    ("the steps of a trial of 10 s, engine 'direct'", _LONG, "direct", _times("steps")),
]


def imported() -> float:
    """Return the time that the import of the supervisor takes where trials are run already, s."""
    command = [sys.executable, "-c", _IMPORT]
    return float(subprocess.run(command, capture_output=True, text=True, check=True).stdout)


def rows(rounds: int) -> list[str]:
    """Return the rows of the table."""
    found = []
    for name, stop, engine, taken in CASES:
        measured(stop, engine)  # fills the caches
        times = [taken(measured(stop, engine)) for _ in range(rounds)]
        own = 1e3 * statistics.median(a for a, _, _ in times)
        supervised = 1e3 * statistics.median(b for _, b, _ in times)
        difference = 1e3 * statistics.median(b - a for a, b, _ in times)
        ratio = statistics.median(b / a for a, b, _ in times)
        control = statistics.median(b / a for a, _, b in times)
        found.append(
            f"| {name} | {own:.0f} | {supervised:.0f} | {difference:.0f} | {ratio:.2f} "
            f"| {control:.2f} |"
        )
    import_ms = f"{1e3 * statistics.median(imported() for _ in range(rounds)):.0f}"
    return [*found, f"| the import of the supervisor, in a fresh Python | | | {import_ms} | | |"]


def main() -> None:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawTextHelpFormatter
    )
    parser.add_argument("--rounds", type=int, default=40)
    parser.add_argument(
        "--write", action="store_true", help="put the table into docs/performance.md"
    )
    arguments = parser.parse_args()
    head = [
        f"Python {platform.python_version()}, {arguments.rounds} rounds, medians.\n",
        "| wall time of | in the calling process, ms | supervised, ms | difference, ms | ratio "
        "| of equal runs |",
        "| --- | --- | --- | --- | --- | --- |",
    ]
    text = "\n".join([*head, *rows(arguments.rounds)])
    print(text)
    if arguments.write:
        write_measured("performance.md", text, "measured of the supervision")


if __name__ == "__main__":
    main()
