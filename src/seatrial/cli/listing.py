"""``seatrial list``: what can be named on the command line and in files."""

from __future__ import annotations

import re
from collections.abc import Iterable, Mapping
from typing import Annotated

import typer
from rich.markup import escape

from ..errors import InputError, unmatched
from ..files.reading import toml_content
from ..files.vehicle_folders import Place
from ..fmi.components.source import named_sources
from ..shipped import available_places
from .answer import answer
from .show import console

_KINDS = {
    "trials": "harness/trials",
    "campaigns": "harness/campaigns",
    "rigs": "harness/rigs",
    "vehicles of rigs (--vehicle)": "harness/rigs/vehicles",
    "autopilots of rigs (--autopilot)": "harness/rigs/autopilots",
    "parameters of vehicles": "vehicles",
    "profiles": "hil_profiles",
    "experiments": "harness/identification",
    "hulls (estimate)": "harness/hulls",
}
_KEYS = {
    "vehicles of rigs (--vehicle)": "vehicles",
    "autopilots of rigs (--autopilot)": "autopilots",
    "parameters of vehicles": "parameters",
    "hulls (estimate)": "hulls",
    "FMUs": "fmus",
}
"""How the kinds are called for programs, where that differs."""
_BY_VEHICLE = ("trials", "campaigns", "rigs")
_ANY = "any vehicle"


def list_all(
    word: Annotated[
        str,
        typer.Argument(
            metavar="[WORD]", help="Only what has a word that begins so in its name or title."
        ),
    ] = "",
) -> None:
    """List trials, campaigns, rigs, vehicles, profiles, experiments and FMUs by name."""
    listed = {
        kind: {name: _title(place) for name, place in available_places(folder).items()}
        for kind, folder in _KINDS.items()
    }
    listed["FMUs"] = {name: source.title for name, source in named_sources().items()}
    vehicles = [*listed["parameters of vehicles"]]
    begins = re.compile(rf"(?<![^\W_]){re.escape(word)}", re.IGNORECASE)  # no "plotter" for "otter"
    found = {
        kind: {n: title for n, title in titles.items() if begins.search(f"{n} {title}")}
        for kind, titles in listed.items()
    }
    if not any(found.values()):
        names = sorted({name for titles in listed.values() for name in titles})
        raise InputError(unmatched("name or title", word, names))
    answer.result = {_KEYS.get(kind, kind): titles for kind, titles in found.items()}
    for kind, titles in found.items():
        if titles:
            console.print(f"[bold]{kind}[/bold]")
            _print(titles, vehicles if kind in _BY_VEHICLE else [])


def _print(titles: Mapping[str, str], vehicles: Iterable[str]) -> None:
    """Print names with titles, those of one vehicle together."""
    groups: dict[str, dict[str, str]] = {}
    for name, title in titles.items():
        groups.setdefault(_vehicle_of(name, vehicles), {})[name] = title
    for vehicle in sorted(groups, key=lambda vehicle: (vehicle == _ANY, vehicle)):
        if vehicle != _ANY or len(groups) > 1:
            console.print(f"  {vehicle}")
        indent = "    " if len(groups) > 1 or vehicle != _ANY else "  "
        for name, title in groups[vehicle].items():
            console.print(f"{indent}{name:28} [dim]{escape(title)}[/dim]", soft_wrap=True)


def _vehicle_of(name: str, vehicles: Iterable[str]) -> str:
    """Return the vehicle that a name begins with, the longest if there are several."""
    begun = [each for each in vehicles if name == each or name.startswith(f"{each}-")]
    return max(begun, key=len, default=_ANY)


def _title(place: Place) -> str:
    try:
        content = place.content(toml_content(place.path.read_bytes(), str(place.path)))
        return str(content.get("title", "")) if isinstance(content, dict) else ""
    except (InputError, OSError):
        return "(cannot be read)"
