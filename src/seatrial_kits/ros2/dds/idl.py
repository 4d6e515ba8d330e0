"""Types of the package cyclonedds, made at run time from the definitions of messages.

DDS gets names and fields. Samples are written as bytes (`packing`), and read by rosbags.
"""

from __future__ import annotations

from functools import cache
from typing import Any

from ..messages.definitions import dds_name, type_store

_BASES = {
    "bool": "bool", "byte": "uint8", "char": "uint8", "octet": "uint8",
    "float32": "float32", "float64": "float64",
    **{f"{sign}int{bits}": f"{sign}int{bits}" for sign in ("", "u") for bits in (8, 16, 32, 64)},
}  # fmt: skip


@cache
def sample_type(kind: str) -> Any:
    """Return the class of a topic's samples.

    One that is written has the bytes of its message, plain CDR; one that is read the ``message``
    of rosbags, None where its bytes are no such message.
    """
    store, made = type_store(), _struct(kind)

    def start(self: Any, message: Any) -> None:
        self.message = message

    def serialize(self: Any, **_: Any) -> bytes:
        written: bytes = self.message
        return written

    def deserialize(cls: Any, data: bytes, /, **_: Any) -> Any:
        try:
            return cls(store.deserialize_cdr(data, kind))
        except Exception:  # whatever rosbags makes of bytes that are no message: counted
            return cls(None)

    made.__init__, made.serialize = start, serialize
    made.deserialize = classmethod(deserialize)
    made.deserialize_key = classmethod(lambda cls, data, **_: cls(None))
    return made


def _struct(kind: str) -> Any:
    from cyclonedds.idl import make_idl_struct

    _, fields = type_store().fielddefs[kind]
    name = kind.rpartition("/")[2]
    return make_idl_struct(
        name, dds_name(kind), {field: _field(entry) for field, entry in fields}, dataclassify=False
    )


@cache
def _nested(kind: str) -> Any:
    return _struct(kind)


def _field(entry: Any) -> Any:
    from cyclonedds.idl import types as declared
    from rosbags.interfaces import Nodetype

    types: Any = declared
    sort, what = entry
    if sort == Nodetype.NAME:
        return _nested(what)
    if sort == Nodetype.BASE:
        base, bound = what
        if base in ("string", "wstring"):
            return types.bounded_str[bound] if bound else str
        return bool if base == "bool" else getattr(types, _BASES[base])
    inner, size = what
    element = _field(inner)
    if sort == Nodetype.ARRAY:
        return types.array[element, size]
    return types.sequence[element, size] if size else types.sequence[element]
