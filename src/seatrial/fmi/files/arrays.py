"""Values for one call of FMI 3.0, which reads or sets all elements of the arrays it names."""

from __future__ import annotations

import ctypes
from collections.abc import Callable, Mapping, Sequence
from typing import Any

from fmpy.fmi3 import fmi3Binary, fmi3Byte

from ...links.text import packed, unpacked
from ..instance import Variable
from .variables import Array

_CTYPES: dict[str, Any] = {
    "Float32": ctypes.c_float,
    "Float64": ctypes.c_double,
    "Boolean": ctypes.c_bool,
    "String": ctypes.c_char_p,
    "Binary": fmi3Binary,
    **{
        f"{sign}Int{bits}": getattr(ctypes, f"c_{sign.lower()}int{bits}")
        for sign in ("", "U")
        for bits in (8, 16, 32, 64)
    },
}


class ArrayCall:
    """The C arrays of a call that reads or sets some elements of some variables of one type.

    ``arguments`` are those of FMI's get and set functions after the instance.
    """

    def __init__(
        self, variables: Sequence[Variable], fmi_type: str, arrays: Mapping[int, Array]
    ) -> None:
        references = list(dict.fromkeys(v.reference for v in variables))
        self.spans: dict[int, slice] = {}
        """Where the elements of each value reference are."""
        size = 0
        for reference in references:
            count = len(arrays[reference].elements)
            self.spans[reference] = slice(size, size + count)
            size += count
        self.places = [self.spans[v.reference].start + v.element for v in variables]
        """Where each of the variables is."""
        self.is_whole = self.places == list(range(size))
        """All elements, in their order."""
        self.size = size
        self._own = (_CTYPES[fmi_type] * size)()
        vr = (ctypes.c_uint * len(references))(*references)
        self._sizes = (ctypes.c_size_t * size)()
        sizes = (self._sizes,) if fmi_type == "Binary" else ()
        self.arguments: tuple[Any, ...] = (vr, len(references), *sizes, self._own, size)
        self.fill: Callable[[Sequence[Any]], None] = self._fill
        self._all: Callable[[], list[Any]] = lambda: self._own[:]
        if fmi_type == "String":
            self.fill, self._all = self._fill_texts, self._texts
        elif fmi_type == "Binary":
            self.fill, self._all = self._fill_bytes, self._bytes
        self._are_texts = [v.type is str for r in references for v in arrays[r].elements]
        """Of a Binary: those that are ports of bytes, which are text here."""

    def values(self) -> list[Any]:
        """Return what was read, in the order of the variables."""
        everything = self._all()
        return everything if self.is_whole else [everything[place] for place in self.places]

    def _fill(self, values: Sequence[Any]) -> None:
        """Take the values of all elements."""
        self._own[:] = values

    def _fill_texts(self, values: Sequence[str]) -> None:
        self._own[:] = [text.encode() for text in values]

    def _texts(self) -> list[str]:
        return [(text or b"").decode("utf-8", "replace") for text in self._own]

    def _fill_bytes(self, values: Sequence[Any]) -> None:
        for i, given in enumerate(values):
            value = packed(given) if self._are_texts[i] else given
            buffer = (fmi3Byte * max(1, len(value))).from_buffer_copy(value or b"\0")
            self._own[i] = buffer  # ctypes keeps the buffer as long as the pointer to it
            self._sizes[i] = len(value)

    def _bytes(self) -> list[Any]:
        found = [
            ctypes.string_at(pointer, size) if pointer and size else b""
            for pointer, size in zip(self._own, self._sizes, strict=True)
        ]
        pairs = zip(found, self._are_texts, strict=True)
        return [unpacked(value) if is_text else value for value, is_text in pairs]
