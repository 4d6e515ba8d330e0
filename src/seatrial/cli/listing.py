"""``seatrial list``: what can be named on the command line and in files."""

from __future__ import annotations

from pathlib import Path

from rich.markup import escape

from ..errors import InputError
from ..fmi.source import named_sources
from ..reading import toml_content
from ..shipped import available
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


def list_all() -> None:
    """List trials, campaigns, rigs, vehicles, profiles, experiments and FMUs by name."""
    listed = {
        kind: {name: _title(path) for name, path in available(folder).items()}
        for kind, folder in _KINDS.items()
    }
    listed["FMUs"] = {name: source.title for name, source in named_sources().items()}
    answer.result = {_KEYS.get(kind, kind): titles for kind, titles in listed.items()}
    for kind, titles in listed.items():
        _print(kind, titles)


def _print(kind: str, titles: dict[str, str]) -> None:
    console.print(f"[bold]{kind}[/bold]")
    for name, title in titles.items():
        console.print(f"  {name:28} [dim]{escape(title)}[/dim]", soft_wrap=True)


def _title(path: Path) -> str:
    try:
        return str(toml_content(path.read_bytes(), str(path)).get("title", ""))
    except (InputError, OSError):
        return "(cannot be read)"
