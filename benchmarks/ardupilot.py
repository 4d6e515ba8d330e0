"""Speed of the Hydrone under ArduPilot's lockstep at 400 Hz: ``python -m benchmarks.ardupilot``.

The stand-in for the firmware that the tests have, in a process of its own; the rig as a trial has
it, in process, with steps of 2.5 ms and a record every 0.2 s. Real time is the unit: 4 is a run
that takes a quarter of it. Processor time is this process's alone, without the stand-in's. The
same vehicle with its pulses held says what lockstep costs. Medians over rounds, and ranges.
``--write`` puts the table into docs/performance.md.
"""

from __future__ import annotations

import argparse
import platform
import statistics
import sys
import tempfile
import time
from pathlib import Path

from seatrial.trials.run import run_trial
from seatrial.trials.trial import load_trial

from .pages import addition, write_measured

ROOT = Path(__file__).parents[1]
_HELD = """
rig  = "vehicles/hydrone"
stop = "{seconds} s"
[record]
signals = ["hull.*"]
every   = "200 ms"
"""


def in_lockstep(seconds: float, folder: Path) -> tuple[float, float]:
    """Return simulated time per wall time and per processor time, with a peer that answers."""
    program = folder / "ardurover"
    peer = ROOT / "tests" / "links" / "ardupilot" / "peer.py"
    program.write_text(f'#!/bin/sh\nexec {sys.executable} {peer} "$@"\n')
    program.chmod(0o755)
    changes = {
        "stop": f"{seconds} s",
        "choices.step": "2.5 ms",
        "choices.program": str(program),
        "autopilot.sitl.ardupilot.link": "udpin:127.0.0.1:0",
    }
    return timed("under-ardupilot", changes, seconds, folder / "lockstep")


def held(seconds: float, folder: Path) -> tuple[float, float]:
    """Return the same of the vehicle alone."""
    trial = folder / "held.toml"
    trial.write_text(_HELD.format(seconds=seconds))
    return timed(str(trial), {"step": "2.5 ms"}, seconds, folder / "alone")


def timed(name: str, changes: dict[str, str], seconds: float, folder: Path) -> tuple[float, float]:
    """Run a trial."""
    trial = load_trial(name, changes=changes, origin="benchmark")
    begun = time.process_time()
    result = run_trial(trial, folder, engine="direct")
    used = time.process_time() - begun - result.wall["assemble"] - result.wall["initialise"]
    if result.status != "complete":
        raise RuntimeError(result.error)
    return seconds / result.wall["run"], seconds / used


def shown(found: list[float]) -> str:
    """Return the median and the range."""
    return f"{statistics.median(found):.1f} ({min(found):.1f} to {max(found):.1f})"


def main() -> None:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawTextHelpFormatter
    )
    parser.add_argument("--rounds", type=int, default=5)
    parser.add_argument("--seconds", type=float, default=20.0, help="of simulated time")
    parser.add_argument("--write", action="store_true", help="put it into docs/performance.md")
    options = parser.parse_args()
    ways = {"in lockstep with the tests' peer": in_lockstep, "the vehicle alone, pulses held": held}
    found: dict[str, list[tuple[float, float]]] = {way: [] for way in ways}
    for _ in range(options.rounds):
        for way, run in ways.items():
            with tempfile.TemporaryDirectory(prefix="seatrial-") as folder:
                found[way].append(run(options.seconds, Path(folder)))
    rows = [
        f"| {way} | {shown([wall for wall, _ in each])} | {shown([used for _, used in each])} |"
        for way, each in found.items()
    ]
    text = "\n".join(
        [
            f"Python {platform.python_version()}, {options.rounds} rounds of "
            f"{options.seconds:g} s; one addition in a loop takes {1e9 * addition():.0f} ns.",
            "",
            "| the Hydrone at 400 Hz, engine `direct` | simulated time per wall time "
            "| per processor time |",
            "| --- | --- | --- |",
            *rows,
        ]
    )
    print(text)
    if options.write:
        write_measured("performance.md", text, "ardupilot")


if __name__ == "__main__":
    main()
