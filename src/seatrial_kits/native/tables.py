"""Tables of C that every native component has: its variables, by value reference."""

from __future__ import annotations

import itertools
import json
from collections.abc import Sequence

from seatrial.model.component import Component, Parameter
from seatrial.model.faults.catalogue import FAILURES
from seatrial.model.plant import Plant
from seatrial.model.ports import Input, Port, ScalarPort

_HEADER = """\
/* Sizes and tables of a component: by value reference, and what is its own. */
#include <math.h>

#define MODEL_GUID "{guid}"
enum {{ SCALARS = {scalars}, TEXTS = {texts}, CHECKED = {checked} }};
enum {{ INPUT, FIXED, TUNABLE, BUILT_IN, OUTPUT }};
enum {{ REAL, INTEGER, BOOLEAN, STRING }};

extern const double model_starts[], model_lows[], model_highs[];
extern const int model_kinds[], model_types[], model_checked[], model_text_inputs[];
extern const int model_first_words[];
extern const char *const model_words[];
extern const char *const model_names[], *const model_units[], *const model_texts[];
extern const char *const model_type_names[];

{own}"""

_TYPES = {float: "REAL", int: "INTEGER", bool: "BOOLEAN", str: "STRING"}


WEATHER_ROLES = ("sea", "current", "wind")
BUILT_IN_ROLES = (*WEATHER_ROLES, "file", "run-folder")
"""Roles of parameters whose values are built in."""


def is_built_in(cls: type[Component], port: Port, *, surrounded: bool = False) -> bool:
    """Return whether a native FMU has a value of this port built in.

    A plant that is ``surrounded`` by weather takes its numbers at the start of each run.
    """
    if not isinstance(port, Parameter):
        return False
    # A plant's equations know nothing of what has a role: seas, currents, winds.
    by_role = bool(port.role) if issubclass(cls, Plant) else port.role in BUILT_IN_ROLES
    by_role = by_role and not (surrounded and port.role in WEATHER_ROLES)
    return port.type is str or by_role or port.name in cls.structural


def words_of(port: Port) -> tuple[str, ...]:
    """Return the texts that an input knows; what only begins with one of a fault is none."""
    if not isinstance(port, Input):
        return ()
    return ("none", *FAILURES) if port.role == "fault" else port.choices


def header(component: Component, guid: str, own: str) -> str:
    """Return ``model.h``; ``own`` is what only this kind of component has."""
    return _HEADER.format(
        guid=guid,
        scalars=len(component.scalars),
        texts=len(_text_inputs(component)),
        checked=len(_checked(component)),
        own=own,
    )


def tables(component: Component, *, surrounded: bool = False) -> str:
    """Return the tables of C of a component's variables, with its values as starts.

    `is_built_in` says what ``surrounded`` is.
    """
    scalars, values = component.scalars, component.values
    texts = [s.port.type is str for s in scalars]
    lows, highs = ([_limit(s, which) for s in scalars] for which in ("min", "max"))
    numbers = [
        "0.0" if text else repr(float(values[s.reference]))
        for s, text in zip(scalars, texts, strict=True)
    ]
    own = [
        quoted(values[s.reference] if text else "") for s, text in zip(scalars, texts, strict=True)
    ]
    inputs = [component.scalars[int(r)].port for r in _text_inputs(component)]
    words = [words_of(port) for port in inputs]
    firsts = [str(n) for n in itertools.accumulate((len(each) for each in words), initial=0)]
    return "\n".join(
        [
            table("int", "first_words", firsts),
            table("char *const", "words", [quoted(w) for each in words for w in each]),
            table("double", "starts", numbers),
            table("double", "lows", lows),
            table("double", "highs", highs),
            table("int", "kinds", [_kind(component, s, surrounded) for s in scalars]),
            table("int", "types", [_TYPES[s.port.type] for s in scalars]),
            table("int", "checked", _checked(component)),
            table("int", "text_inputs", _text_inputs(component)),
            table("char *const", "names", [quoted(s.name) for s in scalars]),
            table("char *const", "units", [quoted(s.unit) for s in scalars]),
            table("char *const", "texts", own),
            table("char *const", "type_names", [quoted(n.capitalize()) for n in _TYPES.values()]),
            "",
        ]
    )


def table(kind: str, name: str, cells: Sequence[str]) -> str:
    """Return a table of C."""
    rows = ",\n    ".join(cells or ["0"])
    return f"const {kind} model_{name}[] = {{\n    {rows}\n}};"


def _kind(component: Component, scalar: ScalarPort, surrounded: bool) -> str:
    port = scalar.port
    if not isinstance(port, Parameter):
        return port.kind.upper()
    if is_built_in(type(component), port, surrounded=surrounded):
        return "BUILT_IN"
    return "TUNABLE" if port.tunable else "FIXED"


def _limit(scalar: ScalarPort, which: str) -> str:
    port = scalar.port
    value = port.limit(which, scalar.index) if isinstance(port, Parameter) else None  # type: ignore[arg-type]
    if value is None:
        return "-INFINITY" if which == "min" else "INFINITY"
    return repr(float(value)).replace("inf", "INFINITY")


def _checked(component: Component) -> list[str]:
    reals = [s for s in component.scalars if s.port.kind == "output" and s.port.type is float]
    return [str(s.reference) for s in reals]


def _text_inputs(component: Component) -> list[str]:
    texts = [s for s in component.scalars if s.port.kind == "input" and s.port.type is str]
    return [str(s.reference) for s in texts]


def quoted(text: str) -> str:
    """Return a C string: JSON escapes as C does, and other characters are bytes in octal."""
    return "".join(
        c if ord(c) < 128 else "".join(f"\\{byte:03o}" for byte in c.encode())
        for c in json.dumps(text, ensure_ascii=False)
    )
