"""``seatrial docs``: the pages of the documentation, as they were installed."""

from __future__ import annotations

import re
from pathlib import Path
from typing import Annotated

import typer
from rich.markup import escape

from ..errors import InputError, unmatched
from ..shipped import shipped_folder
from .answer import answer
from .show import console

_TITLE = re.compile(r"^# (.+)$", re.MULTILINE)


def docs(
    word: Annotated[
        str,
        typer.Argument(
            metavar="[PAGE]", help="A page's name, or a word that one has in its name or title."
        ),
    ] = "",
) -> None:
    """List the pages of the documentation, or print the page that is named."""
    folder = shipped_folder("docs")
    titles = {name: _title(path) for name, path in _pages(folder).items()}
    found = {
        name: title for name, title in titles.items() if word.lower() in f"{name} {title}".lower()
    }
    exact = [name for name in found if word in (name, name.rpartition("/")[2])]
    if not found:
        raise InputError(unmatched("page", word, sorted(titles)))
    if len(found) == 1 or len(exact) == 1:
        (name,) = exact if len(exact) == 1 else found
        path = folder / f"{name}.md"
        answer.result = {"page": name, "path": str(path)}
        console.print(path.read_text("utf-8"), markup=False, highlight=False, soft_wrap=True)
        return
    answer.result = {"folder": str(folder), "pages": found}
    for name, title in found.items():
        console.print(f"{name:36} [dim]{escape(title)}[/dim]", soft_wrap=True)


def _pages(folder: Path) -> dict[str, Path]:
    """Return the pages by name, which is their path below ``folder`` without the ending."""
    paths = sorted(folder.rglob("*.md"))
    return {path.relative_to(folder).with_suffix("").as_posix(): path for path in paths}


def _title(path: Path) -> str:
    found = _TITLE.search(path.read_text("utf-8"))
    return found[1] if found else ""
