"""``seatrial profile``: check and describe profiles of a vehicle's electronics."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Annotated, Any

import typer
from rich.markup import escape

from ..fmi.components.index import component_class
from ..model.ports import Parameter
from ..model.readable import from_si, number, person_unit
from ..system.profile.file import Actuator, Home, Identity
from ..system.profile.kinds import GROUPS, keys
from ..system.profile.profile import NO_SOURCE, Profile, check_profile
from ..system.tunables import Tunable
from .show import console, print_notes

profile_app = typer.Typer(no_args_is_help=True, pretty_exceptions_enable=False)

Rows = Sequence[tuple[str, ...]]
Named = Annotated[str, typer.Argument(metavar="PROFILE", help="A profile: a name or a .toml file.")]


@profile_app.command()
def check(name: Named) -> None:
    """Check a profile; every mistake is reported with file and key (status 2)."""
    profile = check_profile(name)
    print_notes(_notes(profile))
    console.print(f"{escape(str(profile.read_from.path))}: no problem found", soft_wrap=True)


@profile_app.command()
def describe(name: Named) -> None:
    """Show a profile: identity, home, actuators, sensors and links with all their values."""
    profile = check_profile(name)
    console.print(f"[bold]{escape(profile.file.title)}[/bold]", soft_wrap=True)
    console.print(escape(str(profile.read_from.path)), soft_wrap=True)
    _print("identity", _identity(profile.file.identity))
    _print("home", _home(profile.file.home), profile.file.home.source or NO_SOURCE)
    if profile.file.actuators:
        _print("actuators", _actuators(profile.file.actuators))
    for group in GROUPS:
        for table, entry in profile.tables(group).items():
            kind, section = entry["kind"], f"{group}.{table}"
            rows = _parameters(keys(group, kind), profile, section)
            no_source = NO_SOURCE if group == "sensors" else ""
            _print(f"{section}: {kind}", rows, entry.get("source", "") or no_source)
            if reached := _simulated(kind, profile, section):
                _print(f"what {section} gives the firmware for its simulated instruments", reached)
            if tunables := profile.tunables(section):
                _print(f"tunables of {section}", _tunables(tunables))


def _simulated(kind: str, profile: Profile, section: str) -> Rows:
    """Return the parameters of a firmware's simulated instruments, and the sensor of each."""
    made = component_class(kind)
    if not hasattr(made, "simulated_instruments"):
        return []
    component: Any = made("component")
    for key, value in profile.parameters(section).items():
        component.set(key, value)
    rows = [(one.name, number(one.value), one.source) for one in component.simulated_instruments()]
    return [("parameter", "value", "from"), *rows]


def _notes(profile: Profile) -> list[str]:
    return [note for section in profile.sections() for note in profile.notes(section)]


def _print(title: str, rows: Rows, source: str = "") -> None:
    """Print columns that are never cut off: a key could not be copied then."""
    console.print(f"\n[bold]{escape(title)}[/bold]")
    if source:
        console.print(f"  source: {escape(source)}", soft_wrap=True)
    widths = [max(len(cell) for cell in column) for column in zip(*rows, strict=True)]
    for row in rows:
        line = "  ".join(cell.ljust(width) for cell, width in zip(row, widths, strict=True))
        console.print(f"  {escape(line.rstrip())}", soft_wrap=True)


def _identity(identity: Identity) -> Rows:
    rows = []
    for key, field in Identity.model_fields.items():
        value = getattr(identity, key)
        shown = f"0x{value:X}" if key == "uid" else str(value)
        rows.append((key, shown, field.description or ""))
    return rows


def _home(home: Home) -> Rows:
    return [
        ("latitude", f"{math.degrees(home.latitude):.7f} deg"),
        ("longitude", f"{math.degrees(home.longitude):.7f} deg"),
        ("altitude", f"{number(home.altitude)} m"),
        ("date", home.date.isoformat()),
    ]


def _actuators(actuators: dict[str, Actuator]) -> Rows:
    rows = [("channel", "name", "port", "pulses, us", "reversed", "source")]
    for name, entry in sorted(actuators.items(), key=lambda item: item[1].channel):
        pulses = (entry.pulse_min, entry.pulse_neutral, entry.pulse_max)
        shown = " ".join(number(from_si(pulse, "us")) for pulse in pulses)
        turned = "yes" if entry.reversed else "no"
        rows.append(
            (str(entry.channel), name, entry.port, shown, turned, entry.source or NO_SOURCE)
        )
    return rows


def _parameters(ports: dict[str, Parameter], profile: Profile, section: str) -> Rows:
    """Return a table's parameters: those of the file, and its component's where it has none."""
    given = profile.parameters(section)
    if tunables := profile.tunables(section):
        shown = f"{len(tunables)}, below"
        given |= {key: shown for key, port in ports.items() if port.role == "tunables"}
    rows = [("key", "value", "unit", "from", "meaning")]
    for key, port in ports.items():
        unit = person_unit(port.unit_of(0))
        value = _shown(given.get(key, port.start), unit)
        origin = "profile" if key in given else "default"
        rows.append((key, value, "" if unit == "1" else unit, origin, port.description))
    return rows


def _tunables(tunables: Sequence[Tunable]) -> Rows:
    rows = [("name", "min", "max", "unit", "sets")]
    for each in tunables:
        limits = number(each.min), number(each.max)
        rows.append((each.name, *limits, each.unit, " ".join(each.targets)))
    return rows


def _shown(value: Any, unit: str) -> str:
    """Return one value, or those of the axes if they differ, in ``unit``; text as it is."""
    values = value if isinstance(value, list) else [value]
    texts = [v if isinstance(v, str) else number(from_si(v, unit)) for v in values]
    return texts[0] if len(set(texts)) == 1 else f"({', '.join(texts)})"
