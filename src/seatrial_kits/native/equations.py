"""C text of a plant: its equations, by CasADi, and the tables that `plant.c` reads."""

from __future__ import annotations

from collections.abc import Sequence

import casadi as ca

from seatrial.errors import InputError, SimulationError
from seatrial.model.component import Component
from seatrial.model.plant import Plant
from seatrial.model.ports import Port

from .tables import table, tables

_HEADER = """\
enum {{
    STATES = {x}, INPUTS = {u}, PARAMETERS = {p}, OUTPUTS = {y}, MAX_STEP = {max_step}
}};
extern const int model_x[], model_x_start[], model_u[], model_p[], model_y[];

typedef struct {{
    double x[STATES + 1];
}} Memory;

void model_rk4(const double *x, const double *u, const double *p, double h, double *next);
void model_out(const double *x, const double *u, const double *p, double *y);
void model_along(const double *x, const double *u, const double *p, const double *dx,
                 const double *du, const double *dp, double *dy);
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

void model_along(const double *x, const double *u, const double *p, const double *dx,
                 const double *du, const double *dp, double *dy) {{
    const double *arguments[{along_arg}] = {{x, u, p, dx, du, dp}};
    double *results[{along_res}] = {{dy}}, work[{along_w}];
    casadi_int places[{along_iw}];
    along(arguments, results, places, work, 0);
}}
"""

_OWN = ("step", "outputs", "_load", "_publish", "compiled", "advance", "refresh")
"""Methods that `plant.c` has in C: who overrides one is another component."""


def why_python(plant: type[Plant]) -> str:
    """Return why a plant cannot be native, empty if it can."""
    if any(p.type is not float and p.kind != "parameter" for p in plant.ports.values()):
        return "it has inputs of text"
    for name in _OWN:
        owner = next(each for each in plant.__mro__ if name in vars(each))
        # With nothing around them they run on the equations of `Plant`: `require_start` sees to it.
        if owner not in (Plant, Component) and owner.__name__ != "SurroundedPlant":
            return f"{owner.__name__}.{name} is more than equations"
    return ""


def require_start(plant: Plant, name: str) -> None:
    """Start a plant, which makes all its checks.

    Raises InputError for values that it cannot start with, and for a plant whose start does more
    than take its start values.
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


def header(plant: Plant) -> str:
    """Return what ``model.h`` has of a plant."""
    return _HEADER.format(
        x=_size(plant.state_ports),
        u=_size(plant.input_ports),
        p=_size(plant.parameter_ports),
        y=_size(plant.output_ports),
        max_step=plant.ports["max_step"].offset,
    )


def model(plant: Plant) -> str:
    """Return ``model.c``: the equations with the text parameters' values, and the tables."""
    compiled = plant.compiled()
    generator = ca.CodeGenerator("model.c", {"with_header": False, "main": False})
    sizes = {}
    for function in (compiled.rk4, compiled.out, _along(compiled.out)):
        generator.add(function)
        for what in ("arg", "res", "iw", "w"):
            size = getattr(function, f"sz_{what}")()
            sizes[f"{function.name()}_{what}"] = max(1, size)
    starts = [plant.ports[f"{p.name}_start"] for p in plant.state_ports]
    own = [
        table("int", "x", _references(plant.state_ports)),
        table("int", "x_start", _references(starts)),
        table("int", "u", _references(plant.input_ports)),
        table("int", "p", _references(plant.parameter_ports)),
        table("int", "y", _references(plant.output_ports)),
    ]
    common = tables(plant)
    text = f'{generator.dump()}\n#include "component.h"'
    return "\n".join([text, _CALLS.format(**sizes), *own, common])


def _along(out: ca.Function) -> ca.Function:
    """Return the derivative of outputs along a direction of state, inputs and parameters."""
    at = [ca.SX.sym(name, out.size1_in(i)) for i, name in enumerate("xup")]
    direction = [ca.SX.sym(f"d{name}", out.size1_in(i)) for i, name in enumerate("xup")]
    result = ca.jtimes(out(*at), ca.vertcat(*at), ca.vertcat(*direction))
    return ca.Function("along", [*at, *direction], [result])


def _references(ports: Sequence[Port]) -> list[str]:
    return [str(p.offset + i) for p in ports for i in range(p.size)]


def _size(ports: Sequence[Port]) -> int:
    return sum(port.size for port in ports)
