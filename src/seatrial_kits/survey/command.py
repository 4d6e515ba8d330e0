"""``seatrial fmu survey``: the FMUs of a folder, which of them load, run and agree, and why not."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator
from pathlib import Path
from typing import Annotated

import typer
from rich.markup import escape

from seatrial.cli.answer import answer
from seatrial.cli.show import console
from seatrial.errors import InputError

from .surveying import Surveyed, fmus_in, survey

_COLOURS = {"agrees": "green"} | dict.fromkeys(
    ("runs, FMPy fails", "runs, no outputs", "not run"), "yellow"
)
"""Of those that let the status be 0; all others are red."""
_LONGEST = 400
"""Characters of a problem in a line; --json has all of it."""


def survey_folder(
    folder: Annotated[
        Path, typer.Argument(metavar="FOLDER", help="With FMUs, in folders inside too.")
    ],
    timeout: Annotated[
        float, typer.Option(metavar="SECONDS", help="Longest wall time of a run of an FMU.")
    ] = 60.0,
) -> None:
    """Run every FMU of a folder in all ways that there are, and by FMPy, and compare the outputs.

    Each run is in a process of its own: an FMU that crashes is a line of the list. Status 1 if
    one does not load, fails, or differs.
    """
    if not timeout > 0.0:
        raise InputError(f"--timeout: more than 0 s is needed, found {timeout:g}")
    found = []
    for one in survey(fmus_in(folder), timeout):
        found.append(one)
        colour = _COLOURS.get(one.status, "red")
        name = escape(str(one.path.relative_to(folder)))
        console.print(f"[{colour}]{one.status}[/{colour}]  {name}", soft_wrap=True)
        for line in _lines(one):
            console.print(f"    {escape(line)}", soft_wrap=True)
    counts = Counter(one.status for one in found)
    each = ", ".join(f"{status}: {n}" for status, n in counts.items())
    console.print(f"{len(found)} FMUs; {each}", soft_wrap=True)
    answer.result["fmus"] = [_entry(one, folder) for one in found]
    if counts.keys() - _COLOURS.keys():
        raise typer.Exit(1)


def _lines(one: Surveyed) -> Iterator[str]:
    """Yield what is worth a line of an FMU, below its name."""
    if one.ways:
        line = f"FMI {one.kind}, {one.experiment}; {', '.join(one.ways)}"
        if one.differences and not one.differing:
            worst = max(one.differences.values(), key=lambda each: each.value)
            said = f"at most {worst.value:.1g} apart" if worst.value else "equal"
            line += f"; {one.outputs} {'output' if one.outputs == 1 else 'outputs'}, {said}"
        yield line
    if one.unfit:
        yield _shortened(one.unfit)
    for way, why in one.problems.items():
        yield f"{way}: {_shortened(why)}"
    for way, apart in one.differing.items():
        yield f"{way}: {apart}"


def _shortened(why: str) -> str:
    """Return the first line of a problem."""
    return why.partition("\n")[0][:_LONGEST]


def _entry(one: Surveyed, folder: Path) -> dict[str, object]:
    return {
        "fmu": str(one.path.relative_to(folder)),
        "kind": one.kind,
        "status": one.status,
        "experiment": "" if one.experiment is None else str(one.experiment),
        "outputs": one.outputs,
        "ways": list(one.ways),
        "unfit": one.unfit,
        "problems": dict(one.problems),
        "differences": {
            way: {"output": worst.output, "relative": worst.value, "time": worst.time}
            for way, worst in one.differences.items()
        },
    }
