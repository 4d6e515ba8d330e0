"""The microcontroller of a sketch's board: by its project's files, or as given."""

from __future__ import annotations

import re
from pathlib import Path

from ..mcus import MCUS, Mcu
from .platformio import DEFAULT_MCU, project_mcu, project_of, read_project

_FQBN = re.compile(r"(?:default_fqbn\s*:|\"board\"\s*:\s*\"|fqbn\s*:)\s*\"?([\w.:-]+)")


def named_board(folder: Path) -> tuple[str, str]:
    """Return a file that names a sketch's board, and its fully qualified name; '' without one.

    These files are of arduino-cli and of editors.
    """
    for file in (folder / "sketch.yaml", folder / ".vscode" / "arduino.json"):
        if file.is_file() and (match := _FQBN.search(file.read_text("utf-8", "replace"))):
            return file.name, match[1]
    return "", ""


def board_mcu(place: str, environment: str, given: str) -> Mcu:
    """Return the microcontroller of the board of a sketch at ``place``.

    A project of PlatformIO names it; a fully qualified name does so unless another than the
    default is ``given``. Raises InputError for a project's board that is not there.
    """
    path = Path(place).expanduser()
    if file := project_of(path) if place else None:
        return MCUS[project_mcu(read_project(file, environment), given)]
    _, fqbn = named_board(path if path.is_dir() else path.parent)
    of_file = _of_fqbn(fqbn) if place and given == DEFAULT_MCU else ""
    return MCUS[of_file or given]


def _of_fqbn(fqbn: str) -> str:
    """Return the microcontroller of PACKAGE:ARCHITECTURE:BOARD, '' for one that is not there."""
    _, architecture, board, *_ = [*fqbn.lower().split(":"), "", "", ""]
    if architecture == "avr":
        boards = {"mega": "atmega2560", "uno": "atmega328p", "nano": "atmega328p"}
        return boards.get(board, "")
    if architecture == "esp32":
        return next((f"esp32{each}" for each in ("s3", "c3") if each in board), "esp32")
    return ""
