"""The square under ArduPilot's own firmware, in every sea and with every fault, as a table.

``python -m tests.interop.firmware_matrix`` runs each vehicle in each sea with each fault, where
SEATRIAL_ARDUPILOT names the folder of ``ardurover`` and ``ardusub``; ``--write`` puts the table
into docs/kits/ardupilot/autopilots.md, ``--only TEXT`` runs the cases whose name has it. Each run has a network of
its own. Finished cases are kept in ``--folder`` and not run again.
"""

from __future__ import annotations

import argparse
import math
import os
import shutil
import subprocess
import sys
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from itertools import product
from pathlib import Path

import numpy as np

from benchmarks.pages import write_measured
from seatrial.system.parameters import load_vehicle
from seatrial.trial.records.run_folder import Run, load_run
from tests.command import SEATRIAL

from .test_dronecan_multicast import ROOT, alone, can_be_alone


@dataclass(frozen=True)
class Vehicle:
    """Firmware, communication step, and the times of a fault and of the end, s."""

    firmware: str
    step: str
    fault_at: float
    stop: float
    thruster: str
    loss: str = "off"
    """What happens to the thruster."""
    compass: str = "vehicle.compass"
    gnss: str = "vehicle.gnss"


_UNDER_WATER = {"compass": "vehicle.ahrs", "gnss": "vehicle.positioning"}
VEHICLES = {
    "hydrone": Vehicle("rover", "10 ms", 100.0, 300.0, "vehicle.port_thruster"),
    "otter": Vehicle("rover", "10 ms", 80.0, 260.0, "vehicle.port_propeller"),
    "mariner": Vehicle("rover", "10 ms", 700.0, 3600.0, "vehicle.machine", "stuck"),
    "bluerov2": Vehicle("sub", "2.5 ms", 70.0, 220.0, "vehicle.thrusters.t1", **_UNDER_WATER),
    "videoray": Vehicle("sub", "2.5 ms", 70.0, 220.0, "vehicle.thrusters.port", **_UNDER_WATER),
}
_CURRENT = 'current = { speed = "0.4 m/s", direction = "90 deg" }'
_WIND = 'wind = { speed = "5 m/s", direction = "60 deg", spectrum = "norsok" }'
_WAVES = 'sea = { spectrum = "jonswap", height = "20 cm", period = "3 s", direction = "90 deg", components_per_octave = 20 }'
SEAS = {
    "calm": (),
    "current": (_CURRENT,),
    "wind": (_WIND,),
    "waves": (_WAVES,),
    "all": (_CURRENT, _WIND, _WAVES),
}
_FAULT = '[[faults]]\nwhere = "{where}"\nwhat = "{what}"\nat = "{at} s"'
_EVENT = '[[events]]\nat = "{at} s"\nset = {{ "mission.station.{port}" = true }}'
FAULTS = {
    "none": "",
    "GNSS lost": _FAULT.replace("{where}", "{gnss}").replace("{what}", "off"),
    "compass off": _FAULT.replace("{where}", "{compass}").replace("{what}", "off"),
    "thruster lost": _FAULT.replace("{where}", "{thruster}").replace("{what}", "{loss}"),
    "battery low": _EVENT.replace("{port}", "without.battery"),
    "station lost": _EVENT.replace("{port}", "silent"),
}
TRIAL = """
rig     = "square"
choices = {{ vehicle = "{vehicle}", autopilot = "ardupilot", program = "{program}", step = "{step}" }}
stop    = "{stop} s"
{sea}
[set]
"autopilot.sitl.ardupilot.speedup" = 60
[record]
signals = ["vehicle.motion.*", "marks.*", "mission.station.*"]
every   = "200 ms"
[[criteria]]
name  = "it passes every corner, and comes back"
check = "within {stop} s marks.left < 1"
ends  = true
{fault}
"""
MODES = {
    "rover": {4: "HOLD", 10: "AUTO", 11: "RTL", 12: "SMART_RTL", 0: "MANUAL"},
    "sub": {3: "AUTO", 2: "ALT_HOLD", 9: "SURFACE", 19: "MANUAL", 0: "STABILIZE"},
}
NO_WIND = ("bluerov2", "videoray")
"""Vehicles that no wind reaches: their sea of winds is the calm one."""


def cases(only: str) -> list[tuple[str, str, str]]:
    """Return vehicle, sea, and fault of each case; the ship, which takes an hour, in two seas."""
    return [
        case
        for case in product(VEHICLES, SEAS, FAULTS)
        if only in "/".join(case)
        and not (case[0] in NO_WIND and case[1] == "wind")
        and not (case[0] == "mariner" and case[1] not in ("calm", "all"))
    ]


def run(case: tuple[str, str, str], programs: Path, folder: Path) -> Run:
    """Run a case, or read it where it was run. Raises RuntimeError for one that does not end."""
    name, sea, fault = case
    vehicle = VEHICLES[name]
    own = folder / "-".join(case).replace(" ", "-")
    if not (own / "run" / "verdicts.json").is_file():
        shutil.rmtree(own, ignore_errors=True)
        own.mkdir(parents=True, exist_ok=True)
        surroundings = "\n".join(
            line for line in SEAS[sea] if not (name in NO_WIND and line is _WIND)
        )
        (own / "trial.toml").write_text(
            TRIAL.format(
                vehicle=name, program=(programs / f"ardu{vehicle.firmware}").resolve(),
                step=vehicle.step, stop=vehicle.stop, sea=surroundings,
                fault=FAULTS[fault].format(
                    at=vehicle.fault_at, gnss=vehicle.gnss, compass=vehicle.compass,
                    thruster=vehicle.thruster, loss=vehicle.loss,
                ),
            ),
            "utf-8",
        )  # fmt: skip
        command = [SEATRIAL, "run", own / "trial.toml", "--engine", "native", "--out", own / "run"]
        quoted = subprocess.list2cmdline(list(map(str, command)))
        done = subprocess.run(alone(quoted), cwd=ROOT, capture_output=True, text=True, timeout=900)
        if done.returncode not in (0, 1):
            raise RuntimeError(f"{'/'.join(case)}: {done.stderr[-2000:]}")
    return load_run(own / "run")


def found(run: Run, name: str) -> str:
    """Return how a case ended, in a few words."""
    vehicle = VEHICLES[name]
    station = "mission.station."
    passed, left = (int(run.signals[f"marks.{port}"][-1]) for port in ("passed", "left"))
    error = float(run.signals["marks.error"].max())
    failed = run.signals[f"{station}failsafe"] > 0
    words = [f"back at {run.time[-1]:.0f} s" if not left else f"{passed} of {passed + left} marks"]
    if failed.any():
        after = float(run.time[np.argmax(failed)]) - vehicle.fault_at
        words.append(f"failsafe {after:+.0f} s")
    if left:
        mode = int(run.signals[f"{station}mode"][-1])
        armed = run.signals[f"{station}armed"][-1] > 0
        words.append(
            MODES[vehicle.firmware].get(mode, f"mode {mode}") + ("" if armed else ", disarmed")
        )
    if error >= 1.0:
        words.append(f"estimate off by {error:.0f} m" if math.isfinite(error) else "no estimate")
    return "; ".join(words)


def table(results: dict[tuple[str, str, str], str]) -> str:
    """Return the results as a table: a row for each vehicle and fault, a column for each sea."""
    lines = [
        f"| vehicle | fault | {' | '.join(SEAS)} |",
        f"| {'--- | ' * (2 + len(SEAS))}".rstrip(),
    ]
    for name, fault in product(VEHICLES, FAULTS):
        cells = [results.get((name, sea, fault), "") for sea in SEAS]
        if any(cells):
            lines.append(f"| `{name}` | {fault} | {' | '.join(cells)} |")
    return "\n".join(lines)


def times(runs: dict[tuple[str, str, str], Run]) -> str:
    """Return the times of the squares in calm water as a table."""
    lines = ["| vehicle | corners (north, east, depth; m) | back after, s |", "| --- | --- | --- |"]
    for name in VEHICLES:
        square = load_vehicle(name).parameter_set("square", None).values
        last = 3 if VEHICLES[name].firmware == "sub" else 2
        places = [entry.value for key, entry in square.items() if key.startswith("waypoint_")]
        corners = "; ".join(", ".join(f"{x:g}" for x in place[:last]) for place in places)  # type: ignore[index]
        run = runs[name, "calm", "none"]
        lines.append(f"| `{name}` | {corners} | {run.time[-1]:.0f} |")
    return "\n".join(lines)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--write", action="store_true")
    parser.add_argument("--only", default="")
    parser.add_argument("--folder", type=Path, default=Path("runs/firmware"))
    parser.add_argument("--at-once", type=int, default=os.cpu_count())
    given = parser.parse_args()
    programs = Path(os.environ.get("SEATRIAL_ARDUPILOT", ""))
    if not (programs / "ardurover").is_file() or not (programs / "ardusub").is_file():
        sys.exit("SEATRIAL_ARDUPILOT names no folder with ardurover and ardusub")
    if not can_be_alone():
        sys.exit("each run needs a network of its own: unshare and ip are not here, or may not")
    runs: dict[tuple[str, str, str], Run] = {}
    results: dict[tuple[str, str, str], str] = {}

    def one(case: tuple[str, str, str]) -> None:
        runs[case] = run(case, programs, given.folder)
        results[case] = found(runs[case], case[0])
        print(f"{len(results)} of {len(wanted)}  {' / '.join(case)}: {results[case]}", flush=True)

    wanted = cases(given.only)
    with ThreadPoolExecutor(given.at_once) as pool:
        list(pool.map(one, wanted))
    print(table(results))
    if given.write:
        write_measured("kits/ardupilot/autopilots.md", table(results), "firmware")
        write_measured("kits/ardupilot/autopilots.md", times(runs), "times")


if __name__ == "__main__":
    main()
