"""Our master beside other people's, on one rig, in one run: ``python -m benchmarks.compare``.

Each engine runs in a process of its own, in turn, for some rounds; what is compared is the time
of the steps without set-up. FMPy's simulate_ssp does not separate them: for it a run of one
step is taken off. Ratios are those of one round; the median over the rounds and their range are
shown. ``--write`` puts the tables into docs/performance.md.
"""

from __future__ import annotations

import argparse
import json
import os
import platform
import statistics
import subprocess
import sys
import tempfile
import zipfile
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import fmpy

from seatrial.cosim.assembly import assemble
from seatrial.cosim.flattening import load_rig
from seatrial.cosim.ssp.describing import Experiment
from seatrial.cosim.ssp.writing import write_ssp

from .pages import write_measured

HERE = Path(__file__).parent
US = "seatrial"
ENGINES = (
    US,
    "seatrial, feed-through read again",
    "FMPy, a loop of list calls",
    "FMPy simulate_ssp",
    "libcosimpy",
    "ecospy",
)
MASSES = 5


@dataclass(frozen=True)
class Case:
    """A package and what is looked at in it."""

    title: str
    ssp: Path
    components: int
    steps: int
    step: float
    watch: list[str]


@dataclass
class Measured:
    """Times per component and step, us, one per round."""

    total: list[float]
    own: list[float]
    values: dict[str, float]
    error: str = ""


def native_fmu(folder: Path) -> Path:
    """Compile ``native/mass.c`` into an FMU."""
    library = folder / "mass.so"
    headers = Path(fmpy.__file__).parent / "c-code"
    subprocess.run(
        [
            "cc",
            "-O2",
            "-shared",
            "-fPIC",
            f"-I{headers}",
            "-o",
            library,
            HERE / "native" / "mass.c",
        ],
        check=True,
    )
    path = folder / "mass.fmu"
    with zipfile.ZipFile(path, "w") as archive:
        archive.write(HERE / "native" / "modelDescription.xml", "modelDescription.xml")
        archive.write(library, "binaries/linux64/mass.so")
    return path


def cases(folder: Path, steps: int) -> list[Case]:
    """Write the packages: the Hydrone's loop of Python FMUs, and a chain of native ones."""
    hydrone = assemble(load_rig("landing"))
    experiment = Experiment("hydrone", 0.0, 1e3)
    write_ssp(hydrone, experiment, folder / "hydrone.ssp", in_one=True)
    native_fmu(folder)
    names = [f"m{i}" for i in range(MASSES)]
    lines = ['step = "10 ms"', "[components]", *(f'{n} = {{ fmu = "mass.fmu" }}' for n in names)]
    lines.append("[connections]")
    for i, name in enumerate(names):
        ends = [(names[i + 1], "left")] if i + 1 < MASSES else []
        ends += [(names[i - 1], "right")] if i else []
        for signal in "xv":
            targets = ", ".join(f'"{other}.{signal}_{side}"' for other, side in ends)
            lines.append(f'"{name}.{signal}" = [{targets}]')
    (folder / "chain.toml").write_text("\n".join(lines) + "\n")
    chain = assemble(load_rig(str(folder / "chain.toml")))
    write_ssp(chain, Experiment("chain", 0.0, 1e3), folder / "chain.ssp")
    return [
        Case(
            f"Python FMUs: the Hydrone's closed loop, {len(hydrone.parts)} FMUs, "
            f"{len(hydrone.connections)} connections",
            folder / "hydrone.ssp", len(hydrone.parts), steps, 0.01,
            ["vehicle_hull.attitude.phi", "vehicle_hull.position.x"],
        ),
        Case(
            f"Native FMUs: a chain of {MASSES} masses, {len(chain.connections)} connections",
            folder / "chain.ssp", MASSES, 5 * steps, 0.01, ["m2.x"],
        ),
    ]  # fmt: skip


def run(engine: str, case: Case, steps: int) -> dict[str, Any]:
    """Run one engine in a process of its own."""
    job = json.dumps([engine, str(case.ssp), steps, case.step, case.watch])
    done = subprocess.run(
        [sys.executable, "-m", "benchmarks.engines", job],
        capture_output=True, text=True, check=False, cwd=HERE.parent,
        env={**os.environ, "TMPDIR": str(case.ssp.parent)},  # the tools leave what they unpack
    )  # fmt: skip
    if done.returncode != 0:
        raise RuntimeError(done.stderr.strip().splitlines()[-1] if done.stderr.strip() else "died")
    answer: dict[str, Any] = json.loads(done.stdout.splitlines()[-1])
    return answer


def measure(case: Case, rounds: int) -> dict[str, Measured]:
    """Return what every engine needs per component and step."""
    found = {engine: Measured([], [], {}) for engine in ENGINES}
    for number in range(rounds):
        for engine, measured in found.items():
            if measured.error:
                continue
            print(f"{case.title}: round {number + 1}, {engine} ...", file=sys.stderr)
            try:
                answer = run(engine, case, case.steps)
                wall = answer["wall"]
                if engine == "FMPy simulate_ssp":
                    wall -= run(engine, case, 1)["wall"]
            except RuntimeError as error:
                measured.error = str(error)
                continue
            per = 1e6 / (case.steps * case.components)
            measured.total.append(wall * per)
            if answer["own"] is not None:
                measured.own.append(answer["own"] * per)
            measured.values = answer["values"]
    return found


def table(case: Case, found: dict[str, Measured]) -> str:
    """Return the table of a case in Markdown."""
    rows = [
        f"### {case.title}",
        "",
        "| engine | µs per FMU and step | ratio to seatrial | outside the FMUs' steps, µs "
        "| final values |",
        "| --- | --- | --- | --- | --- |",
    ]
    base = found[US]
    if base.error:
        raise SystemExit(f"{case.title}: seatrial itself: {base.error}")
    for engine, measured in found.items():
        if measured.error:
            rows.append(f"| {engine} | does not run it: {measured.error} | | | |")
            continue
        ratios = [a / b for a, b in zip(measured.total, base.total, strict=True)]
        ratio = f"{statistics.median(ratios):.2f} ({min(ratios):.2f} to {max(ratios):.2f})"
        outside = [a - b for a, b in zip(measured.total, measured.own, strict=False)]
        overhead = f"{statistics.median(outside):.1f}" if outside else ""
        total = f"{statistics.median(measured.total):.1f}"
        values = ", ".join(f"{value:.12g}" for value in measured.values.values())
        rows.append(f"| {engine} | {total} | {ratio} | {overhead} | {values} |")
    return "\n".join(rows)


def main() -> None:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawTextHelpFormatter
    )
    parser.add_argument("--rounds", type=int, default=5)
    parser.add_argument("--steps", type=int, default=4000)
    parser.add_argument(
        "--write", action="store_true", help="put the tables into docs/performance.md"
    )
    options = parser.parse_args()
    with tempfile.TemporaryDirectory() as folder:
        tables = [table(c, measure(c, options.rounds)) for c in cases(Path(folder), options.steps)]
    text = "\n\n".join([f"Python {platform.python_version()}, {options.rounds} rounds.", *tables])
    print(text)
    if options.write:
        write_measured("performance.md", text)


if __name__ == "__main__":
    main()
