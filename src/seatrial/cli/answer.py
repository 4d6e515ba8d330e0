"""The answer of a command: for people, for programs (``--json``), or none.

Every command takes ``--json``, ``--quiet`` and ``--verbose``. With ``--json`` stdout has one JSON
document, whatever happens; ``docs/reference/json.md`` describes it. What would have been printed is
its ``lines``.
"""

from __future__ import annotations

import io
import json
import math
import sys
from dataclasses import dataclass, field
from typing import Annotated, Any, TextIO

import typer

from .. import __version__

FORMAT = 1
_OPTIONS = ("json", "quiet", "verbose")


@dataclass
class Answer:
    """The answer of the command that runs."""

    command: str = ""
    verbose: bool = False
    quiet: bool = False
    result: dict[str, Any] = field(default_factory=dict)
    """What the command found, for programs; each command has its own keys."""
    notes: list[str] = field(default_factory=list)
    _stdout: TextIO | None = None
    """Where the document goes; None without --json."""

    @property
    def is_json(self) -> bool:
        """Whether a document is wanted."""
        return self._stdout is not None

    def begin(self, name: str) -> None:
        """Take one of the options."""
        if name == "json" and not self.is_json:
            self._stdout, sys.stdout = sys.stdout, io.StringIO()
        elif name == "quiet":
            self.quiet = True
        elif name == "verbose":
            self.verbose = True

    def end(self, status: int, error: str | None = None) -> None:
        """Write the document, if one is wanted, and let stdout be what it was."""
        if self._stdout is None:
            return
        said = sys.stdout.getvalue() if isinstance(sys.stdout, io.StringIO) else ""
        sys.stdout, self._stdout, stdout = self._stdout, None, self._stdout
        document = {
            "format": FORMAT,
            "seatrial": __version__,
            "command": self.command,
            "status": status,
            "error": error,
            "notes": self.notes,
            "result": _plain(self.result),
            "lines": said.splitlines(),
        }
        print(json.dumps(document, indent=2, allow_nan=False), file=stdout)


answer = Answer()
"""Of the command that runs: `main` makes a new one for each."""


def renewed() -> Answer:
    """Return the answer, as of a command that begins."""
    answer.__init__()  # type: ignore[misc]
    return answer


def with_options(command: Any) -> Any:
    """Add the options of all commands to one of Typer's, and to those that it groups."""
    within = getattr(command, "commands", None)
    for each in (within or {}).values():
        with_options(each)
    if within is None:
        command.params += _options()
    return command


def _options() -> list[Any]:
    """Return Typer's own options: those of a command that has no others."""
    app = typer.Typer(add_completion=False)
    app.command()(_common)
    return [each for each in typer.main.get_command(app).params if each.name in _OPTIONS]


def _begin(context: typer.Context, param: typer.CallbackParam, wanted: bool) -> None:
    answer.command = answer.command or context.command_path.partition(" ")[2]
    if wanted:
        answer.begin(str(param.name))


def _flag(*names: str, said: str) -> Any:
    return typer.Option(
        *names, callback=_begin, is_eager=True, expose_value=False, show_default=False, help=said
    )


def _common(
    json: Annotated[bool, _flag("--json", said="Answer with one JSON document.")] = False,
    quiet: Annotated[bool, _flag("--quiet", "-q", said="Say nothing but errors.")] = False,
    verbose: Annotated[
        bool, _flag("--verbose", "-v", said="Say more: margins, where the time went.")
    ] = False,
) -> None:
    """Have the options that every command has."""


def _plain(value: Any) -> Any:
    """Return what JSON has: numbers that are not finite as text, paths as text, NumPy's as own."""
    if isinstance(value, dict):
        return {str(key): _plain(part) for key, part in value.items()}
    if isinstance(value, (list, tuple)):
        return [_plain(part) for part in value]
    if hasattr(value, "tolist"):
        return _plain(value.tolist())
    if isinstance(value, float) and not math.isfinite(value):
        return str(value)
    return value if isinstance(value, (bool, int, float, str, type(None))) else str(value)
