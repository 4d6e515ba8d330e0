"""The Otter beside PythonVehicleSimulator's: ``python -m benchmarks.otter SIMULATOR``.

SIMULATOR is a checkout of github.com/cybergalactic/PythonVehicleSimulator. Both run the same
vehicle with constant commands to its two propellers, at the simulator's 20 ms, without a record:
theirs calls `dynamics` and `attitudeEuler` as its `simulate` does (Euler's method), ours steps the
rig of hull, two propellers and their sum (two steps of Runge-Kutta's) by carrier. Each runs in a
process of its own, in turn, for some rounds. The speeds at the end show that both move alike: the
models differ, see the page of the vehicle. ``--write`` puts the table into
docs/performance.md.
"""

from __future__ import annotations

import argparse
import json
import os
import platform
import statistics
import subprocess
import sys
from pathlib import Path
from time import process_time
from typing import Any

import numpy as np

from seatrial.sim import master as master_module
from seatrial.sim.master import Master
from seatrial.system.files import Source
from seatrial.system.flattening import rig_of

from .carriers import COMPILED, DIRECT, NATIVE, assembled
from .history import noted
from .pages import write_measured

STEP, WARM = 0.02, 500
THEIRS = "PythonVehicleSimulator"
STEPS = {THEIRS: 10_000, DIRECT: 10_000, NATIVE: 20_000, COMPILED: 500_000}
AHEAD = 103.93086427398
"""Shaft speed at full command, rad/s."""
COMMANDS = (60.0, 50.0)
"""Shaft speeds of the port and the starboard propeller, rad/s."""
HERE = Path(__file__).parent

RIG: dict[str, Any] = {
    "title": "Otter, hull and propellers",
    "variant": "loaded",
    "step": "20 ms",
    "components": {
        "hull": {"fmu": "marine-craft", "parameters": "otter"},
        "port": {"fmu": "shaft-propeller", "parameters": "otter.propeller"},
        "starboard": {"fmu": "shaft-propeller", "parameters": "otter.propeller"},
        "propulsion": {"fmu": "propulsion", "parameters": "otter"},
    },
    "connections": {
        "port.thrust": "propulsion.thrust.t1",
        "starboard.thrust": "propulsion.thrust.t2",
        "propulsion.wrench": "hull.wrench",
    },
}


def ours(carrier: str) -> dict[str, float]:
    """Return what a step takes, us, and surge speed and yaw rate at the end."""
    if carrier == NATIVE:
        master_module.is_compiled = lambda _system: False
    system = assembled(carrier, rig_of(RIG, Source("otter", Path("otter"), ""), Path()))
    for name, command in zip(("port", "starboard"), COMMANDS, strict=True):
        system.set(f"{name}.command", command / AHEAD, "benchmark")
    master = Master(system)
    master.initialise()
    taken = 0.0
    for steps in (WARM, STEPS[carrier]):
        begun, left = process_time(), steps
        while left:
            left -= master.advance(left)
        taken = process_time() - begun
    speed, rate = map(float, master.values("hull", ["velocity.u", "rates.r"]))
    return {"us": taken / STEPS[carrier] * 1e6, "surge": speed, "yaw rate": rate}


def theirs(checkout: Path) -> dict[str, float]:
    """Return the same of the simulator."""
    sys.path.insert(0, str(checkout / "src"))
    from python_vehicle_simulator.lib.gnc import attitudeEuler  # type: ignore[import-not-found]
    from python_vehicle_simulator.vehicles import otter  # type: ignore[import-not-found]

    craft = otter()
    eta, nu, shafts = np.zeros(6), craft.nu, craft.u_actual
    command, taken = np.array(COMMANDS), 0.0
    for steps in (WARM, STEPS[THEIRS]):
        begun = process_time()
        for _ in range(steps):
            nu, shafts = craft.dynamics(eta, nu, shafts, command, STEP)
            eta = attitudeEuler(eta, nu, STEP)
        taken = process_time() - begun
    return {"us": taken / STEPS[THEIRS] * 1e6, "surge": float(nu[0]), "yaw rate": float(nu[5])}


def run(way: str, checkout: Path) -> dict[str, float]:
    """Run one way in a process of its own."""
    done = subprocess.run(
        [sys.executable, "-m", "benchmarks.otter", checkout, "--one", way],
        capture_output=True, text=True, check=True, cwd=HERE.parent,
    )  # fmt: skip
    answer: dict[str, float] = json.loads(done.stdout.splitlines()[-1])
    return answer


def table(found: dict[str, list[dict[str, float]]]) -> str:
    """Return the table in Markdown."""
    rows = [
        f"| Otter | µs per step | times real time | ratio to {THEIRS} | at the end |",
        "| --- " * 5 + "|",
    ]
    for way, rounds in found.items():
        us = statistics.median(each["us"] for each in rounds)
        ratios = [a["us"] / b["us"] for a, b in zip(rounds, found[THEIRS], strict=True)]
        ratio = f"{statistics.median(ratios):.3g} ({min(ratios):.2g} to {max(ratios):.2g})"
        end = f"{rounds[0]['surge']:.3f} m/s, {np.degrees(rounds[0]['yaw rate']):.2f} deg/s"
        rows.append(f"| {way} | {us:.3g} | {STEP / us * 1e6:.0f} | {ratio} | {end} |")
    return "\n".join(rows)


def main() -> None:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawTextHelpFormatter
    )
    parser.add_argument("simulator", type=Path, help="the checkout")
    parser.add_argument("--rounds", type=int, default=5)
    parser.add_argument("--one", choices=STEPS, help=argparse.SUPPRESS)
    parser.add_argument(
        "--write", action="store_true", help="put the table into docs/performance.md"
    )
    options = parser.parse_args()
    if options.one:
        found = theirs(options.simulator) if options.one == THEIRS else ours(options.one)
        print(json.dumps(found), flush=True)
        os._exit(0)  # pythonfmu's library may crash in its exit handlers
    checkout = options.simulator.resolve()
    all_found: dict[str, list[dict[str, float]]] = {way: [] for way in STEPS}
    for number in range(-1, options.rounds):  # the first fills the caches
        for way, rounds in all_found.items():
            answer = run(way, checkout)
            if number >= 0:
                rounds.append(answer)
    text = f"Python {platform.python_version()}, {options.rounds} rounds.\n\n{table(all_found)}"
    print(text)
    if options.write:
        middle = {w: statistics.median(each["us"] for each in r) for w, r in all_found.items()}
        ratios = {f"{way} to {THEIRS}": us / middle[THEIRS] for way, us in middle.items()}
        write_measured(
            "performance.md", f"{text}\n\n{noted('otter', ratios)}", "measured of the Otter"
        )


if __name__ == "__main__":
    main()
