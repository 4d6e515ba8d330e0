"""Messages that the page of a viewer may send: viser keeps whatever can be decoded."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from typing import Any, get_type_hints

import msgspec
import viser
from viser import _messages as messages

_LONGEST = 100_000
"""Bytes of a message."""
_LONGEST_TEXT = 10_000
_LARGEST = 1e15
_TYPES = {
    one.__name__: msgspec.defstruct(
        one.__name__,
        [(key, hint) for key, hint in get_type_hints(one).items() if key in one.__annotations__],
    )
    for one in (
        messages.ViewerCameraMessage,
        messages.GuiUpdateMessage,
        messages.CommandTriggerMessage,
    )
}
"""What the widgets and the scene of these pages send; nothing is uploaded, shared or asked for."""
_CAMERA, _UPDATE = _TYPES["ViewerCameraMessage"], _TYPES["GuiUpdateMessage"]


def fits(raw: Any, find: Callable[[str], Any]) -> bool:
    """Say if a message is one of the page's, with values that its widget has.

    ``find`` returns a widget by its identifier, or None: one that has gone just then is no mistake.
    """
    if not isinstance(raw, bytes) or len(raw) > _LONGEST:
        return False
    try:
        content = msgspec.msgpack.decode(raw)
        form = _TYPES[content.pop("type")]
        message: Any = msgspec.convert(content, form)
    except (msgspec.MsgspecError, KeyError, TypeError, AttributeError, RecursionError):
        return False
    if set(content) != set(form.__struct_fields__):
        return False
    if form is _CAMERA:
        return all(abs(number) <= _LARGEST for number in _numbers(content.values()))
    if form is _UPDATE:
        widget = find(message.uuid)
        return list(message.updates) == ["value"] and (
            widget is None or _is_of(widget, message.updates["value"])
        )
    return True


def _numbers(values: Any) -> Iterator[float]:
    """Yield numbers, and those in lists; NaN as infinite."""
    for value in values:
        if isinstance(value, list):
            yield from _numbers(value)
        else:
            yield math.inf if math.isnan(value) else value


def _is_of(widget: Any, value: Any) -> bool:
    """Say if a value is one that a widget can have."""
    match widget:
        case viser.GuiDropdownHandle() | viser.GuiButtonGroupHandle():
            return isinstance(value, str) and value in widget.options
        case viser.GuiSliderHandle():
            slack = 1e-6 * (widget.max - widget.min)
            return _is_number(value) and widget.min - slack <= value <= widget.max + slack
        case viser.GuiNumberHandle():
            return _is_number(value)
        case viser.GuiCheckboxHandle() | viser.GuiButtonHandle():
            return isinstance(value, bool)
        case viser.GuiTextHandle():
            return isinstance(value, str) and len(value) <= _LONGEST_TEXT
    return False


def _is_number(value: Any) -> bool:
    return type(value) in (int, float) and abs(value) <= _LARGEST
