"""Limits of a run: wall time and memory beyond which its process is ended."""

from __future__ import annotations

import math
from collections.abc import Mapping
from pathlib import Path
from typing import Annotated, Any

from pydantic import AfterValidator
from pydantic_core import PydanticCustomError

from ...errors import InputError
from ...system.files import FileModel, validated
from ...system.rig import duration_ns

NONE = "none"
"""Written in the place of a limit that is not to be."""
_BYTES = {"B": 1, "kB": 10**3, "MB": 10**6, "GB": 10**9, "KiB": 2**10, "MiB": 2**20, "GiB": 2**30}


def _duration(written: str) -> str:
    try:
        long_enough = written == NONE or duration_ns(written, "") > 0
    except InputError:
        long_enough = False
    if not long_enough:
        needed = 'A time above 0 such as "60 s", or "none", is needed'
        raise PydanticCustomError("limit", needed)
    return written


def _size(written: str) -> str:
    if not _bytes(written) > 0:
        known = ", ".join(_BYTES)
        needed = 'A size above 0 such as "1 GB", or "none", is needed; units are {known}'
        raise PydanticCustomError("limit", needed, {"known": known})
    return written


def _bytes(written: str) -> float:
    """Return a size in bytes; NaN for a text that is none."""
    if written == NONE:
        return math.inf
    number, _, unit = written.strip().partition(" ")
    try:
        return float(number) * _BYTES[unit.strip()]
    except (ValueError, KeyError):
        return math.nan


_Duration = Annotated[str, AfterValidator(_duration)]


class LimitEntry(FileModel):
    """Limits of a run; its process is ended beyond one of them, and the run has failed."""

    wall: _Duration = NONE
    """Wall time from the run's begin, with the loading of its components."""
    memory: Annotated[str, AfterValidator(_size)] = NONE
    """Resident memory of the run's process, and of those that it starts, beyond what was before."""
    call: _Duration | None = None
    """Wall time of a call without progress; None: in real time 2 s in a step and 10 s at the end,
    else 60 s."""

    @property
    def is_of_run(self) -> bool:
        """Whether there is a limit of a whole run."""
        return self.wall != NONE or self.memory != NONE

    @property
    def wall_s(self) -> float:
        """Greatest wall time, s."""
        return _seconds(self.wall)

    @property
    def memory_bytes(self) -> float:
        """Most resident memory, bytes."""
        return _bytes(self.memory)

    @property
    def call_s(self) -> float | None:
        """Greatest wall time of a call without progress, s; None where none is written."""
        return None if self.call is None else _seconds(self.call)

    def with_(self, given: Mapping[str, Any], origin: str) -> LimitEntry:
        """Return the limits with some of them replaced. Raises InputError, naming ``origin``."""
        if not given:
            return self
        return validated(LimitEntry, {**self.model_dump(exclude_unset=True), **given}, Path(origin))


def limits_of(written: list[str], origin: str) -> dict[str, str]:
    """Return limits that a command line has as KEY=VALUE. Raises InputError, naming ``origin``."""
    given = {}
    for text in written:
        key, equals, value = text.partition("=")
        if not equals:
            raise InputError(f"{origin}: KEY=VALUE is needed, found {text!r}")
        given[key.strip()] = value.strip()
    LimitEntry().with_(given, origin)
    return given


def _seconds(written: str) -> float:
    return math.inf if written == NONE else duration_ns(written, "") * 1e-9
