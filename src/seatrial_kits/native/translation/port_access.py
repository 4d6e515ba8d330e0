"""Ports of a component in its C: read, and given values as Python converts them."""

from __future__ import annotations

from typing import Any

from seatrial.model.ports import Parameter, Port

from ..tables import is_built_in, words_of
from .domain import Choice, Known, OtherText, Seq, described
from .expressions import storable, unpacked
from .frame import Frame
from .operations import is_number, truth


def read(frame: Frame, port: Port) -> Any:
    """Return the value of a port of the component."""
    cls, example = frame.unit.cls, frame.unit.example
    if is_built_in(cls, port):
        return Known(getattr(example, port.name))
    references = range(port.offset, port.offset + port.size)
    if port.type is str:
        words = words_of(port)
        texts = [s.port.name for s in cls.scalars if _is_text_input(s.port)]
        if not words or port.name not in texts:
            raise frame.refused(f"the text {port.name}")
        word = frame.num("b", f"self->state.words[{texts.index(port.name)}]")
        return Choice(word.text, (*map(Known, words), OtherText(words)))
    reading = {float: "V[{}]", int: "(long long)V[{}]", bool: "V[{}] != 0"}[port.type]
    kind = {float: "d", int: "i", bool: "b"}[port.type]
    values = [frame.num(kind, reading.format(r)) for r in references]
    return values[0] if port.axes is None else Seq(tuple, values, fresh=False)


def publish(frame: Frame, port: Port, value: Any) -> None:
    """Give an output its value."""
    if isinstance(port, Parameter) or port.kind != "output":
        raise frame.refused(f"an assignment to {port.name}, which is no output,")
    if port.type is str:
        raise frame.refused(f"the text {port.name}")
    if port.axes is not None and is_number(value):
        value = Seq(tuple, [value] * port.size)
    values = [value] if port.axes is None else unpacked(frame, storable(frame, value))
    if len(values) != port.size:
        raise frame.refused(f"{len(values)} values for the {port.size} of {port.name}")
    for at, each in enumerate(values):
        text = _converted(frame, port, each)
        frame.emit(f"V[{port.offset + at}] = {text};")


def _converted(frame: Frame, port: Port, value: Any) -> str:
    """Return what a port holds, as Python converts it."""
    if isinstance(value, Choice):
        return frame.text_of(
            frame.each(value, lambda one: frame.num("d", _converted(frame, port, one)))
        )
    if not is_number(value):
        raise frame.mismatched(f"{described(value)} as {port.name}", value)
    if port.type is bool:
        return frame.text_of(truth(frame, value), "d")
    if port.type is int:
        return f"integer(self, {frame.text_of(value, 'd')}, {frame.place()})"
    return frame.text_of(value, "d")


def _is_text_input(port: Port) -> bool:
    return port.kind == "input" and port.type is str
