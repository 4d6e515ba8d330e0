"""The estimate command: damping of a hull from its dimensions, or a whole vehicle file."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated, Any

import typer
from rich.box import SIMPLE
from rich.markup import escape
from rich.table import Table

from seatrial.cli.answer import answer
from seatrial.cli.show import console, print_notes, print_table
from seatrial.errors import InputError
from seatrial.files.whole_file import write_whole
from seatrial.model.readable import number

from .hull_file import estimate_damping
from .proposal.particulars import KINDS, option
from .proposal.propose import propose
from .proposal.value import Proposal
from .proposal.vehicle_text import vehicle_text


def _particular(said: str) -> Any:
    return typer.Option(help=said, show_default=False)


def estimate(
    hull: Annotated[
        str | None, typer.Argument(help="Dimensions of a hull: a name or a .toml file.")
    ] = None,
    kind: Annotated[str | None, typer.Option(help=f"A whole file of a {', '.join(KINDS)}.")] = None,
    length: Annotated[str | None, _particular("At the water line, or over all.")] = None,
    diameter: Annotated[str | None, _particular("Diameter of a torpedo.")] = None,
    beam: Annotated[str | None, _particular("Over all.")] = None,
    hull_beam: Annotated[
        str | None, _particular("Beam of one hull of two, or of the main hull of three.")
    ] = None,
    side_length: Annotated[str | None, _particular("Side hull of a trimaran.")] = None,
    side_beam: Annotated[str | None, _particular("Side hull of a trimaran.")] = None,
    spacing: Annotated[str | None, _particular("Outer hulls, centre to centre.")] = None,
    frontal_area: Annotated[str | None, _particular("Open rov, seen from ahead.")] = None,
    side_area: Annotated[str | None, _particular("Open rov, seen from abeam.")] = None,
    top_area: Annotated[str | None, _particular("Open rov, seen from above.")] = None,
    draught: Annotated[str | None, _particular("Draught of the main hull.")] = None,
    height: Annotated[str | None, _particular("Height of a rov, or from keel to deck.")] = None,
    cg_height: Annotated[str | None, _particular("Height of the CG above the keel.")] = None,
    mass: Annotated[str | None, _particular("Displacement.")] = None,
    speed: Annotated[str | None, _particular("Speed of drag and thrust.")] = None,
    density: Annotated[str | None, _particular("Density of the water.")] = None,
    out: Annotated[
        Path | None, typer.Option("--out", "-o", help="Vehicle file to write, not yet there.")
    ] = None,
) -> None:
    """Estimate the damping of a hull from its dimensions, or a vehicle file from particulars."""
    written = {
        "length": length, "diameter": diameter, "beam": beam, "hull_beam": hull_beam,
        "side_length": side_length, "side_beam": side_beam, "spacing": spacing,
        "frontal_area": frontal_area, "side_area": side_area, "top_area": top_area,
        "draught": draught, "height": height, "cg_height": cg_height, "mass": mass,
        "speed": speed, "density": density,
    }  # fmt: skip
    if hull is None and kind is None:
        raise InputError(f"a hull's file or --kind is needed; kinds are {', '.join(KINDS)}")
    if kind is not None:
        if hull is not None:
            raise InputError(f"{hull}: a hull's file, and --kind {kind}: one of them is needed")
        _propose(propose(kind, written), out)
        return
    if said := [option(name) for name, text in written.items() if text is not None]:
        raise InputError(f"{', '.join(said)}: particulars are for --kind, {hull} has its own")
    if out is not None:
        raise InputError(f"--out {out}: for --kind; the lines of {hull} are printed")
    assert hull is not None
    _damping(hull)


def _propose(found: Proposal, out: Path | None) -> None:
    text = vehicle_text(found)
    if out is not None and out.exists():
        raise InputError(f"{out}: exists already and is not replaced")
    answer.result = {
        "kind": found.kind,
        "notes": found.notes,
        "entries": [
            {"name": v.name, "value": v.value, "unit": v.unit, "source": v.source, "mark": v.mark,
             "measured_by": v.measured_by}
            for v in found.all_values()
        ],
        "file": text,
    }  # fmt: skip
    print_table(_table(found))
    print_notes(found.notes)
    if out is None:
        for line in text.splitlines():
            console.print(escape(line), soft_wrap=True)
        return
    out.parent.mkdir(parents=True, exist_ok=True)
    write_whole(out, text)
    console.print(f"wrote {escape(str(out))}", soft_wrap=True)


def _table(found: Proposal) -> Table:
    """Return the numbers with their formulas; texts are in the file alone."""
    table = Table(box=SIMPLE, padding=(0, 1, 0, 0), title=found.kind, title_justify="left")
    table.add_column("", no_wrap=True)
    table.add_column("value")
    table.add_column("formula and range")
    table.add_column("measured by", no_wrap=True)
    for v in found.all_values():
        if not isinstance(v.value, str):
            table.add_row(v.name, _shown(v.value, v.unit), escape(v.source), v.measured_by)
    return table


def _shown(value: float | tuple[float, ...], unit: str) -> str:
    """Return the value with its unit, without products of inertia: a proposal has none."""
    each = value[:3] if isinstance(value, tuple) else (value,)
    numbers = ", ".join(number(item + 0.0, 4) for item in each)
    return numbers if unit == "1" else f"{numbers} {unit}"


def _damping(hull: str) -> None:
    found = estimate_damping(hull)
    table = Table(box=SIMPLE, padding=(0, 1, 0, 0), title=escape(found.title), title_justify="left")
    table.add_column("")
    table.add_column("value", justify="right")
    table.add_column("unit")
    table.add_column("from")
    for each in found.derivatives:
        table.add_row(each.symbol, number(each.value + 0.0, 4), each.unit, each.equation)
    console.print(table)
    wetted, frontal = number(found.hull.wetted_area, 4), number(found.hull.frontal_area, 4)
    console.print(f"wetted area {wetted} m2, frontal area {frontal} m2")
    console.print("\nof the component marine-craft or rov, with the term coupled-damping:")
    for line in found.vehicle_lines():
        console.print(escape(line), soft_wrap=True)
