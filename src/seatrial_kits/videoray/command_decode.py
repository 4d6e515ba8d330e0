"""``seatrial decode``: recorded streams as text."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from seatrial.printable import printable

from .decode import describe_stream
from .stream_file import read_stream

decode_app = typer.Typer(no_args_is_help=True, pretty_exceptions_enable=False)


@decode_app.callback()
def _options() -> None:
    """Show what a recorded stream says."""


@decode_app.command()
def videoray(
    file: Annotated[Path, typer.Argument(metavar="FILE", help="A recorded stream, NAME.stream.")],
) -> None:
    """Show the frames of a VideoRay stream, PRO4 and VRCSR, one a line."""
    for line in describe_stream(read_stream(file)):
        print(printable(line))
