"""The answer of a command: for people, for programs (``--json``), or none.

Every command takes ``--json``, ``--quiet`` and ``--verbose``. With ``--json`` stdout has one JSON
document, whatever happens; ``docs/reference/json.md`` describes it. What would have been printed is
its ``lines``.
"""

from __future__ import annotations

import io
import json
import math
import os
import sys
from dataclasses import dataclass, field
from typing import Annotated, Any

import typer

from .. import __version__
from .statuses import BROKEN
from .unread import say_lost, write

FORMAT = 1
_STDOUT, _STDERR = 1, 2
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
    is_json: bool = False
    """Whether a document is wanted."""
    _before: Any = None
    _ours: Any = None
    """stdout as it was, and as the document goes to it."""

    def begin(self, name: str) -> None:
        """Take one of the options."""
        if name == "json" and not self.is_json:
            self.is_json = True
            self._before, sys.stdout = sys.stdout, io.StringIO()
            self._ours = _apart(self._before)
        elif name == "quiet":
            self.quiet = True
        elif name == "verbose":
            self.verbose = True

    def end(self, status: int, error: str | None = None) -> None:
        """Write the document, if one is wanted, and let stdout be what it was."""
        if not self.is_json:
            return
        said = sys.stdout.getvalue() if isinstance(sys.stdout, io.StringIO) else ""
        sys.stdout, self.is_json = self._before, False
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
        if lost := write(self._ours, json.dumps(document, indent=2, allow_nan=False) + "\n"):
            say_lost(lost)
            raise SystemExit(status or BROKEN)


answer = Answer()
"""Of the command that runs: `main` makes a new one for each."""


def _apart(stream: Any) -> Any:
    """Return a stream to stdout that is ours alone: what FMUs print themselves goes to stderr.

    C keeps what an FMU prints until the process ends: so stdout's descriptor is not given back.
    """
    try:
        if stream is None or stream.fileno() != _STDOUT:
            return stream
        ours = os.dup(_STDOUT)
        os.dup2(_STDERR, _STDOUT)
    except (OSError, ValueError):  # a stream of Python's own, a descriptor that is closed
        return stream
    return os.fdopen(ours, "w", encoding=stream.encoding, errors=stream.errors)


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
    answer.command = answer.command or _named(context)
    if wanted:
        answer.begin(str(param.name))


def _named(context: Any) -> str:
    """Return a command as it is called; what stands for a name is in capitals, and left out."""
    names: list[str] = []
    while context.parent is not None:
        names.insert(0, context.info_name)
        context = context.parent
    return " ".join(name for name in names if not name.isupper())


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
