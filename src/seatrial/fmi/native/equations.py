"""C text of a plant: its equations, by CasADi, and the tables that `plant.c` reads."""

from __future__ import annotations

import json
from collections.abc import Sequence

import casadi as ca

from ...component import Component, Parameter
from ...errors import InputError, SimulationError
from ...plant import Plant
from ...ports import Port, ScalarPort

_HEADER = """\
/* Sizes and tables of a plant: by value reference, and the references of its vectors. */
#include <math.h>

#define MODEL_GUID "{guid}"
enum {{
    SCALARS = {scalars}, STATES = {x}, INPUTS = {u}, PARAMETERS = {p}, OUTPUTS = {y},
    MAX_STEP = {max_step}
}};
enum {{ INPUT, FIXED, TUNABLE, BUILT_IN, OUTPUT, TEXT }};

extern const double model_starts[], model_lows[], model_highs[];
extern const int model_kinds[], model_x[], model_x_start[], model_u[], model_p[], model_y[];
extern const char *const model_names[], *const model_units[], *const model_texts[];

void model_rk4(const double *x, const double *u, const double *p, double h, double *next);
void model_out(const double *x, const double *u, const double *p, double *y);
"""

_CALLS = """
void model_rk4(const double *x, const double *u, const double *p, double h, double *next) {{
    const double *arguments[{rk4_arg}] = {{x, u, p, &h}};
    double *results[{rk4_res}] = {{next}}, work[{rk4_w}];
    casadi_int places[{rk4_iw}];
    rk4(arguments, results, places, work, 0);
}}

void model_out(const double *x, const double *u, const double *p, double *y) {{
    const double *arguments[{out_arg}] = {{x, u, p}};
    double *results[{out_res}] = {{y}}, work[{out_w}];
    casadi_int places[{out_iw}];
    out(arguments, results, places, work, 0);
}}
"""

_OWN = ("step", "outputs", "_load", "_publish", "_compiled", "advance", "refresh")
"""Methods that `plant.c` has in C: who overrides one is another component."""


def why_python(cls: type[Component]) -> str:
    """Return why a component cannot be native, empty if it can."""
    if not issubclass(cls, Plant):
        return "it is no plant: equations alone become C"
    if any(p.type is not float and p.kind != "parameter" for p in cls.ports.values()):
        return "it has inputs of text"
    for name in _OWN:
        owner = next(each for each in cls.__mro__ if name in vars(each))
        # With nothing around them they run on the equations of `Plant`: `started` sees to it.
        if owner not in (Plant, Component) and owner.__name__ != "SurroundedPlant":
            return f"{owner.__name__}.{name} is more than equations"
    return ""


def started(plant: Plant, name: str) -> Plant:
    """Return the plant, started: all its checks are made with the values to build in.

    Raises InputError for a plant whose start does more than take its start values.
    """
    before = [plant.values[s.reference] for s in plant.scalars if s.port.kind == "parameter"]
    try:
        plant.setup(0.0)
        plant.initialise()
    except SimulationError as error:
        raise InputError(f"{name}: {error}") from None
    after = [plant.values[s.reference] for s in plant.scalars if s.port.kind == "parameter"]
    if before != after or any(
        p.role == "file" and getattr(plant, p.name) for p in plant.ports.values()
    ):
        raise InputError(f"{name}: parameters from a file cannot be built into a native FMU")
    if getattr(plant, "_around", None) is not None:
        raise InputError(
            f"{name}: a native FMU is built in still water and air, found waves, a current or "
            "wind among its parameters"
        )
    return plant


def header(plant: Plant, guid: str) -> str:
    """Return ``model.h``."""
    return _HEADER.format(
        guid=guid,
        scalars=len(plant.scalars),
        x=_size(plant.state_ports),
        u=_size(plant.input_ports),
        p=_size(plant.parameter_ports),
        y=_size(plant.output_ports),
        max_step=plant.ports["max_step"].offset,
    )


def model(plant: Plant) -> str:
    """Return ``model.c``: the equations with the text parameters' values, and the tables."""
    compiled = plant._compiled()
    generator = ca.CodeGenerator("model.c", {"with_header": False, "main": False})
    sizes = {}
    for function in (compiled.rk4, compiled.out):
        generator.add(function)
        for what in ("arg", "res", "iw", "w"):
            size = getattr(function, f"sz_{what}")()
            sizes[f"{function.name()}_{what}"] = max(1, size)
    return f'{generator.dump()}\n#include "model.h"\n{_CALLS.format(**sizes)}\n{_tables(plant)}'


def _tables(plant: Plant) -> str:
    scalars, values = plant.scalars, plant.values
    texts = [s.port.type is str for s in scalars]
    starts = [plant.ports[f"{p.name}_start"] for p in plant.state_ports]
    lows, highs = ([_limit(s, which) for s in scalars] for which in ("min", "max"))
    numbers = [
        "0.0" if text else repr(float(values[s.reference]))
        for s, text in zip(scalars, texts, strict=True)
    ]
    return "\n".join(
        [
            _table("double", "starts", numbers),
            _table("double", "lows", lows),
            _table("double", "highs", highs),
            _table("int", "kinds", [_kind(s) for s in scalars]),
            _table("int", "x", _references(plant.state_ports)),
            _table("int", "x_start", _references(starts)),
            _table("int", "u", _references(plant.input_ports)),
            _table("int", "p", _references(plant.parameter_ports)),
            _table("int", "y", _references(plant.output_ports)),
            _table("char *const", "names", [_quoted(s.name) for s in scalars]),
            _table("char *const", "units", [_quoted(s.unit) for s in scalars]),
            _table(
                "char *const",
                "texts",
                [
                    _quoted(values[s.reference] if text else "")
                    for s, text in zip(scalars, texts, strict=True)
                ],
            ),
            "",
        ]
    )


def _table(kind: str, name: str, cells: Sequence[str]) -> str:
    rows = ",\n    ".join(cells or ["0"])
    return f"const {kind} model_{name}[] = {{\n    {rows}\n}};"


def _kind(scalar: ScalarPort) -> str:
    port = scalar.port
    if port.type is str:
        return "TEXT"
    if not isinstance(port, Parameter):
        return port.kind.upper()
    if port.role:  # seas, currents, winds: the equations know of none
        return "BUILT_IN"
    return "TUNABLE" if port.tunable else "FIXED"


def _limit(scalar: ScalarPort, which: str) -> str:
    port = scalar.port
    value = port.limit(which, scalar.index) if isinstance(port, Parameter) else None  # type: ignore[arg-type]
    if value is None:
        return "-INFINITY" if which == "min" else "INFINITY"
    return repr(float(value)).replace("inf", "INFINITY")


def _references(ports: Sequence[Port]) -> list[str]:
    return [str(p.offset + i) for p in ports for i in range(p.size)]


def _size(ports: Sequence[Port]) -> int:
    return sum(port.size for port in ports)


def _quoted(text: str) -> str:
    """Return a C string: JSON escapes as C does, and other characters are bytes in octal."""
    return "".join(
        c if ord(c) < 128 else "".join(f"\\{byte:03o}" for byte in c.encode())
        for c in json.dumps(text, ensure_ascii=False)
    )
