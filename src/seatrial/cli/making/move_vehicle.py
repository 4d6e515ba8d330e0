"""``seatrial move-vehicle``: a vehicle of several folders into one."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer
from rich.markup import escape

from ...system.moved_vehicle import move_vehicle
from ..answer import answer
from ..show import console


def move(name: Annotated[str, typer.Argument(help="The vehicle's name.")]) -> None:
    """Move the files of a vehicle below the current folder into harness/vehicles/NAME.

    Numbers, rig, pilot and the parts that these name are compared before and after: what would
    not be the same is left as it was.
    """
    here = Path.cwd()
    moved = move_vehicle(name, here)
    answer.result = {kind: [_from(path, here) for path in paths] for kind, paths in moved.items()}
    for kind, paths in answer.result.items():
        for path in paths:
            console.print(f"{kind:8} {escape(path)}", soft_wrap=True)


def _from(path: Path, here: Path) -> str:
    return path.relative_to(here).as_posix()
