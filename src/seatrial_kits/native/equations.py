"""C text of a plant: its equations, by CasADi, and the tables that `plant.c` reads."""

from __future__ import annotations

from collections.abc import Sequence

import casadi as ca

from seatrial.errors import InputError, SimulationError
from seatrial.model.component import Component
from seatrial.model.plant import Plant
from seatrial.model.ports import Port
from seatrial.physics.craft.surrounded import SurroundedPlant

from .lanes import lanes
from .tables import table, tables

_HEADER = """\
#define AROUND {around}
enum {{
    STATES = {x}, INPUTS = {u}, PARAMETERS = {p}, OUTPUTS = {y}, MAX_STEP = {max_step}
}};
extern const int model_x[], model_x_start[], model_u[], model_p[], model_y[];

typedef struct {{
    double x[STATES + 1];
#if AROUND
    int among;                 /* whether anything surrounds it in this run */
    double around[AROUND];     /* at the end of the last step */
    double before[STATES + 1]; /* the states before that step */
    double met[4][AROUND];     /* evaluations of what surrounds the plant */
    double span;               /* the step, s, */
    long long count;           /* its sub-steps, */
    long long steps, done;     /* steps between the last two evaluations, and those taken */
#endif
}} Memory;
#define TOUCHED ((STATES + 2) * sizeof(double)) /* more among waves, current and wind alone */

{functions}
"""

_STILL = {
    "rk4": ("x", "u", "p", "h"),
    "out": ("x", "u", "p"),
    "along": ("x", "u", "p", "dx", "du", "dp"),
}
"""Functions of a plant by their arguments; all but the time step are arrays."""
_AMONG = {
    "rates": ("x", "u", "p"),
    "between": ("x", "u0", "u", "u1", "p", "h"),
    "out_among": _STILL["out"],
    "along_among": _STILL["along"],
}
"""Those of a plant among waves, current and wind beside them."""

_OWN = ("step", "outputs", "_load", "_publish", "compiled", "advance", "refresh")
"""Methods that `plant.c` has in C: who overrides one is another component."""


def why_python(plant: type[Plant]) -> str:
    """Return why a plant cannot be native, empty if it can."""
    if any(p.type is not float and p.kind != "parameter" for p in plant.ports.values()):
        return "it has inputs of text"
    for name in _OWN:
        owner = next(each for each in plant.__mro__ if name in vars(each))
        if owner not in (Plant, Component, SurroundedPlant):
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


def header(plant: Plant, surrounded: bool) -> str:
    """Return what ``model.h`` has of a plant; `model` says what ``surrounded`` is."""
    return _HEADER.format(
        around=_size(plant.surrounding_ports) if surrounded else 0,  # type: ignore[attr-defined]
        x=_size(plant.state_ports),
        u=_size(plant.input_ports),
        p=_size(plant.parameter_ports),
        y=_size(plant.output_ports),
        max_step=plant.ports["max_step"].offset,
        functions="\n".join(f"{_declared(*each)};" for each in _functions(surrounded).items()),
    )


def model(plant: Plant, surrounded: bool) -> str:
    """Return ``model.c``: the equations with the text parameters' values, and the tables.

    One that is ``surrounded`` has its equations among waves, current and wind beside those without.
    """
    still = plant.compiled()
    compiled = {"rk4": still.rk4, "out": still.out, "along": _along(still.out)}
    if surrounded:
        assert isinstance(plant, SurroundedPlant)
        among, between = plant.surrounded()
        compiled |= {"rates": still.rhs, "between": between}
        compiled |= {"out_among": among.out, "along_among": _along(among.out)}
    generator = ca.CodeGenerator("model.c", {"with_header": False, "main": False})
    for name, function in compiled.items():
        generator.add(_named(function, f"casadi_{name}"))
    starts = [plant.ports[f"{p.name}_start"] for p in plant.state_ports]
    own = [
        table("int", "x", _references(plant.state_ports)),
        table("int", "x_start", _references(starts)),
        table("int", "u", _references(plant.input_ports)),
        table("int", "p", _references(plant.parameter_ports)),
        table("int", "y", _references(plant.output_ports)),
    ]
    text = f'{generator.dump()}\n#include "component.h"\n'
    calls = [_called(name, of, compiled[name]) for name, of in _functions(surrounded).items()]
    whole = [text, *calls, *own, tables(plant, surrounded=surrounded), lanes(still)]
    return "\n".join(whole)


def _functions(surrounded: bool) -> dict[str, tuple[str, ...]]:
    return _STILL | _AMONG if surrounded else _STILL


def _named(function: ca.Function, name: str) -> ca.Function:
    """Return a function under a name of its own: of two models each has its outputs."""
    symbols = function.sx_in()
    return ca.Function(name, symbols, function.call(symbols))


def _declared(name: str, arguments: Sequence[str]) -> str:
    """Return the head of a function of C."""
    taken = ", ".join("double h" if a == "h" else f"const double *{a}" for a in arguments)
    return f"void model_{name}({taken}, double *to)"


def _called(name: str, arguments: Sequence[str], function: ca.Function) -> str:
    """Return a function of C that calls CasADi's."""
    sizes = {of: max(1, getattr(function, f"sz_{of}")()) for of in ("arg", "res", "iw", "w")}
    given = ", ".join("&h" if a == "h" else a for a in arguments)
    return f"""\
{_declared(name, arguments)} {{
    const double *arguments[{sizes["arg"]}] = {{{given}}};
    double *results[{sizes["res"]}] = {{to}}, work[{sizes["w"]}];
    casadi_int places[{sizes["iw"]}];
    casadi_{name}(arguments, results, places, work, 0);
}}
"""


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
