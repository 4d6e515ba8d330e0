"""Faults as a text: what the input ``fault`` of a device takes.

A name alone (``off``), or the fault of a measurement with its settings::

    bias of=position_n value=3,0,0 at=12.5 grows_over=10

with numbers in the unit of what is measured, ``at`` the time at which it began, s.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from functools import lru_cache

from ...errors import InputError, unknown
from .catalogue import FAILURES, KINDS

MEASURED = tuple(name for name, kind in KINDS.items() if "measurement" in kind.on)
"""Faults of what a sensor measures."""


@dataclass(frozen=True)
class Written:
    """A fault of a device, read."""

    what: str
    of: str = ""
    settings: Mapping[str, tuple[float, ...]] = field(default_factory=dict)
    at: float = 0.0
    grows_over: float = 0.0


def fault_text(
    what: str, of: str, settings: Mapping[str, Sequence[float]], at: float, grows_over: float = 0.0
) -> str:
    """Return the text of a fault of a measurement."""
    parts = [f"{key}={','.join(repr(v) for v in values)}" for key, values in settings.items()]
    grows = [f"grows_over={grows_over!r}"] if grows_over else []
    return " ".join([what, f"of={of}", *parts, f"at={at!r}", *grows])


@lru_cache(256)
def read_text(text: str) -> Written:
    """Return the fault that a text means. Raises InputError."""
    what, *parts = text.split(" ")
    if not parts:
        if what not in ("none", *FAILURES):
            raise InputError(unknown("fault", what, ("none", *FAILURES, *MEASURED)))
        return Written(what)
    if what not in MEASURED:
        raise InputError(f"{unknown('fault of a measurement', what, MEASURED)}, in {text!r}")
    found = dict(part.partition("=")[::2] for part in parts)
    try:
        numbers = {
            key: tuple(float(each) for each in value.split(","))
            for key, value in found.items()
            if key != "of"
        }
        if not all(math.isfinite(each) for values in numbers.values() for each in values):
            raise ValueError
    except ValueError:
        raise InputError(
            f"{text!r} is no fault such as 'bias of=heading value=0.1 at=12'"
        ) from None
    (at,), (grows,) = numbers.pop("at", (0.0,))[:1], numbers.pop("grows_over", (0.0,))[:1]
    needed = [key for key in KINDS[what].settings if key not in ("every", "wraps")]
    if "of" not in found or set(numbers) != set(needed):
        raise InputError(f"{text!r}: {what} needs of, {', '.join(needed)}")
    return Written(what, found["of"], numbers, at, grows)
