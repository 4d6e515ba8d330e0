"""``seatrial fmu``: list, build, check, describe and survey FMUs."""

from __future__ import annotations

import tempfile
from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from fnmatch import fnmatchcase
from pathlib import Path
from typing import Annotated

import typer
from rich.markup import escape
from rich.table import Table

from ..errors import InputError, unknown, unmatched
from ..fmi.building.export import build_fmu
from ..fmi.cache import write_named
from ..fmi.compiler import TARGETS, checked_platforms
from ..fmi.components.source import ComponentSource, find_source, named_sources, shipped_sources
from ..fmi.description import summary
from ..fmi.direct import DirectInstance
from ..fmi.files.osp import osp_file, osp_xml
from ..fmi.forwarding.libraries import why_unchecked
from ..fmi.instance import Value, Variable
from ..fmi.interfaces.loaded import LoadedFmu
from ..fmi.loading.built import build_needed, compiler_of
from ..fmi.loading.load import load_fmu, open_instance
from ..plugins import offered, service
from ..system.parameters import OWN, load_vehicle, split_reference
from ..system.references.values import from_entry
from ..system.system import settable
from .answer import answer
from .options import Autopilot, Choices, Every, Match, Settings, Variant, Vehicle, changes_of
from .show import MOST_SHOWN, console, print_more, print_notes, print_table
from .terminals import print_proposals, print_terminals

fmu_app = typer.Typer(no_args_is_help=True, pretty_exceptions_enable=False)

_UNCHECKED = (
    "the FMUs do not check what their host does, and run below folders with plain ASCII names only"
)
_WIDEST_NAME = 40
"""Of the column of names, in characters, where a terminal has not the width for all columns."""

Named = Annotated[str, typer.Argument(metavar="FMU", help="A shipped name, x.fmu or my.py:Class.")]


@fmu_app.command("list")
def list_fmus() -> None:
    """List the FMUs that are shipped."""
    for name, source in named_sources().items():
        console.print(f"{name:20} {escape(source.title)}", soft_wrap=True)


@fmu_app.command()
def build(
    names: Annotated[
        list[str] | None,
        typer.Argument(
            metavar="FMU...", help="Shipped names or my.py:Class; default: all shipped."
        ),
    ] = None,
    out: Annotated[Path, typer.Option("--out", "-o", help="Folder for the .fmu files.")] = Path(
        "."
    ),
    parameters: Annotated[
        str | None, typer.Option(help="Bake in a vehicle's parameters: VEHICLE or VEHICLE.TABLE.")
    ] = None,
    variant: Variant = None,
    osp: Annotated[
        bool, typer.Option("--osp", help="Write the OspModelDescription.xml of each beside it.")
    ] = False,
    native: Annotated[
        bool, typer.Option("--native", help="Components in C, which need no Python where they run.")
    ] = False,
    standalone: Annotated[
        bool,
        typer.Option("--standalone", help="With Python inside, for Linux on x86-64 without one."),
    ] = False,
    platforms: Annotated[
        str | None,
        typer.Option(help=f"Of FMUs that are compiled, with commas: {', '.join(TARGETS)}."),
    ] = None,
    fmi: Annotated[str, typer.Option(help="Version of FMI: 2 or 3.")] = "2",
    rig: Annotated[
        str | None,
        typer.Option(
            "--rig", metavar="NAME", help="A rig as one FMU: its name, a vehicle's, a file."
        ),
    ] = None,
    settings: Settings = None,
    choices: Choices = None,
    vehicle: Vehicle = None,
    autopilot: Autopilot = None,
    seed: Annotated[int | None, typer.Option(help="Seed of a rig's noise (default: 1).")] = None,
) -> None:
    """Build .fmu files that any tool loads which knows FMI 2.0, or 3.0."""
    version = _version(fmi)
    if native and standalone:
        raise InputError("--native FMUs need no Python, --standalone ones carry it: name one")
    carrier = "native" if native else "standalone" if standalone else ""
    if platforms and standalone:
        raise InputError("--platforms: --standalone FMUs are for Linux on x86-64 alone")
    changes = changes_of(settings, choices, vehicle, autopilot)
    wanted = checked_platforms(platforms) if platforms else []
    if rig is not None:
        _refuse_with_rig({"FMU": names, "--parameters": parameters, "--osp": osp})
        of_rig = (rig, changes, variant, 1 if seed is None else seed, version)
        built = service("interchange.rig_build")(*of_rig).build(out, carrier, wanted)
        answer.result["files"] = [str(built)]
        return
    if changes or seed is not None:
        raise InputError("--set, --choose, --vehicle, --autopilot and --seed are of --rig")
    targets = wanted or (checked_platforms("linux64") if native or version == 3 else [])
    if not carrier and not targets and (why := why_unchecked()):
        print_notes([f"{_UNCHECKED}: {why}"])
    for name in names or _default_names(native):
        source = _buildable(name)
        values = _start_values(source, parameters, variant) if parameters else None
        path = _write_fmu(source, out, carrier, version, targets, values)
        answer.result.setdefault("files", []).append(str(path))
        if osp:
            _write_osp(source, out)


def _refuse_with_rig(options: Mapping[str, object]) -> None:
    for option, given in options.items():
        if given:
            raise InputError(f"--rig: a rig has no {option} of its own")


def _write_fmu(
    source: ComponentSource,
    folder: Path,
    carrier: str,
    version: int,
    targets: Sequence[str],
    values: dict[str, Value] | None,
) -> Path:
    path = folder / f"{source.name}.fmu"
    if carrier == "native":
        service("native.build_native_fmu")(source, path, targets, values, version=version)
    elif carrier == "standalone":
        glibc = service("native.build_standalone_fmu")(source, path, values, version)
        print_notes([f"{path} runs on Linux on x86-64 with glibc {glibc} or newer"])
    else:
        build_fmu(source, path, values, version, targets)
    console.print(f"{path}  ({path.stat().st_size / 1000:.0f} kB)", soft_wrap=True)
    return path


def _version(text: str) -> int:
    """Return the version of FMI that a text names. Raises InputError."""
    versions = {"2": 2, "2.0": 2, "3": 3, "3.0": 3}
    if text not in versions:
        raise InputError(unknown("version of FMI", text, ["2", "3"]))
    return versions[text]


def _default_names(native: bool) -> list[str]:
    """Return the shipped components that can be built."""
    sources = shipped_sources()
    if not native:
        return list(sources)
    why_python = service("native.why_python")
    return [name for name, of in sources.items() if not why_python(of.component_class())]


def _write_osp(source: ComponentSource, folder: Path) -> None:
    """Write the terminals of a component for OSP, if it has any."""
    instance = DirectInstance(source.component_class()(source.name))
    if not instance.terminals:
        print_notes([f"{source.name} has no terminals: no OspModelDescription.xml"])
        return
    path = osp_file(folder, source.name)
    write_named(path, osp_xml(instance.terminals, instance.variables))
    console.print(str(path), soft_wrap=True)


@fmu_app.command()
def check(
    names: Annotated[
        list[str] | None, typer.Argument(metavar="FMU...", help="As for build; or x.fmu files.")
    ] = None,
) -> None:
    """Validate FMUs with FMPy and step them once, but for those that open links."""
    problems = 0
    for name in names or list(shipped_sources()):
        found = _problems(name)
        problems += len(found)
        answer.result.setdefault("problems", {})[name] = found
        console.print(f"{name}: {'no problem found' if not found else ''}", soft_wrap=True)
        for problem in found:
            console.print(f"  {escape(problem)}", soft_wrap=True)
    if problems:
        raise typer.Exit(1)


@fmu_app.command()
def describe(name: Named, pattern: Match = "", every: Every = False) -> None:
    """Show an FMU's variables (causality, type, unit, start value, limits) and terminals."""
    found = find_source(name, Path.cwd())
    if isinstance(found, Path):
        fmu = load_fmu(found)
        title, variables = fmu.description.description or found.name, fmu.variables
        through, notes, terminals = fmu.feedthrough, fmu.notes, fmu.terminals
        clocks = (*fmu.clocks.by_reference.values(),)
        title += (
            f"\nFMI {fmu.description.fmiVersion}, {' and '.join(fmu.interfaces)}; binaries for "
            f"{', '.join(fmu.platforms) or 'no platform'}{_build_said(fmu)}"
        )
    else:
        instance = DirectInstance(found.component_class()(found.name))
        title, variables = summary(type(instance.component)), instance.variables
        through, notes, terminals = instance.feedthrough, (), instance.terminals
        clocks = ()
    console.print(f"[bold]{escape(name)}[/bold]: {escape(title)}", soft_wrap=True)
    shown = [v for v in variables.values() if fnmatchcase(v.name, pattern or "*")]
    if pattern and not shown:
        raise InputError(f"{name}: {unmatched('variable', pattern, list(variables))}")
    most = len(shown) if every else MOST_SHOWN
    columns = ("name", "causality", "type", "unit", "start", "minimum", "maximum", "description")
    rows = [dict(zip(columns, _cells(variable), strict=True)) for variable in shown]
    answer.result = {"title": title, "variables": rows}
    if len(shown) > most:
        console.print(f"{len(shown)} variables: {_counts(shown)}", soft_wrap=True)
    table = Table(box=None, padding=(0, 2, 0, 0))
    names = max((len(v.name) for v in shown[:most]), default=0)
    table.add_column("variable", overflow="fold", min_width=min(names, _WIDEST_NAME))
    for heading in ("causality", "type", "unit", "start", "min", "max", "description"):
        table.add_column(heading, overflow="fold")
    for variable in shown[:most]:
        table.add_row(*(escape(cell) for cell in _cells(variable)))
    print_table(table)
    if len(shown) > most:
        print_more(len(shown) - most)
    for line in _dependencies(through, {v.name for v in shown[:most]}, most):
        console.print(line, soft_wrap=True)
    for clock in clocks:
        console.print(escape(str(clock)), soft_wrap=True)
    print_terminals(terminals, variables)
    if isinstance(found, Path) and not terminals:
        print_proposals(name, variables)
    for note in notes:
        console.print(f"note: {escape(note)}", soft_wrap=True)


def _build_said(fmu: LoadedFmu) -> str:
    """Return what happens to an FMU whose library for this machine is still to be built."""
    try:
        build = build_needed(fmu)
        by = "" if build is None else compiler_of(build).version
    except InputError as error:
        return f"; its sources cannot be built here: {error}"
    return "" if build is None else f"; it will be built of its sources by {by}"


def _counts(variables: list[Variable]) -> str:
    """Return how many variables there are of each causality."""
    counts = Counter(variable.causality for variable in variables)
    return ", ".join(f"{count} {causality}" for causality, count in counts.most_common())


def _dependencies(
    through: Mapping[str, Sequence[str]], shown: set[str], most: int
) -> Iterator[str]:
    """Yield a line for each of the outputs that are shown, with the first of its inputs."""
    for output, inputs in through.items():
        if output in shown:
            rest = f", ... ({len(inputs)} in all)" if len(inputs) > most else ""
            yield f"{output} depends at once on {', '.join(inputs[:most])}{rest}"


def _cells(variable: Variable) -> list[str]:
    def shown(value: object) -> str:
        return "" if value is None else str(value)

    kind = variable.causality
    if kind == "parameter" and variable.variability == "tunable":
        kind = "tunable"
    return [
        variable.name,
        kind,
        variable.type.__name__,
        variable.unit,
        shown(variable.start),
        shown(variable.minimum),
        shown(variable.maximum),
        variable.description,
    ]


def _buildable(name: str) -> ComponentSource:
    source = find_source(name, Path.cwd())
    if isinstance(source, Path):
        raise InputError(f"{name} is an FMU already; name a shipped FMU or my.py:Class")
    return source


def _start_values(
    source: ComponentSource, parameters: str, variant: str | None
) -> dict[str, Value]:
    vehicle, table = split_reference(parameters, source.name)
    chosen = load_vehicle(vehicle).parameter_set(table, variant)
    variables = DirectInstance(source.component_class()(source.name)).variables
    if parameters.endswith(OWN):
        chosen = chosen.own(variables, source.name, "--parameters")
    values = {}
    for port, entry in chosen.values.items():
        scalars = settable(variables, port, chosen.origin)
        given = from_entry(entry, scalars, chosen.origin, chosen.folder)
        values.update({name: one.value for name, one in given.items()})
    return values


def _problems(name: str) -> list[str]:
    from ..fmi.loading.conformance import LARGEST_CHECKED, is_whole, problems

    with tempfile.TemporaryDirectory() as folder:
        source = find_source(name, Path.cwd())
        path = source if isinstance(source, Path) else build_fmu(source, Path(folder) / "x.fmu")
        fmu = load_fmu(path)  # first: FMPy's checker trusts the file
        if not is_whole(fmu):
            most = f"{LARGEST_CHECKED // 2**20} MiB"
            print_notes(
                [
                    f"{name}: its model description has more than {most}: only names of "
                    "variables are checked in it, and that it runs"
                ]
            )
        if said := _build_said(fmu):
            print_notes([f"{name}{said}"])
        if _reaches_outside(source, fmu):
            print_notes([f"{name}: not run, since it would open its links"])
            return problems(fmu)
        return problems(fmu) or _run_once(fmu)


def _reaches_outside(source: ComponentSource | Path, fmu: LoadedFmu) -> bool:
    """Say if an instance opens sockets, ports or buses: a check must not."""
    if isinstance(source, Path):
        return bool(fmu.variables.of_role("address"))
    return not source.component_class().rolls_back


def _run_once(fmu: LoadedFmu) -> list[str]:
    """Step an instance twice; its errors are the problems."""
    from ..errors import SimulationError

    instance, step, found = None, 0.01, list[str]()
    experiment = fmu.description.defaultExperiment
    if experiment is not None and experiment.stepSize and not fmu.any_step:
        step = float(experiment.stepSize)
    try:
        instance = open_instance(fmu, "check")
        instance.initialise(0.0, 1.0)
        instance.begin()
        instance.step(0.0, step)
        instance.step(step, step)
        instance.reader([v.name for v in fmu.variables.values() if v.causality == "output"])()
        instance.terminate()
    except SimulationError as error:
        found.append(str(error))
    if instance is not None:
        try:
            instance.free()
        except SimulationError as error:
            found.append(str(error))
    return found


if survey := offered("survey.folder"):
    fmu_app.command("survey")(survey)
