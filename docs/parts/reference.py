"""Reference pages: shipped components by module, commands by their own help."""

from __future__ import annotations

import re

import typer
from typer.cli import get_docs_for_click
from typer.core import TyperGroup

from parts import part
from parts.markdown import table
from seatrial.cli.commands import commands, loaded
from seatrial.cli.main import app
from seatrial.fmi.components.source import shipped_sources
from seatrial.kits import Kit, is_ours, kits


@part("component-list")
def component_list() -> str:
    """Shipped components, one table for each package."""
    packages: dict[str, list[tuple[str, str, str]]] = {}
    for name, source in shipped_sources().items():
        top, package = source.module.split(".")[:2]
        package = f"{package} (a kit)" if top != "seatrial" else package
        row = (f"`{name}`", source.title, f"`{source.module}.{source.class_name}`")
        packages.setdefault(package, []).append(row)
    return "".join(
        f"\n## {package}\n\n" + table(("name", "what it is", "class"), packages[package])
        for package in sorted(packages)
    )


@part("kits")
def kit_list() -> str:
    """Kits of this distribution: what each is for, its components and commands."""

    def names(kit: Kit, kind: str) -> str:
        return ", ".join(f"`{entry.name}`" for entry in kit.entries.get(kind, ())) or "–"

    rows = [
        (f"`{kit.name}`", kit.title, names(kit, "components"), names(kit, "commands"))
        for kit in kits().found
        if is_ours(f"{kit.folder.parent.name}.{kit.name}")
    ]
    return table(("kit", "for", "components", "commands"), rows)


@part("cli")
def cli() -> str:
    """Every command with its arguments and options, as Typer documents them."""
    group = typer.main.get_command(app)
    assert isinstance(group, TyperGroup)
    group.commands = {name: loaded(name) for name in commands()}  # with their options
    text = get_docs_for_click(obj=group, ctx=typer.Context(group), name="seatrial")
    text = text.strip().replace("&#x27;", "'")
    titles = dict(re.findall(r"^#+ `([\w -]+)`\n\n(.*?)\n\n", text, re.DOTALL | re.MULTILINE))
    lines, command = [], ""
    for line in text.splitlines():
        if heading := re.match(r"#+ `([\w -]+)`", line):
            command = heading[1]
        if listed := re.match(r"\* `([\w-]+)`: ", line):  # cut short by Typer
            line = listed[0] + titles.get(f"{command} {listed[1]}", line[listed.end() :])
        lines.append(line)
    return "\n" + "\n".join(lines[1:]).strip() + "\n"
