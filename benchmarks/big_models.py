"""Cost of FMUs with very many variables: ``python -m benchmarks.big_models``.

Writes FMUs of FMI 2.0 and 3.0 with N variables, one in ten a parameter, an input and an output
each, the others local; describes, checks and runs each in processes of their own, and shows
processor time, s, and peak memory, MB, of those, for each N.
"""

from __future__ import annotations

import argparse
import os
import platform
import subprocess
import sys
import tempfile
import zipfile
from collections.abc import Iterator, Sequence
from pathlib import Path
from xml.sax.saxutils import quoteattr

import fmpy

from .pages import write_measured

SIZES = (10_000, 200_000)
CAUSALITIES = ("parameter", "input", *["local"] * 7, "output")
RIG = """\
step = "10 ms"
[components]
first = { fmu = "big.fmu" }
"""
TRIAL = """\
rig = "rig.toml"
stop = "0.2 s"
"""
COMMANDS = {
    "seatrial fmu describe": ("fmu", "describe", "big.fmu"),
    "seatrial fmu check": ("fmu", "check", "big.fmu"),
    "seatrial describe, a rig of one": ("describe", "rig.toml"),
    "a trial of 20 steps": ("run", "trial.toml", "--out", "run"),
}
_CHILD = "import sys; from seatrial.cli import main; main()"
_HEADERS = Path(fmpy.__file__).parent / "c-code"


def description(version: int, count: int) -> str:
    """Return a model description of FMI 2.0 or 3.0 with ``count`` variables."""
    lines = ['<?xml version="1.0" encoding="UTF-8"?>']
    token = "guid" if version == 2 else "instantiationToken"
    lines += [
        f'<fmiModelDescription fmiVersion="{version}.0" modelName="big" {token}="big">',
        '<CoSimulation modelIdentifier="big" canHandleVariableCommunicationStepSize="true"/>',
        "<ModelVariables>",
    ]
    outputs = []
    for number in range(count):
        causality = CAUSALITIES[number % len(CAUSALITIES)]
        if version == 3 and number == CAUSALITIES.index("local"):  # FMI 3 needs one, the time
            causality = "independent"
        fixed = causality == "parameter"
        start = ' start="0"' if causality in ("parameter", "input") else ""
        attributes = (
            f"name={quoteattr(f'unit{number // 100}.part{number // 10 % 10}.signal{number % 10}')} "
            f'valueReference="{number}" causality="{causality}" '
            f'variability="{"fixed" if fixed else "continuous"}"'
            f' description="Signal {number}"'
        )
        if version == 2:
            lines.append(f"<ScalarVariable {attributes}><Real{start}/></ScalarVariable>")
        else:
            lines.append(f"<Float64 {attributes}{start}/>")
        if causality == "output":
            outputs.append(number)
    lines += ["</ModelVariables>", "<ModelStructure>"]
    if version == 2:
        unknowns = "".join(f'<Unknown index="{n + 1}" dependencies=""/>' for n in outputs)
        lines += [
            f"<Outputs>{unknowns}</Outputs>",
            f"<InitialUnknowns>{unknowns}</InitialUnknowns>",
        ]
    else:
        lines += [f'<Output valueReference="{n}" dependencies=""/>' for n in outputs]
        lines += [f'<InitialUnknown valueReference="{n}" dependencies=""/>' for n in outputs]
    lines += ["</ModelStructure>", "</fmiModelDescription>"]
    return "\n".join(lines)


def write_fmu(path: Path, version: int, count: int) -> None:
    """Write an FMU with ``count`` variables, compiled with FMPy's headers."""
    library = path.with_suffix(".so")
    source = Path(__file__).parent / "native" / "big.c"
    flags = ["-shared", "-fPIC", "-O1", "-w", f"-DFMI={version}", f"-DSIZE={count}"]
    subprocess.run(["cc", *flags, f"-I{_HEADERS}", source, "-o", library], check=True)
    system = fmpy.platform if version == 2 else fmpy.platform_tuple
    with zipfile.ZipFile(path, "w", zipfile.ZIP_DEFLATED) as archive:
        archive.writestr("modelDescription.xml", description(version, count))
        archive.write(library, f"binaries/{system}/big.so")


def cost(arguments: tuple[str, ...], folder: Path, cache: Path) -> tuple[float, float]:
    """Run a command of seatrial; return its processor time, s, and peak memory, MB."""
    command = [sys.executable, "-c", _CHILD, *arguments]
    environment = {**os.environ, "SEATRIAL_CACHE": str(cache)}
    with open(folder / "said.txt", "w", encoding="utf-8") as said:
        process = subprocess.Popen(command, cwd=folder, env=environment, stdout=said, stderr=said)
        _, status, used = os.wait4(process.pid, 0)
    if status:
        raise SystemExit(f"{' '.join(arguments)}: {(folder / 'said.txt').read_text('utf-8')}")
    return used.ru_utime + used.ru_stime, used.ru_maxrss / 1000


def measured(version: int, count: int) -> dict[str, tuple[float, float]]:
    """Return processor time, s, and peak memory, MB, of each command with one FMU."""
    with tempfile.TemporaryDirectory(prefix="seatrial-") as name:
        folder = Path(name)
        write_fmu(folder / "big.fmu", version, count)
        (folder / "rig.toml").write_text(RIG, "utf-8")
        (folder / "trial.toml").write_text(TRIAL, "utf-8")
        return {what: cost(command, folder, folder / "cache") for what, command in COMMANDS.items()}


def rows(version: int, sizes: Sequence[int]) -> Iterator[str]:
    """Yield the rows of the table: a command each, its costs by size, and their ratio."""
    costs = [measured(version, count) for count in sizes]
    for what in COMMANDS:
        own = [one[what] for one in costs]
        cells = [f"{time:.1f} | {memory:.0f}" for time, memory in own]
        ratios = [f"{last / first:.1f}" for first, last in zip(own[0], own[-1], strict=True)]
        yield f"| {version}.0 | {what} | {' | '.join([*cells, *ratios])} |"


def main() -> None:
    parser = argparse.ArgumentParser(description="FMUs with very many variables")
    parser.add_argument("--sizes", type=int, nargs="+", default=SIZES)
    parser.add_argument(
        "--write", action="store_true", help="put the table into docs/performance.md"
    )
    arguments = parser.parse_args()
    heads = [f"{size:,}: time, s | memory, MB" for size in arguments.sizes]
    head = [
        f"Python {platform.python_version()}, one run each.\n",
        f"| FMI | command | {' | '.join(heads)} | ratio of times | of memories |",
        "| --- " * (2 * len(heads) + 4) + "|",
    ]
    table = [row for version in (2, 3) for row in rows(version, arguments.sizes)]
    text = "\n".join([*head, *table])
    print(text)
    if arguments.write:
        write_measured("performance.md", text, "measured of big models")


if __name__ == "__main__":
    main()
