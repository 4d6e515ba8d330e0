"""Reference pages: shipped components by module, commands by their own help."""

from __future__ import annotations

import re
import subprocess
import sys
from pathlib import Path
from tempfile import TemporaryDirectory

from parts import part
from parts.markdown import table
from seatrial.fmi.source import shipped_sources


@part("component-list")
def component_list() -> str:
    """Shipped components, one table for each package."""
    packages: dict[str, list[tuple[str, str, str]]] = {}
    for name, source in shipped_sources().items():
        package = source.module.split(".")[1]
        row = (f"`{name}`", source.title, f"`{source.module}.{source.class_name}`")
        packages.setdefault(package, []).append(row)
    return "".join(
        f"\n## {package}\n\n" + table(("name", "what it is", "class"), packages[package])
        for package in sorted(packages)
    )


@part("cli")
def cli() -> str:
    """Every command with its arguments and options, as Typer documents them."""
    with TemporaryDirectory() as folder:
        page = Path(folder) / "cli.md"
        typer = [sys.executable, "-m", "typer", "seatrial.cli.main", "utils", "docs"]
        subprocess.run(
            [*typer, "--name", "seatrial", "--output", page], check=True, capture_output=True
        )
        text = page.read_text("utf-8").replace("&#x27;", "'")
    titles = dict(re.findall(r"^#+ `([\w ]+)`\n\n(.*?)\n\n", text, re.DOTALL | re.MULTILINE))
    lines, command = [], ""
    for line in text.splitlines():
        if heading := re.match(r"#+ `([\w ]+)`", line):
            command = heading[1]
        if listed := re.match(r"\* `(\w+)`: ", line):  # cut short by Typer
            line = listed[0] + titles.get(f"{command} {listed[1]}", line[listed.end() :])
        lines.append(line)
    return "\n" + "\n".join(lines[1:]).strip() + "\n"
