"""Terminals of FMUs, shown and proposed."""

from __future__ import annotations

import json
import re
from collections.abc import Mapping
from pathlib import Path

from rich.markup import escape
from rich.table import Table

from ..fmi.files.proposals import proposed_terminals
from ..fmi.files.terminals import scalars_of
from ..fmi.instance import Variables
from ..model.terminals import Terminal
from .show import console, print_table


def print_terminals(terminals: Mapping[str, Terminal], variables: Variables) -> None:
    """Print the members of each terminal: what they are, and their direction."""
    if not terminals:
        return
    table = Table(box=None, padding=(0, 2, 0, 0))
    for heading in ("terminal", "rule", "member", "variables", "direction"):
        table.add_column(heading, overflow="fold")
    for name, terminal in terminals.items():
        head = [name, terminal.rule]
        for member, target in terminal.members.items():
            terms = variables.terms.get(target)
            shown = f"{target} ({len(terms)} terms)" if terms else target
            ways = dict.fromkeys(v.causality for v in scalars_of(variables, target).values())
            table.add_row(*map(escape, [*head, member, shown, ", ".join(ways)]))
            head = ["", ""]
    print_table(table)


def print_proposals(fmu: str, variables: Variables) -> None:
    """Print a rig that shows the terminals that the FMU at ``fmu`` could have, if any."""
    proposed = proposed_terminals(variables)
    if not proposed:
        return
    name = re.sub(r"\W", "_", Path(fmu).stem, flags=re.ASCII)  # a bare key of TOML
    lines = [
        "it has no terminals; by names and units it could show these in a rig of its own:",
        "",
        "[components]",
        f"{name} = {{ fmu = {_toml(fmu)} }}",
        "",
        "[shows]",
    ]
    for terminal, members in proposed.items():
        written = ", ".join(f"{m} = {_toml(f'{name}.{port}')}" for m, port in members.items())
        lines.append(f"{terminal} = {{ {written} }}")
    console.print(escape("\n".join(lines)), soft_wrap=True)


def _toml(text: str) -> str:
    """Return a TOML string: those of JSON are."""
    return json.dumps(text, ensure_ascii=False)
