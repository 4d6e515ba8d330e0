"""Reference pages: shipped components by module, commands by their own help."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path
from tempfile import TemporaryDirectory

from parts import part
from parts.markdown import table
from seatrial.fmi.description import summary
from seatrial.fmi.source import shipped_sources


@part("component-list")
def component_list() -> str:
    """Shipped components, one table for each package."""
    packages: dict[str, list[tuple[str, str, str]]] = {}
    for name, source in shipped_sources().items():
        component = source.component_class()
        package = component.__module__.split(".")[1]
        row = (f"`{name}`", summary(component), f"`{component.__module__}.{component.__name__}`")
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
    return "\n" + text.partition("\n")[2].lstrip().replace("\n# ", "\n## ").rstrip() + "\n"
