"""Our master beside other people's, on one rig, in one run: ``python -m benchmarks.compare``.

Each engine runs in a process of its own, in turn, for some rounds; what is compared is the
processor time of the steps without set-up. FMPy's simulate_ssp does not separate them: for it a
run of one step is taken off. Ratios are those of one round; the median over the rounds and their
range are shown. ``--write`` puts the tables and the plot into docs/performance.md.
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

from seatrial.system.assembling.assembly import assemble
from seatrial.system.flattening import load_rig
from seatrial_kits.interchange.ssp.describing import Experiment
from seatrial_kits.interchange.ssp.writing import write_ssp

from .history import noted
from .pages import write_measured

HERE = Path(__file__).parent
US = "seatrial"
AGAIN, IN_PYTHON = "seatrial, feed-through read again", "seatrial, master in Python"
CONTAINER, ARRAYS, LISTS = "FMUContainer", "FMPy, a loop with arrays", "FMPy, a loop of list calls"
SIMULATE, LIBCOSIM, ECOS = "FMPy simulate_ssp", "libcosimpy", "ecospy"
OF_PYTHON_FMUS = (US, AGAIN, LISTS, SIMULATE, LIBCOSIM, ECOS)
OF_CHAINS = (US, IN_PYTHON, CONTAINER, ECOS, LIBCOSIM, ARRAYS, LISTS, SIMULATE)
MASSES = (2, 20, 200, 1000)
MOST = {SIMULATE: 20, LISTS: 200}
"""FMUs beyond which an engine would take many minutes to say no more."""
PLOT = Path(__file__).parents[1] / "docs" / "images" / "masters.svg"


@dataclass(frozen=True)
class Case:
    """A package and what is looked at in it."""

    title: str
    ssp: Path
    components: int
    steps: int
    step: float
    watch: list[str]
    engines: tuple[str, ...]


@dataclass
class Measured:
    """Processor times per component and step, us, one per round; peak memory, MB."""

    total: list[float]
    memory: float
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


def hydrone(folder: Path, steps: int) -> Case:
    """Write the package of the Hydrone's loop, of Python FMUs."""
    system = assemble(load_rig("landing"))
    write_ssp(system, Experiment("hydrone", 0.0, 1e3), folder / "hydrone.ssp", in_one=True)
    return Case(
        f"Python FMUs: the Hydrone's closed loop, {len(system.parts)} FMUs, "
        f"{len(system.connections)} connections",
        folder / "hydrone.ssp", len(system.parts), steps, 0.01,
        ["vehicle_hull.attitude.phi", "vehicle_hull.position.x"], OF_PYTHON_FMUS,
    )  # fmt: skip


def chain(folder: Path, masses: int, steps: int) -> Case:
    """Write the package of a chain of masses in C, and the container that is made of it."""
    folder.mkdir()
    native_fmu(folder)
    names = [f"m{i}" for i in range(masses)]
    lines = ['step = "10 ms"', "[components]", *(f'{n} = {{ fmu = "mass.fmu" }}' for n in names)]
    lines.append("[connections]")
    for i, name in enumerate(names):
        ends = [(names[i + 1], "left")] if i + 1 < masses else []
        ends += [(names[i - 1], "right")] if i else []
        for signal in "xv":
            targets = ", ".join(f'"{other}.{signal}_{side}"' for other, side in ends)
            lines.append(f'"{name}.{signal}" = [{targets}]')
    (folder / "chain.toml").write_text("\n".join(lines) + "\n")
    system = assemble(load_rig(str(folder / "chain.toml")))
    write_ssp(system, Experiment("chain", 0.0, 1e3), folder / "chain.ssp")
    made = f"import sys; sys.path.insert(0, {str(HERE.parent)!r}); " + _MAKE_CONTAINER
    subprocess.run([sys.executable, "-c", made, str(folder)], capture_output=True)
    return Case(
        f"a chain of {masses} masses in C, {len(system.connections)} connections",
        folder / "chain.ssp", masses, max(200, 100 * (steps // masses)), 0.01,
        [f"m{masses // 2}.x"], OF_CHAINS,
    )  # fmt: skip


_MAKE_CONTAINER = (
    "from pathlib import Path; from fmu_manipulation_toolbox.assembly import Assembly; "
    "Assembly('chain.ssp', default_step_size=0.01, fmu_directory=Path(sys.argv[1])).make_fmu()"
)


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
    found = {engine: Measured([], 0.0, {}) for engine in case.engines}
    for number in range(rounds):
        for engine, measured in found.items():
            if case.components > MOST.get(engine, case.components):
                measured.error = "left out: it would take many minutes"
            if measured.error:
                continue
            print(f"{case.title}: round {number + 1}, {engine} ...", file=sys.stderr)
            try:
                answer = run(engine, case, case.steps)
                taken = answer["taken"]
                if engine == SIMULATE:
                    taken -= run(engine, case, 1)["taken"]
            except RuntimeError as error:
                measured.error = str(error)
                continue
            per = 1e6 / (case.steps * case.components)
            measured.total.append(taken * per)
            measured.memory = answer["memory"]
            measured.values = answer["values"]
    return found


def table(case: Case, found: dict[str, Measured]) -> str:
    """Return the table of a case in Markdown."""
    rows = [
        f"### {case.title}",
        "",
        "| engine | µs per FMU and step | ratio to seatrial | peak memory, MB | final values |",
        "| --- | --- | --- | --- | --- |",
    ]
    base = found[US]
    if base.error:
        raise SystemExit(f"{case.title}: seatrial itself: {base.error}")
    for engine, measured in found.items():
        if measured.error:
            rows.append(f"| {engine} | does not run it: {measured.error} | | | |")
            continue
        ratios = ratios_of(measured, base)
        ratio = f"{statistics.median(ratios):.2f} ({min(ratios):.2f} to {max(ratios):.2f})"
        total = f"{statistics.median(measured.total):.3g}"
        values = ", ".join(f"{value:.12g}" for value in measured.values.values())
        rows.append(f"| {engine} | {total} | {ratio} | {measured.memory:.0f} | {values} |")
    return "\n".join(rows)


def ratios_of(measured: Measured, base: Measured) -> list[float]:
    """Return the ratios of each round."""
    return [a / b for a, b in zip(measured.total, base.total, strict=True)]


def plot(measured: dict[int, dict[str, Measured]]) -> None:
    """Draw the times over the number of FMUs."""
    import matplotlib

    matplotlib.use("svg")
    matplotlib.rcParams["svg.hashsalt"] = "seatrial"
    from matplotlib import pyplot

    figure, axes = pyplot.subplots(figsize=(7.0, 4.2), layout="constrained")
    for engine in OF_CHAINS:
        there = {n: found[engine].total for n, found in measured.items() if found[engine].total}
        middle = [statistics.median(times) for times in there.values()]
        axes.loglog([*there], middle, "o-", label=engine, lw=2.5 if engine == US else 1.0)
    axes.set(xlabel="FMUs", ylabel="processor time per FMU and step, µs")
    axes.grid(alpha=0.3, which="both")
    figure.legend(loc="outside right center", fontsize=8)
    figure.savefig(PLOT, metadata={"Date": None})


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
    chains, tables, ratios = {}, [], {}
    with tempfile.TemporaryDirectory() as folder:
        for masses in MASSES:
            case = chain(Path(folder, str(masses)), masses, options.steps)
            chains[masses] = found = measure(case, options.rounds)
            tables.append(table(case, found))
            for engine, measured in found.items():
                if engine != US and measured.total:
                    ratio = statistics.median(ratios_of(found[US], measured))
                    ratios[f"{masses} FMUs, seatrial to {engine}"] = ratio
        case = hydrone(Path(folder), options.steps)
        tables.append(table(case, measure(case, options.rounds)))
    text = "\n\n".join([f"Python {platform.python_version()}, {options.rounds} rounds.", *tables])
    print(text)
    if options.write:
        text = f"{text}\n\n{noted('masters', ratios)}"
        plot(chains)
        write_measured("performance.md", text)


if __name__ == "__main__":
    main()
