"""Parameters of a node that others read and set over the bus."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

from dronecan.transport import get_active_union_field

from seatrial.errors import InputError

from .codec import protocol

GetSet: Any = protocol.param.GetSet
ExecuteOpcode: Any = protocol.param.ExecuteOpcode
_Value: Any = protocol.param.Value
_NumericValue: Any = protocol.param.NumericValue

Value = int | float | str


@dataclass(frozen=True)
class Setting:
    """A parameter: its type is that of its default. Limits are for numbers, ``check`` for texts."""

    name: str
    default: Value
    low: float = 0.0
    high: float = 0.0
    check: Callable[[str], object] | None = None

    @property
    def field(self) -> str:
        """Field of the union on the bus that carries it."""
        kind = type(self.default)
        return {int: "integer_value", float: "real_value", str: "string_value"}[kind]

    def accepts(self, value: Value) -> bool:
        """Return whether it may have this value."""
        if isinstance(value, str):
            try:
                if self.check is not None:
                    self.check(value)
            except InputError:
                return False
            return True
        return self.low <= value <= self.high


class ParameterServer:
    """Serves param.GetSet and param.ExecuteOpcode.

    A view of ``memory``, a dict that belongs to the component's state: what was set, and what
    was saved. A value of another type or beyond the limits is not taken, and the answer has the
    one that stays. Reals are float32 on the bus; they are kept to six decimals.

    SAVE keeps what is set through a restart of the node, for the run; ERASE forgets it and
    brings back the defaults at once.
    """

    def __init__(self, memory: dict[str, Any], settings: Sequence[Setting]) -> None:
        self._settings = {setting.name: setting for setting in settings}
        self._saved: dict[str, Value] = memory.setdefault("saved", {})
        self._set: dict[str, Value] = memory.setdefault("set", {})

    def restart(self) -> None:
        """Forget what was not saved."""
        self._set.clear()
        self._set.update(self._saved)

    def value(self, name: str) -> Any:
        """Return a parameter as it is now."""
        setting = self._settings[name]
        return self._set.get(name, setting.default)

    def answer(self, request: Any) -> Any:
        """Return the response to a request of either service."""
        return self._execute(request) if request._type is ExecuteOpcode else self._get_set(request)

    def _get_set(self, request: Any) -> Any:
        response = GetSet.Response()
        setting = self._requested(request)
        if setting is None:
            return response
        field = get_active_union_field(request.value)
        if field == setting.field:
            value = _read(request.value, field)
            if setting.accepts(value):
                self._set[setting.name] = value
        response.name = setting.name
        response.value = _Value(**{setting.field: self.value(setting.name)})
        response.default_value = _Value(**{setting.field: setting.default})
        if not isinstance(setting.default, str):
            kind = type(setting.default)
            response.min_value = _NumericValue(**{setting.field: kind(setting.low)})
            response.max_value = _NumericValue(**{setting.field: kind(setting.high)})
        return response

    def _requested(self, request: Any) -> Setting | None:
        name = _text(request.name)
        if name:
            return self._settings.get(name)
        among = list(self._settings.values())
        return among[request.index] if request.index < len(among) else None

    def _execute(self, request: Any) -> Any:
        response = ExecuteOpcode.Response()
        if request.opcode == request.OPCODE_SAVE:
            self._saved.update(self._set)
        elif request.opcode == request.OPCODE_ERASE:
            self._saved.clear()
            self._set.clear()
        else:
            return response
        response.ok = True
        return response


def _read(value: Any, field: str) -> Value:
    if field == "string_value":
        return _text(value.string_value)
    if field == "real_value":
        return round(float(value.real_value), 6)  # float32: 0.1 would come as 0.10000000149
    return int(value.integer_value)


def _text(characters: Any) -> str:
    return bytes(characters).decode("ascii", "replace")
