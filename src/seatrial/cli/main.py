"""The command line: which command runs, and how its errors reach the user."""

from __future__ import annotations

import atexit
import gc
import logging
import sys
import traceback
from typing import Annotated

import typer

from .. import __version__
from ..errors import InputError, SeatrialError, SimulationError
from ..kits import lacking
from ..printable import PrintableFormatter, printable
from .answer import answer, renewed
from .commands import LazyGroup
from .starting import interrupting
from .statuses import BAD_INPUT, BROKEN
from .unread import dropping_unread

_INTERRUPTED = 130
"""Status of Typer's own for a command that was interrupted."""
_MISUSED = "the command was not used as it is meant: stderr says why"
_ALLOCATIONS = 200_000
"""Between two garbage collections; at Python's 700 they take up to a tenth of a start."""

app = typer.Typer(
    cls=LazyGroup,
    no_args_is_help=True,
    pretty_exceptions_enable=False,
    context_settings={"max_content_width": 110, "help_option_names": ["-h", "--help"]},
    rich_markup_mode=None,  # plain help: what draws boxes takes half of the time of a start
    help="Sea trials before the water: co-simulated trials of marine vehicles.",
)


def main() -> None:
    """Run the command line; every error meant for the user is one message and a status.

    Status 1 is a verdict: an error of seatrial itself shows where it was, and has status 3.
    """
    gc.set_threshold(_ALLOCATIONS)
    atexit.register(gc.freeze)  # else the end of Python looks through all that was imported
    if logging.lastResort is not None:
        logging.lastResort.setFormatter(PrintableFormatter())
    with interrupting(), dropping_unread():
        _run()


def _run() -> None:
    renewed()
    if "--json" in sys.argv[1:]:  # before anything is said, and whatever else is wrong
        answer.begin("json")
    try:
        app()
    except InputError as error:
        _complain(error, BAD_INPUT)
    except SeatrialError as error:
        _complain(error, BROKEN)
    except OSError as error:
        where = f" {error.filename}" if error.filename else ""
        _complain(SimulationError(f"cannot read or write{where}: {error.strerror}"), BROKEN)
    except KeyboardInterrupt:
        _complain(SimulationError("stopped"), BROKEN)
    except SystemExit as end:
        if end.code == _INTERRUPTED:
            _complain(SimulationError("stopped"), BROKEN)
        status = end.code if isinstance(end.code, int) else int(end.code is not None)
        answer.end(status, _MISUSED if status == BAD_INPUT else None)
        raise
    except Exception as error:  # Python's own status 1 would say that a criterion failed
        if said := lacking(error):
            _complain(InputError(said), BAD_INPUT)
        if _comes_of_interruption(error):
            _complain(SimulationError("stopped"), BROKEN)
        print(printable(traceback.format_exc()), file=sys.stderr)
        what = f"an error of seatrial itself, please report it: {type(error).__name__}: {error}"
        _complain(SimulationError(what), BROKEN)


def _comes_of_interruption(error: BaseException | None) -> bool:
    """Say if an error was made of a KeyboardInterrupt, as Python 3.11 does in class bodies."""
    while error is not None and not isinstance(error, KeyboardInterrupt):
        error = error.__cause__
    return error is not None


def _complain(error: SeatrialError, status: int) -> None:
    answer.end(status, str(error))
    print(printable(f"seatrial: {error}"), file=sys.stderr)
    sys.exit(status)


def _version(wanted: bool) -> None:
    if wanted:
        print(f"seatrial {__version__}")
        raise typer.Exit


@app.callback()
def _options(
    version: Annotated[
        bool,
        typer.Option("--version", "-V", callback=_version, is_eager=True, help="Show the version."),
    ] = False,
) -> None:
    """Options before the command."""
