"""Functions of the runtime in C: random numbers, faults, the sea that is built in."""

from __future__ import annotations

import zlib
from collections.abc import Callable
from typing import Any

from seatrial.devices.fault import Fallible
from seatrial.model.component import Noise
from seatrial.model.faults.catalogue import FAILURES
from seatrial.model.faults.text import MEASURED, Written
from seatrial.physics.sea.parameters import MeetsCurrent, MeetsWaves, MeetsWind

from .domain import (
    Choice,
    Draws,
    FaultValues,
    Known,
    Num,
    OtherText,
    Record,
    Seq,
    Table,
    Unconverted,
)
from .expressions import unpacked
from .frame import Frame
from .operations import is_known, python_of
from .shapes import opened

SETTINGS = ("value", "rate", "factor", "coefficients")
"""Settings of the faults of measurements, in the order of the runtime."""
FAULTS = ("none", *FAILURES, *MEASURED)

INTRINSICS: dict[Any, Callable[..., Any]] = {}
"""What a method of a base class becomes, with the frame and its arguments."""


def _generator(_frame: Frame, index: Any, stream: Any = None) -> Draws:
    return Draws([Known(0) if stream is None else stream, index])


INTRINSICS[Noise.generator] = _generator


def begun(frame: Frame, draws: Draws) -> str:
    """Return the C expression of where a generator is, which begins here if it has not."""
    if not draws.text:
        kind = zlib.crc32(frame.unit.cls.__name__.encode())
        name = frame.variable("g")
        frame.variables[-1] = ("Philox", name)
        draws.text = f"&{name}"
        stream, index = (frame.text_of(item, "i") for item in draws.items)
        seed = frame.text_of(frame.unit.attribute(frame, frame.unit.own, "seed"))
        frame.emit(f"begin_draws(self, {draws.text}, {seed}, {kind}u, {stream}, {index});")
    return draws.text


def drawn(frame: Frame, name: str, draws: Draws, arguments: list[Any]) -> Any:
    """Return what a method of a generator draws."""
    own = begun(frame, draws)

    frame.stores([""])  # a draw changes something, if no attribute

    def one() -> Num:
        return frame.num("d", f"drawn_{name}({own})")

    if name in ("random", "standard_normal"):
        if not arguments:
            return one()
        return Unconverted(Seq(list, [one() for _ in range(arguments[0].value)]))
    if name == "uniform":
        low, high = arguments
        if isinstance(opened(low), Seq):
            pairs = zip(unpacked(frame, low), unpacked(frame, high), strict=True)
            return Unconverted(Seq(list, [_between(frame, own, a, b) for a, b in pairs]))
        return _between(frame, own, low, high)
    if name == "integers" and len(arguments) == 2 and all(map(is_known, arguments)):
        low, high = map(python_of, arguments)
        if 0 < high - low < 2**32:
            return Unconverted(frame.num("i", f"drawn_integer({own}, {low}LL, {high}LL)"))
    raise frame.refused(f"the method {name} of a generator")


def _between(frame: Frame, draws: str, low: Any, high: Any) -> Num:
    a, b = frame.text_of(low, "d"), frame.text_of(high, "d")
    return frame.num("d", f"{a} + ({b} - {a}) * drawn_random({draws})")


def _written_fault(frame: Frame) -> Record:
    what = frame.num("b", "present_fault(self)")
    measured = tuple(port.name for port in getattr(frame.unit.cls, "measured", ()))
    names = ("", *measured)
    of = frame.num("b", "self->state.fault.of")
    fields = {
        "what": Choice(what.text, tuple(Known(name) for name in FAULTS)),
        "of": Choice(of.text, (*map(Known, names), OtherText(names))),
        "settings": Table({key: FaultValues(i) for i, key in enumerate(SETTINGS)}),
        "at": frame.num("d", "self->state.fault.at"),
        "grows_over": frame.num("d", "self->state.fault.grows_over"),
    }
    return Record(Written, fields)


INTRINSICS[Fallible.written_fault] = _written_fault


def _built_in(name: str) -> Callable[[Frame], Known]:
    def call(frame: Frame) -> Known:
        made: dict[str, Known] = frame.unit.made
        if name not in made:
            made[name] = Known(getattr(frame.unit.example, name)())
        return made[name]

    return call


for _cls, _name in (
    (MeetsWaves, "sea_state"),
    (MeetsCurrent, "current_state"),
    (MeetsWind, "wind_state"),
):
    INTRINSICS[getattr(_cls, _name)] = _built_in(_name)


def fault_value(frame: Frame, values: FaultValues, index: Any) -> Num:
    """Return one number of a fault's setting."""
    at = frame.text_of(index, "i")
    return frame.num(
        "d", f"self->state.settings[{values.key}][fault_index(self, {values.key}, {at})]"
    )
