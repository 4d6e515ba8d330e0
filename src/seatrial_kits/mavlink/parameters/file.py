"""Files of parameters: a name and a value per line, as ground stations write and read them."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from pathlib import Path

from seatrial.errors import InputError
from seatrial.files.whole_file import write_whole

Check = Callable[[str, float], float]
"""Returns a parameter's value as it is taken; raises InputError if it does not fit."""


class ParameterFile:
    """File of parameters set over the link, for later runs.

    Lines are ``NAME VALUE`` or ``NAME,VALUE``; ``#`` begins a comment. A file that is not there
    is one without lines. Raises InputError if its folder is not there.
    """

    def __init__(self, path: Path) -> None:
        if not path.parent.is_dir():
            raise InputError(f"parameter file {path}: there is no folder {path.parent}")
        self._path = path

    def read(self, check: Check) -> dict[str, float]:
        """Return the values by name, each as ``check`` takes it.

        Raises InputError, with the line, for what is no parameter of the vehicle, and for a file
        that cannot be read.
        """
        try:
            lines = self._path.read_text("utf-8").splitlines()
        except FileNotFoundError:
            return {}
        except (OSError, UnicodeDecodeError) as error:
            cause = error.strerror if isinstance(error, OSError) else "not UTF-8"
            raise InputError(f"parameter file {self._path}: {cause}") from None
        values: dict[str, float] = {}
        for number, line in enumerate(lines, 1):
            fields = line.partition("#")[0].replace(",", " ").split()
            if not fields:
                continue
            try:
                name, value = _entry(fields)
                if name in values:
                    raise InputError(f"{name} is there twice")
                values[name] = check(name, value)
            except InputError as error:
                raise InputError(f"{self._path}, line {number}: {error}") from None
        return values

    def write(self, values: Mapping[str, float]) -> None:
        """Write the file whole, or leave it as it was. Raises OSError."""
        lines = [f"{name:<16} {_written(value)}\n" for name, value in values.items()]
        write_whole(self._path, "".join(lines))


def _entry(fields: list[str]) -> tuple[str, float]:
    if len(fields) != 2:
        raise InputError(f"a name and a value are needed, found {' '.join(fields)!r}")
    name, written = fields
    try:
        value = float(written)
    except ValueError:
        value = math.nan
    if not math.isfinite(value):
        raise InputError(f"{name}: {written!r} is no number")
    return name, value


def _written(value: float) -> str:
    return str(int(value)) if value.is_integer() and abs(value) < 1e15 else repr(value)
