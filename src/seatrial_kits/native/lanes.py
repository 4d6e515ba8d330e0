"""C text of a plant's equations for several copies at once, one in each lane of a vector.

Each lane has the operations that CasADi writes for one copy, in the same order: the same bits. What
follows from parameters alone is evaluated once, before the steps of a run.
"""

from __future__ import annotations

import math
import re
from collections.abc import Sequence
from dataclasses import dataclass, field

import casadi as ca

from seatrial.model.expressions import Model

_VECTORS = {
    ca.OP_ADD: "{0} + {1}",
    ca.OP_SUB: "{0} - {1}",
    ca.OP_MUL: "{0} * {1}",
    ca.OP_DIV: "{0} / {1}",
    ca.OP_NEG: "-{0}",
    ca.OP_TWICE: "2.0 * {0}",
    ca.OP_SQ: "{0} * {0}",
    ca.OP_INV: "1.0 / {0}",
}
"""Operations that C has for vectors as for numbers."""
_MASKS = {
    ca.OP_FABS: "SIZE({0})",
    ca.OP_LT: "TRUTH({0} < {1})",
    ca.OP_LE: "TRUTH({0} <= {1})",
    ca.OP_EQ: "TRUTH({0} == {1})",
    ca.OP_NE: "TRUTH({0} != {1})",
    ca.OP_NOT: "TRUTH({0} == 0.0)",
    ca.OP_IF_ELSE_ZERO: "CHOSEN({0}, {1})",
}
"""Operations on bits; their operands are vectors."""
_FUNCTIONS = {
    ca.OP_SQRT: "__builtin_sqrt({0})",
    ca.OP_TAN: "tan({0})",
    ca.OP_ASIN: "asin({0})",
    ca.OP_ACOS: "acos({0})",
    ca.OP_ATAN: "atan({0})",
    ca.OP_SINH: "sinh({0})",
    ca.OP_COSH: "cosh({0})",
    ca.OP_TANH: "tanh({0})",
    ca.OP_EXP: "exp({0})",
    ca.OP_LOG: "log({0})",
    ca.OP_POW: "pow({0}, {1})",
    ca.OP_CONSTPOW: "pow({0}, {1})",
    ca.OP_ATAN2: "atan2({0}, {1})",
    ca.OP_FMIN: "casadi_fmin({0}, {1})",
    ca.OP_FMAX: "casadi_fmax({0}, {1})",
    ca.OP_SIGN: "casadi_sign({0})",
    ca.OP_FLOOR: "floor({0})",
    ca.OP_CEIL: "ceil({0})",
    ca.OP_AND: "({0} && {1})",
    ca.OP_OR: "({0} || {1})",
}
"""Operations that each lane has by itself, as CasADi writes them."""

_SINES = {ca.OP_SIN: "sin", ca.OP_COS: "cos"}
"""Operations of `sines.inc`, which has both of an angle at once."""

_TEXT = """\
#if LANES /* in a rig of copies alone */
typedef double Lanes __attribute__((vector_size(8 * LANES)));
typedef int64_t Bits __attribute__((vector_size(8 * LANES)));
enum {{ HELD = {held} }}; /* values of parameters alone */
#define ALL(number) ((number) - (Lanes){{0.0}})
#define SIZE(v) ((Lanes)((Bits)(v) & INT64_MAX))
#define TRUTH(bits) ((Lanes)((bits) & (Bits)ALL(1.0)))
#define CHOSEN(truth, v) ((Lanes)(((truth) != 0.0) & (Bits)(v)))
#define EACH for (int i = 0; i < LANES; i++)
#include "sines.inc"

static void held_of(const Lanes *p, Lanes *to) {{
{of_parameters}
}}

static void rk4_of(const Lanes *x, const Lanes *u, const Lanes *held, double h, Lanes *to) {{
    (void)u;
{rk4}
}}

static void out_of(const Lanes *x, const Lanes *u, const Lanes *held, Lanes *to) {{
    (void)x, (void)u, (void)held, (void)to;
{out}
}}

#include "together.inc"
#endif
"""


@dataclass(frozen=True)
class _Value:
    text: str
    kind: str
    """``constant``; ``number``, the same in all lanes; ``held``, of parameters; ``lanes``."""
    key: tuple[object, ...] = ()
    """Of what is held: what it is, in any function."""


@dataclass
class _Held:
    """What follows from parameters alone, each value once, and the places of those in use."""

    lines: list[str] = field(default_factory=list)
    known: dict[tuple[object, ...], str] = field(default_factory=dict)
    places: dict[str, int] = field(default_factory=dict)

    def place(self, text: str) -> str:
        """Return where functions find a value."""
        return f"held[{self.places.setdefault(text, len(self.places))}]"


def lanes(model: Model) -> str:
    """Return the C text of a plant's Runge-Kutta step and outputs; empty if it has no vectors.

    ``together.inc`` lets the copies of a rig use it.
    """
    held = _Held()
    rk4 = _body(_inlined(model.rk4), "xuph", held)
    out = _body(_inlined(model.out), "xup", held)
    if rk4 is None or out is None:
        return ""
    stored = [f"to[{place}] = {text};" for text, place in held.places.items()]
    return _TEXT.format(
        held=max(1, len(held.places)),
        of_parameters=_indented([*held.lines, *stored] or ["(void)p, (void)to;"]),
        rk4=_indented(rk4),
        out=_indented(out),
    )


def _inlined(function: ca.Function) -> ca.Function:
    """Return a function as `model` writes it."""
    symbols = function.sx_in()
    return ca.Function("inlined", symbols, function.call(symbols))


def _indented(lines: Sequence[str]) -> str:
    return "\n".join(f"    {line}" for line in lines)


def _body(function: ca.Function, arguments: str, held: _Held) -> list[str] | None:
    """Return the lines of a function, None if an operation has no text here."""
    lines: list[str] = []
    work: dict[int, _Value] = {}
    for k in range(function.n_instructions()):
        op, i, o = (
            function.instruction_id(k),
            function.instruction_input(k),
            function.instruction_output(k),
        )
        if op == ca.OP_CONST:
            value = function.instruction_constant(k)
            if not math.isfinite(value):
                return None
            work[o[0]] = _Value(f"({value!r})", "constant", (value, math.copysign(1.0, value)))
        elif op == ca.OP_INPUT:
            work[o[0]] = _argument(arguments[i[0]], i[1])
        elif op == ca.OP_OUTPUT:
            lines.append(f"to[{o[1]}] = {_vector(work[i[0]], held)};")
        else:
            operands = [work[each] for each in i]
            if not any(op in known for known in (_VECTORS, _MASKS, _FUNCTIONS, _SINES)):
                return None
            work[o[0]] = _written(op, operands, lines, held)
    return lines


def _argument(name: str, element: int) -> _Value:
    if name == "h":
        return _Value("h", "number")
    text = f"{name}[{element}]"
    return _Value(text, "held", (text,)) if name == "p" else _Value(text, "lanes")


def _written(op: int, operands: Sequence[_Value], lines: list[str], held: _Held) -> _Value:
    """Add the line of an operation, and return its value."""
    kinds = {each.kind for each in operands}
    if kinds <= {"constant", "held"}:
        key = (op, *(each.key for each in operands))
        if key not in held.known:
            held.known[key] = _added(f"a{len(held.known)}", op, operands, held.lines)
        return _Value(held.known[key], "held", (held.known[key],))
    name = f"v{len(lines)}"
    found = [
        _Value(held.place(each.text), "lanes") if each.kind == "held" else each for each in operands
    ]
    if kinds <= {"constant", "number"} and op in _VECTORS:
        text = _VECTORS[op].format(*(each.text for each in found))
        lines.append(f"const double {name} = {text};")
        return _Value(name, "number")
    return _Value(_added(name, op, found, lines), "lanes")


def _added(name: str, op: int, operands: Sequence[_Value], lines: list[str]) -> str:
    """Add what declares the vector of an operation, and return its name."""
    texts = [each.text for each in operands]
    alike = [each.kind in ("constant", "number") for each in operands]
    whole = [f"ALL({text})" if same else text for text, same in zip(texts, alike, strict=True)]
    if op in _SINES:
        return _of_angle(op, whole[0], lines)
    if op in _VECTORS and not all(alike):
        lines.append(f"const Lanes {name} = {_VECTORS[op].format(*texts)};")
    elif op in _VECTORS or op in _MASKS:
        lines.append(f"const Lanes {name} = {(_VECTORS | _MASKS)[op].format(*whole)};")
    else:
        each = [text if same else f"{text}[i]" for text, same in zip(texts, alike, strict=True)]
        lines += [f"Lanes {name};", f"EACH {name}[i] = {_FUNCTIONS[op].format(*each)};"]
    return name


def _of_angle(op: int, angle: str, lines: list[str]) -> str:
    """Return the name of the sine or the cosine of an angle, with the lines of both if need be."""
    own = re.sub(r"\W", "_", angle)
    declared = f"Lanes sin_{own}, cos_{own};"
    if declared not in lines:
        lines += [declared, f"sines({angle}, &sin_{own}, &cos_{own});"]
    return f"{_SINES[op]}_{own}"


def _vector(value: _Value, held: _Held) -> str:
    if value.kind == "held":
        return held.place(value.text)
    return value.text if value.kind == "lanes" else f"ALL({value.text})"
