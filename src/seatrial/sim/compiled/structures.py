"""The structures of `master.c`, field by field."""

from __future__ import annotations

from collections.abc import Mapping
from ctypes import POINTER, Structure, c_double, c_int32, c_int64, c_uint8, c_uint32, c_void_p
from dataclasses import dataclass
from typing import ClassVar

WRITE, STEP, GET, STORE, ARRIVE, LOOP, CALL = range(7)
"""Kinds of operations."""
REAL, INTEGER, BOOLEAN = range(3)
"""Types of values."""
DONE, ANSWERED, EXCESS, UNSETTLED, CALLED, DIVERGED, ASKED = range(7)
"""Why it returned."""


class Times(Structure):
    """Durations of one component's steps, in ns."""

    _fields_: ClassVar = [
        ("count", c_int64),
        ("total_ns", c_int64),
        ("longest_ns", c_int64),
        ("longest_at_ns", c_int64),
        ("bins", c_int64 * 64),
    ]


class Operation(Structure):
    """One operation of a step."""

    _fields_: ClassVar = [
        ("kind", c_int64),
        ("type", c_int64),
        ("every", c_int64),
        ("phase", c_int64),
        ("mark", c_int64),
        ("function", c_void_p),
        ("component", c_void_p),
        ("references", POINTER(c_uint32)),
        ("values", c_void_p),
        ("count", c_int64),
        ("start", c_int64),
        ("length", c_int64),
        ("constant", c_int32),
        ("never_back", c_int32),
        ("times", POINTER(Times)),
        ("places", POINTER(c_int64)),
        ("numbers", POINTER(c_double)),
        ("scaled", c_int64),
        ("which", POINTER(c_int64)),
        ("factors", POINTER(c_double)),
        ("offsets", POINTER(c_double)),
        ("continuous", c_int64),
        ("moving", POINTER(c_int64)),
        ("previous", POINTER(c_double)),
        ("has_previous", c_int64),
        ("limited", c_int64),
        ("bounded", POINTER(c_int64)),
        ("limits", POINTER(c_double)),
        ("reals", POINTER(c_uint8)),
        ("relaxation", c_double),
    ]


class Pace(Structure):
    """What the watch for divergence has seen of connections of one step."""

    _fields_: ClassVar = [
        ("every", c_int64),
        ("count", c_int64),
        ("places", c_void_p),
        ("rows", c_void_p),
        ("last", c_void_p),
        ("first", c_void_p),
        ("jump", c_void_p),
        ("growing", c_void_p),
        ("seen", c_void_p),
        ("worst", c_int64),
    ]


class Master(Structure):
    """The operations of a step, the signals, and how far it is."""

    _fields_: ClassVar = [
        ("operations", POINTER(Operation)),
        ("count", c_int64),
        ("at", c_int64),
        ("signals", POINTER(c_double)),
        ("steps", c_int64),
        ("begin_ns", c_int64),
        ("step_ns", c_int64),
        ("time_ns", c_int64),
        ("status", c_int64),
        ("took_ns", c_int64),
        ("said", POINTER(c_int32)),
        ("cells", c_void_p),
        ("times", c_void_p),
        ("paces", POINTER(Pace)),
        ("pace_count", c_int64),
        ("diverged", c_int64),
        ("rows", POINTER(c_double)),
        ("row_places", POINTER(c_int64)),
        ("row_count", c_int64),
        ("row_every", c_int64),
        ("rows_kept", c_int64),
        ("any_quantity", c_double),
        ("overridden", c_void_p),
        ("overrides", c_void_p),
        ("own", c_void_p),
    ]


@dataclass(frozen=True)
class Marks:
    """Cells in memory, and what stands in the second of them while one component is in a call.

    The first cell asks for a stop unless it is 0; the third has the time of a step, s, as a double.
    """

    CALLS: ClassVar = ("write", "step", "read")

    address: int
    codes: Mapping[str, int]
    """By call, of `CALLS`."""
