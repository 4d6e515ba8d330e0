"""Speed of vehicles under ArduPilot's lockstep at 400 Hz: ``python -m benchmarks.ardupilot``.

The firmware is the stand-in that the tests have, in a process of its own; where SEATRIAL_ARDUPILOT
names the folder of ArduPilot's ``ardusub``, that program too, which is sent round the square. It
listens at every interface: ``unshare -rn sh -c "ip link set lo up && ..."`` gives it a network of
its own. Steps of 2.5 ms, a record every 0.2 s. Real time is the unit: 4 is a run that takes a
quarter of it. Processor time is this process's alone, without the firmware's. The same vehicle with
its pulses held says what lockstep costs. Medians over rounds, and ranges. ``--write`` puts the
table into docs/performance.md.
"""

from __future__ import annotations

import argparse
import os
import platform
import statistics
import sys
import tempfile
from pathlib import Path
from typing import Literal

from seatrial.trial.files.trial import load_trial
from seatrial.trial.records.run_folder import load_run
from seatrial.trial.running.run import run_trial

from .pages import addition, write_measured

ROOT = Path(__file__).parents[1]
PROGRAMS = os.environ.get("SEATRIAL_ARDUPILOT", "")
Engine = Literal["direct", "native"]
_HELD = """
rig  = "vehicles/{vehicle}"
stop = "{seconds} s"
[record]
signals = ["hull.*"]
every   = "200 ms"
"""


def with_stand_in(vehicle: str, engine: Engine, seconds: float, folder: Path) -> float:
    """Return simulated time per wall time, with a peer that answers."""
    program = folder / "firmware"
    peer = ROOT / "tests" / "kits" / "ardupilot" / "peer.py"
    program.write_text(f'#!/bin/sh\nexec {sys.executable} {peer} "$@"\n')
    program.chmod(0o755)
    changes = {"autopilot.sitl.ardupilot.link": "udpin:127.0.0.1:0"}
    return _under("under-ardupilot", changes, program, vehicle, engine, seconds, folder)


def with_firmware(vehicle: str, engine: Engine, seconds: float, folder: Path) -> float:
    """Return the same of ArduPilot's own program, on its way round the square."""
    return _under("square", {}, Path(PROGRAMS, "ardusub"), vehicle, engine, seconds, folder)


def _under(
    trial: str,
    changes: dict[str, str],
    program: Path,
    vehicle: str,
    engine: Engine,
    seconds: float,
    folder: Path,
) -> float:
    common = {
        "stop": f"{seconds} s",
        "choices.vehicle": vehicle,
        "choices.autopilot": "ardupilot",
        "choices.step": "2.5 ms",
        "choices.program": str(program.resolve()),
        "autopilot.sitl.ardupilot.speedup": "1000",
    }
    return timed(trial, {**common, **changes}, engine, seconds, folder)


def held(vehicle: str, engine: Engine, seconds: float, folder: Path) -> float:
    """Return the same of the vehicle alone."""
    trial = folder / "held.toml"
    trial.write_text(_HELD.format(vehicle=vehicle, seconds=seconds))
    return timed(str(trial), {"step": "2.5 ms"}, engine, seconds, folder)


def timed(
    name: str, changes: dict[str, str], engine: Engine, seconds: float, folder: Path
) -> float:
    """Run a trial."""
    trial = load_trial(name, changes=changes, origin="benchmark")
    result = run_trial(trial, folder / "run", engine=engine)
    if result.status not in ("complete", "ended"):  # an ROV whose pulses are a boat's capsizes
        raise RuntimeError(result.error)
    return float(load_run(folder / "run").time[-1]) / result.wall["run"]


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
    ways = {"the vehicle alone, pulses held": held, "with the tests' stand-in": with_stand_in}
    if PROGRAMS:
        ways["with ArduPilot's `ardusub`"] = with_firmware
    cases = [
        (vehicle, engine, way)
        for vehicle in ("hydrone", "bluerov2", "videoray")
        for engine in ("direct", "native")
        for way in ways
        if way != "with ArduPilot's `ardusub`" or vehicle != "hydrone"
    ]
    found: dict[tuple[str, str, str], list[float]] = {case: [] for case in cases}
    for _ in range(options.rounds):
        for vehicle, engine, way in cases:
            with tempfile.TemporaryDirectory(prefix="seatrial-") as folder:
                run = ways[way](vehicle, engine, options.seconds, Path(folder))
                found[vehicle, engine, way].append(run)
    rows = [
        f"| `{vehicle}` | {way} | "
        f"{shown(found[vehicle, 'direct', way])} | {shown(found[vehicle, 'native', way])} |"
        for vehicle, engine, way in cases
        if engine == "direct"
    ]
    text = "\n".join(
        [
            f"Python {platform.python_version()}, {options.rounds} rounds of "
            f"{options.seconds:g} s; one addition in a loop takes {1e9 * addition():.0f} ns.",
            "",
            "| simulated time per wall time, 400 Hz | | engine `direct` | engine `native` |",
            "| --- | --- | --- | --- |",
            *rows,
        ]
    )
    print(text)
    if options.write:
        write_measured("performance.md", text, "ardupilot")


if __name__ == "__main__":
    main()
