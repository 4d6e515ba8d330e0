"""``seatrial describe``: what a rig is made of, and every connection in it."""

from __future__ import annotations

from fnmatch import fnmatchcase
from pathlib import Path
from typing import Annotated, Any

import typer
from rich.markup import escape

from ..errors import InputError, unmatched
from ..files.whole_file import write_whole
from ..model.readable import number
from ..plugins import offered
from ..system.assembling.assembly import assemble
from ..system.assembling.fitted_parts import forgotten, vacant
from ..system.flattening import load_rig
from ..system.packages import is_package, read_package
from ..system.paths import joined, split_axis
from ..system.rig import Rig, Scope
from ..system.system import Joint, System
from ..system.unread import leave_out_unread
from ..trial.files.fault_keys import choices_in
from ..trial.files.naming import by_path, named_components
from ..trial.files.trial import is_trial, load_trial
from ..trial.reports.diagram import MOST_DRAWN, diagram
from .answer import answer
from .options import Autopilot, Choices, Every, Match, Vehicle, changes_of
from .show import MOST_SHOWN, console, print_more, print_notes


def describe(
    rig: Annotated[str, typer.Argument(help="A rig or a trial: a name, a file or a package.")],
    choices: Choices = None,
    vehicle: Vehicle = None,
    autopilot: Autopilot = None,
    pattern: Match = "",
    every: Every = False,
    drawn: Annotated[
        Path | None, typer.Option("--diagram", metavar="FILE", help="Draw it into a file, as SVG.")
    ] = None,
) -> None:
    """Show a rig's components, inner rigs, connections, and open inputs."""
    if drawn is not None and drawn.suffix.lower() != ".svg":
        raise InputError(f"--diagram: {drawn}: the drawing is SVG: a name that ends in .svg")
    changes = changes_of(None, choices, vehicle, autopilot)
    if is_package(rig) and not changes:  # no trial: it may name no stop time
        package = read_package(Path(rig).resolve(), {})
        print_notes(package.notes)
        trial, loaded = None, package.rig
    else:
        trial = load_trial(rig, changes=changes, origin="--choose") if is_trial(rig) else None
        loaded = trial.rig if trial else load_rig(rig, None, choices_in(changes, "--choose"))
    system = assemble(loaded, "direct" if _in_process(loaded) else "fmu")
    try:
        named = (
            named_components(by_path(trial.scheduled(system), system), system) if trial else set()
        )
        leave_out_unread(system, named)
        _print_rig(system, pattern, every)
        if drawn is not None:
            _draw(system, drawn)
    finally:
        system.discard()


def _in_process(rig: Rig) -> bool:
    """Say if all components can be shown without making or opening an FMU."""
    return not any(
        placed.entry.fmu.endswith(".fmu") or placed.entry.isolated
        for placed in rig.components.values()
    )


def _draw(system: System, path: Path) -> None:
    """Write the block diagram of a rig. Raises InputError if it has too many parts to be read."""
    components = {
        name: placed.entry.what
        for name, placed in system.rig.components.items()
        if name not in system.left_out
    }
    found = diagram(components, [(joint.source, joint.target) for joint in system.joints])
    if found is None:
        raise InputError(f"--diagram: {len(components)} components: at most {MOST_DRAWN} are drawn")
    write_whole(path, found)
    answer.result["diagram"] = str(path)
    console.print(f"\ndiagram: {escape(str(path))}", soft_wrap=True)


def _print_rig(system: System, pattern: str, every: bool) -> None:
    top = system.rig.top
    console.print(f"[bold]{escape(top.file.title or top.read_from.name)}[/bold]")
    for name, value in top.choices.items():
        console.print(f"  {escape(name)} = {escape(value)}", soft_wrap=True)
    _print_components(top, "", system.left_out)
    joints = [one for one in system.joints if _matches(pattern, one.source, one.target)]
    in_python = offered("native.in_python")
    python = {} if pattern or in_python is None else in_python(system)
    width = max((len(joint.source) for joint in joints), default=0)
    lines = [f"{joint.source:{width}} -> {joint.target}{_transformed(joint)}" for joint in joints]
    alone, derived = forgotten(system), _derived(system, pattern)
    empty = vacant(system)
    lists = {
        f"{len(lines)} connections": lines,
        "not made": system.open,
        "forces and commands that nothing feeds": [n for n in alone if _matches(pattern, n)],
        "inputs that nothing feeds": [
            name
            for name in system.unconnected_inputs()
            if name not in alone and _matches(pattern, name)
        ],
        "optional inputs that nothing feeds": [
            name
            for name in system.unconnected_inputs(optional=True)
            if name not in alone and name not in empty and _matches(pattern, name)
        ],
        "in Python, also with --engine native": [
            f"{', '.join(names)}: {why}" for why, names in python.items()
        ],
        "values that follow from others": [_derived_line(row) for row in derived],
        "shows": [
            f"{name} = {value!r}"
            for name, value in top.file.shows.items()
            if _matches(pattern, name)
        ],
    }
    if pattern and not any(lists.values()):
        ends = [name for one in system.joints for name in (one.source, one.target)]
        loose = [
            name for some in (False, True) for name in system.unconnected_inputs(optional=some)
        ]
        raise InputError(unmatched("signal", pattern, [*ends, *loose, *alone, *top.file.shows]))
    answer.result = {
        "title": top.file.title or top.read_from.name,
        "choices": dict(top.choices),
        "components": {path: placed.entry.what for path, placed in system.rig.components.items()},
        "connections": [
            {"from": one.source, "to": one.target, "factor": one.factor, "offset": one.offset}
            for one in joints
        ],
        "not_made": lists["not made"],
        "unfed_forces": lists["forces and commands that nothing feeds"],
        "unfed_inputs": lists["inputs that nothing feeds"],
        "in_python": {name: why for why, names in python.items() for name in names},
        "derived": derived,
    }
    for title, lines in lists.items():
        _print_list(title, lines, len(lines) if every else MOST_SHOWN)


def _derived(system: System, pattern: str) -> list[dict[str, Any]]:
    """Return what files say by expressions, port by port, with value, unit and expression."""
    ports: dict[tuple[str, str], dict[str, Any]] = {}
    for name, part in system.parts.items():
        for variable, given in part.given.items():
            port = f"{name}.{split_axis(variable)[0]}"
            if given.expression and _matches(pattern, port, f"{name}.{variable}"):
                unit = part.instance.variables[variable].unit
                row = {"port": port, "value": [], "unit": unit, "expression": given.expression}
                ports.setdefault((port, given.expression), row)["value"].append(given.value)
    return list(ports.values())


def _derived_line(row: dict[str, Any]) -> str:
    texts = [number(v, 6) if isinstance(v, float) else str(v) for v in row["value"]]
    value = f"[{', '.join(texts)}]" if len(texts) > 1 else texts[0]
    unit = "" if row["unit"] in ("", "1") else f" {row['unit']}"
    return f"{row['port']} = {value}{unit}: {row['expression']}"


def _matches(pattern: str, *names: str) -> bool:
    return not pattern or any(fnmatchcase(name, pattern) for name in names)


def _transformed(joint: Joint) -> str:
    said = [", ".join(f"{before} becomes {after}" for before, after in joint.mapping)]
    if (joint.factor, joint.offset) != (1.0, 0.0):
        said.append(
            f"times {joint.factor:g}" + (f", plus {joint.offset:g}" if joint.offset else "")
        )
    return f"  ({', '.join(filter(None, said))})" if any(said) else ""


def _print_components(scope: Scope, indent: str, left_out: list[str]) -> None:
    for name, entry in scope.file.components.items():
        if name not in scope.inner:
            out = "  (left out: nothing reads it)" if joined(scope.path, name) in left_out else ""
            console.print(f"{indent}  {escape(name)}: {escape(entry.what)}{out}", soft_wrap=True)
            continue
        inner = scope.inner[name]
        title = inner.file.title or inner.read_from.name
        console.print(f"{indent}  [bold]{escape(name)}[/bold]: {escape(title)}", soft_wrap=True)
        _print_components(inner, f"{indent}  ", left_out)


def _print_list(title: str, lines: list[str], most: int) -> None:
    if lines:
        console.print(f"\n[bold]{title}[/bold]")
    for line in lines[:most]:
        console.print(f"  {escape(line)}", soft_wrap=True)
    if len(lines) > most:
        print_more(len(lines) - most)
