"""Values of Python and NumPy as the files' readers take them."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any

from ..errors import InputError, unknown

if TYPE_CHECKING:
    from ..system.system import Engine

_DURATIONS = ("start", "stop", "step")


def as_written(value: Any) -> Any:
    """Return ``value`` as a TOML file would have it: NumPy's scalars and arrays as plain ones."""
    if hasattr(value, "tolist"):
        return value.tolist()
    if isinstance(value, (tuple, list)):
        return [as_written(element) for element in value]
    return str(value) if isinstance(value, Path) else value


def as_settings(given: Mapping[str, Any] | None) -> dict[str, Any]:
    """Return settings as a trial file would have them; durations may be numbers, in s."""
    settings = {key: as_written(value) for key, value in (given or {}).items()}
    return {k: as_duration(v) if k in _DURATIONS else v for k, v in settings.items()}


def as_duration(written: Any) -> Any:
    """Return a number of seconds as the text of a duration, anything else as it is."""
    written = as_written(written)
    is_number = isinstance(written, (int, float)) and not isinstance(written, bool)
    return f"{written!r} s" if is_number else written


def as_engine(name: str) -> Engine:
    """Return the engine ``name``. Raises InputError."""
    from ..system.system import ENGINES

    for engine in ENGINES:
        if name == engine:
            return engine
    raise InputError(unknown("engine", name, ENGINES))
