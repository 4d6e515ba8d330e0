"""The Hydrone's closed loop beside real time, by carrier: ``python -m benchmarks.carriers``.

Nine components of the rig `landing` at 10 ms, without recording: in process, as Python FMUs, as
native FMUs under the master in Python and under the compiled one, and as one FMU in FMPy, which
takes steps of 10 ms or of 1 s. Each runs in a process of its
own, in turn, for some rounds; processor time of the steps without set-up. The start, with
assembly and initialisation, and peak memory are shown too. At last a campaign: the processor time
of whole trials with their pages. ``--write`` puts the table into docs/performance.md.
"""

from __future__ import annotations

import argparse
import json
import os
import platform
import resource
import statistics
import subprocess
import sys
import tempfile
from pathlib import Path
from time import process_time
from typing import Any

from seatrial.sim import master as master_module
from seatrial.sim.master import Master
from seatrial.system.assembling.assembly import assemble
from seatrial.system.flattening import load_rig
from seatrial.system.rig import Rig
from seatrial.system.system import System

from .history import noted
from .pages import peak_memory, write_measured

DIRECT, FMUS = "Python, in process", "Python FMUs"
NATIVE, COMPILED = "native FMUs, master in Python", "native FMUs, compiled master"
BOX, LONG = "one FMU in FMPy, steps of 10 ms", "one FMU in FMPy, steps of 1 s"
CARRIERS = {DIRECT: 1500, FMUS: 1500, NATIVE: 6000, COMPILED: 60_000, BOX: 60_000, LONG: 60_000}
"""Steps that are measured."""
WARM = 200
HERE = Path(__file__).parent
CAMPAIGN = "hydrone-open-pads"


def assembled(carrier: str, rig: Rig) -> System:
    """Return a rig with all components on one carrier."""
    system = assemble(rig, "fmu" if carrier == FMUS else "direct")
    if carrier in (NATIVE, COMPILED):
        from seatrial.fmi.components.source import find_source
        from seatrial.fmi.loading.load import load_fmu, open_instance
        from seatrial_kits.native.cached import native_fmu

        for name, part in system.parts.items():
            source = find_source(part.fmu, Path())
            assert not isinstance(source, Path)
            given = {variable: given.value for variable, given in part.given.items()}
            part.instance = open_instance(load_fmu(native_fmu(source, given)), name)
    return system


def built(folder: Path) -> Path:
    """Return the rig as one FMU."""
    from seatrial.fmi.compiler import HERE as PLATFORM
    from seatrial.fmi.compiler import library_here
    from seatrial_kits.interchange.rig_fmu.native import build_native_rig
    from seatrial_kits.native.engine import carry_natively

    system = assemble(load_rig("landing"), "native")
    carry_natively(system)
    return build_native_rig(system, folder / "landing.fmu", (PLATFORM,), library_here)


def boxed(path: Path, each: int, steps: int) -> dict[str, Any]:
    """Return the same as `one` of an FMU of the rig, by ``each`` steps of 10 ms at once."""
    from fmpy import extract, read_model_description
    from fmpy.fmi2 import FMU2Slave

    begun = process_time()
    description = read_model_description(str(path), validate=False)
    with tempfile.TemporaryDirectory(prefix="seatrial-") as folder:
        fmu = FMU2Slave(
            guid=description.guid, unzipDirectory=extract(str(path), folder),
            modelIdentifier=description.coSimulation.modelIdentifier, instanceName="box",
        )  # fmt: skip
        fmu.instantiate()
    fmu.setupExperiment(startTime=0.0)
    fmu.enterInitializationMode()
    fmu.exitInitializationMode()
    started, h = process_time() - begun, 0.01 * each
    for k in range(WARM):
        fmu.doStep(k * h, h)
    begun = process_time()
    for k in range(WARM, WARM + steps // each):
        fmu.doStep(k * h, h)
    return {
        "us": (process_time() - begun) / steps * 1e6,
        "start": started,
        "memory": peak_memory(),
    }


def one(carrier: str, box: Path) -> dict[str, Any]:
    """Return what the steps of one carrier take, us; the start, s; memory, MB."""
    if carrier in (BOX, LONG):
        return boxed(box, 1 if carrier == BOX else 100, CARRIERS[carrier])
    if carrier == NATIVE:
        master_module.is_compiled = lambda _system: False
    begun, system = process_time(), assembled(carrier, load_rig("landing"))
    master = Master(system)
    master.initialise()
    started = process_time() - begun
    for steps in (WARM, CARRIERS[carrier]):
        begun, left = process_time(), steps
        while left:
            left -= master.advance(left)
    taken = (process_time() - begun) / CARRIERS[carrier] * 1e6
    return {"us": taken, "start": started, "memory": peak_memory()}


def run(carrier: str, box: Path) -> dict[str, Any]:
    """Run one carrier in a process of its own."""
    done = subprocess.run(
        [sys.executable, "-m", "benchmarks.carriers", "--one", carrier, "--box", str(box)],
        capture_output=True, text=True, check=True, cwd=HERE.parent,
    )  # fmt: skip
    answer: dict[str, Any] = json.loads(done.stdout.splitlines()[-1])
    return answer


def campaign() -> tuple[float, int]:
    """Return the processor time of a case of a campaign, with its page, s; and how many ran."""
    with tempfile.TemporaryDirectory(prefix="seatrial-") as folder:
        before = resource.getrusage(resource.RUSAGE_CHILDREN)
        command = "from seatrial.cli import main; main()"
        subprocess.run(
            [sys.executable, "-c", command, "run", CAMPAIGN, "--engine", "direct", "--jobs", "1",
             "--out", f"{folder}/out"],
            capture_output=True, check=False, cwd=folder,
        )  # fmt: skip
        after = resource.getrusage(resource.RUSAGE_CHILDREN)
        cases = len(list(Path(folder, "out").glob("*/manifest.json")))
    taken = after.ru_utime - before.ru_utime + after.ru_stime - before.ru_stime
    return taken / max(1, cases), cases


def table(found: dict[str, list[dict[str, Any]]]) -> str:
    """Return the table in Markdown."""
    rows = [
        "| carrier | µs per step | times real time | ratio to in process | start, s | memory, MB |",
        "| --- | --- | --- | --- | --- | --- |",
    ]
    for carrier, rounds in found.items():
        us = statistics.median(each["us"] for each in rounds)
        ratios = [a["us"] / b["us"] for a, b in zip(rounds, found[DIRECT], strict=True)]
        ratio = f"{statistics.median(ratios):.3g} ({min(ratios):.3g} to {max(ratios):.3g})"
        times = sorted(1e4 / each["us"] for each in rounds)
        real = f"{statistics.median(times):.0f} ({times[0]:.0f} to {times[-1]:.0f})"
        start = statistics.median(each["start"] for each in rounds)
        memory = rounds[0]["memory"]
        rows.append(f"| {carrier} | {us:.3g} | {real} | {ratio} | {start:.2f} | {memory:.0f} |")
    return "\n".join(rows)


def main() -> None:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawTextHelpFormatter
    )
    parser.add_argument("--rounds", type=int, default=5)
    parser.add_argument("--one", choices=CARRIERS, help=argparse.SUPPRESS)
    parser.add_argument("--box", type=Path, help=argparse.SUPPRESS)
    parser.add_argument(
        "--write", action="store_true", help="put the table into docs/performance.md"
    )
    options = parser.parse_args()
    if options.one:
        print(json.dumps(one(options.one, options.box)), flush=True)
        os._exit(0)  # pythonfmu's library may crash in its exit handlers
    found: dict[str, list[dict[str, Any]]] = {carrier: [] for carrier in CARRIERS}
    with tempfile.TemporaryDirectory(prefix="seatrial-") as folder:
        box = built(Path(folder))
        size = box.stat().st_size / 1000
        for number in range(-1, options.rounds):  # the first fills the caches
            for carrier, rounds in found.items():
                answer = run(carrier, box)
                if number >= 0:
                    rounds.append(answer)
    per_case, cases = campaign()
    text = (
        f"Python {platform.python_version()}, {options.rounds} rounds.\n\n{table(found)}\n\n"
        f"The one FMU of the rig has {size:.0f} kB.\n\n"
        f"The campaign `{CAMPAIGN}`, in process: {per_case:.2f} s of processor time for each of "
        f"its {cases} cases of 20 s, with start, record of every step, criteria and page: "
        f"{60 / per_case:.0f} cases a minute on one core."
    )
    print(text)
    if options.write:
        middle = {c: statistics.median(each["us"] for each in r) for c, r in found.items()}
        ratios = {f"{c} to in process": us / middle[DIRECT] for c, us in middle.items()}
        write_measured(
            "performance.md", f"{text}\n\n{noted('carriers', ratios)}", "measured of the carriers"
        )


if __name__ == "__main__":
    main()
