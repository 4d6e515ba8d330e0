"""Loops of Python: written turn by turn, or as loops of C."""

from __future__ import annotations

import ast
from typing import Any

from .domain import Known, Queue, Range, Seq, is_once
from .expressions import unpacked
from .frame import FAILED, Frame, Join, statement
from .operations import truth
from .shapes import Shape, built, fits, flattened, joined, leaves, shape_of
from .statements import assign

_UNROLLED = 16
"""Turns of a loop over a range that are written one by one; more become a loop of C."""


@statement(ast.Break, ast.Continue)
def _leave(frame: Frame, node: ast.stmt) -> None:
    breaks, continues = frame.loops[-1]
    (breaks if isinstance(node, ast.Break) else continues).come(frame.names or {})
    frame.names = None


@statement(ast.For)
def _for(frame: Frame, node: ast.For) -> None:
    backwards = _reversed(node.iter)
    values = frame.evaluate(backwards or node.iter)
    if isinstance(values, Queue):
        if node.orelse:
            raise frame.refused("for ... else over what is appended to", node)
        _over_queue(frame, node, values, backwards is not None)
        return
    if backwards is None and not node.orelse and (span := _span(values)):
        _over_range(frame, node, span)
        return
    if backwards is not None:
        values = Seq(list, unpacked(frame, values)[::-1])
    if isinstance(values, Seq):
        values.fresh = False  # a loop goes through the list itself
    breaks = Join(frame, frame.label())
    for value in unpacked(frame, values):
        continues = Join(frame, frame.label())
        frame.loops.append((breaks, continues))
        assign(frame, node.target, value)
        frame.execute(node.body)
        frame.loops.pop()
        _arrive(frame, continues)
        if frame.names is None:
            break
    else:
        if node.orelse:
            frame.execute(node.orelse)
    _arrive(frame, breaks)


def _span(values: Any) -> Range | None:
    """Return what a loop of C goes over; None for what is short, or no range."""
    if isinstance(values, Range):
        return values
    if isinstance(values, Known) and isinstance(values.value, range):
        own = values.value
        return Range(str(own.start), str(own.stop), own.step) if len(own) > _UNROLLED else None
    return None


def _over_range(frame: Frame, node: ast.For, values: Range) -> None:
    at, end = frame.num("i", values.start), frame.num("i", values.stop)
    test = f"{at.text} {'<' if values.step > 0 else '>'} {end.text}"

    def begin() -> None:
        assign(frame, node.target, frame.num("i", at.text))

    step = f"{at.text} += {values.step};"
    _looped(frame, node, lambda: frame.num("b", test), step, begin)


def _reversed(node: ast.expr) -> ast.expr | None:
    """Return what ``reversed`` is asked of."""
    named = isinstance(node, ast.Call) and isinstance(node.func, ast.Name)
    return node.args[0] if named and node.func.id == "reversed" else None  # type: ignore[attr-defined]


def _arrive(frame: Frame, join: Join) -> None:
    """Go on where a join is."""
    if frame.names is not None:
        if not join.sites:
            return
        join.come(frame.names)
    frame.names = join.names()


def _over_queue(frame: Frame, node: ast.For, queue: Queue, backwards: bool) -> None:
    before, frame.stored = frame.stored, set()
    count = frame.num("i", f"{frame.unit.queue(queue)}.count")
    at = frame.num("i", f"{count.text} - 1" if backwards else "0")
    test = f"{at.text} >= 0" if backwards else f"{at.text} < {count.text}"
    step = f"{at.text} += {-1 if backwards else 1};"

    def begin() -> None:
        assign(frame, node.target, frame.unit.queue_entry(frame, queue, at))

    _looped(frame, node, lambda: frame.num("b", test), step, begin)
    if queue.name in frame.stored:
        raise frame.refused(f"a change of {queue.name} within a loop over it", node)
    frame.stored |= before


@statement(ast.While)
def _while(frame: Frame, node: ast.While) -> None:
    if node.orelse:
        raise frame.refused("while ... else", node)
    _looped(frame, node, lambda: truth(frame, frame.evaluate(node.test)), "", lambda: None)


def _looped(frame: Frame, node: ast.For | ast.While, test: Any, step: str, begin: Any) -> None:
    """Write a loop of C. The shapes of names that change in it are found by trying."""
    assert frame.names is not None
    # What is known of attributes may not hold in the next turn, and what is gone through is spent.
    frame.names = {
        n: v for n, v in frame.names.items() if not (n.startswith("self.") or is_once(v))
    }
    changed = _changed(node) & set(frame.names)
    shapes = {name: shape_of(frame.names[name]) for name in sorted(changed)}
    before, code = dict(frame.names), frame.code
    while True:
        frame.names, frame.code = dict(before), []
        found = _attempt(frame, node.body, test, step, begin, shapes)
        if found is None:
            code += frame.code
            frame.code = code
            return
        shapes = found


def _changed(loop: ast.For | ast.While) -> set[str]:
    """Return the names to which a loop may give other values, or whose lists it may change."""
    found: set[str] = set()
    for node in ast.walk(loop):
        if isinstance(node, ast.Name) and not isinstance(node.ctx, ast.Load):
            found.add(node.id)
        elif isinstance(node, (ast.MatchAs, ast.MatchStar, ast.FunctionDef)) and node.name:
            found.add(node.name)
        elif isinstance(node, (ast.Subscript, ast.Attribute)) and isinstance(node.value, ast.Name):
            changes = not isinstance(node.ctx, ast.Load) or getattr(node, "attr", "") == "append"
            found |= {node.value.id} if changes else set()
    return found - {"self"}


def _attempt(
    frame: Frame, body: list[ast.stmt], test: Any, step: str, begin: Any, shapes: dict[str, Shape]
) -> dict[str, Shape] | None:
    """Write the loop with those shapes; return others if they are too narrow."""
    assert frame.names is not None
    variables = {name: [frame.variable(k) for k in leaves(s)] for name, s in shapes.items()}
    for name, shape in shapes.items():
        _set(frame, variables[name], frame.names[name], shape)
        frame.names[name] = built(shape, iter(variables[name]))
    breaks, continues = Join(frame, frame.label()), Join(frame, frame.label())
    known = set(frame.names)
    with frame.block("for (;;) {"):
        flag = test()
        if isinstance(flag, Known) and not flag.value:
            breaks.come(frame.names)
            frame.names = None
        else:
            with frame.block(f"if (!{frame.text_of(flag, 'b')}) {{"):
                breaks.come(frame.names)
            with frame.block("if (self->is_wrong) {"):  # the turn before has computed nothing
                frame.emit(f"goto {FAILED};")
            begin()
            frame.loops.append((breaks, continues))
            frame.execute(body)
            frame.loops.pop()
            _arrive(frame, continues)
        if frame.names is not None:
            ends = {name: frame.names[name] for name in shapes}
            wider = {n: joined(shapes[n], shape_of(v)) for n, v in ends.items()}
            if any(not fits(v, shapes[n]) for n, v in ends.items()):
                return wider
            for name, value in ends.items():
                _set(frame, variables[name], value, shapes[name])
        if step:
            frame.emit(step)
    names = breaks.names()
    frame.names = None if names is None else {n: v for n, v in names.items() if n in known}
    return None


def _set(frame: Frame, variables: list[str], value: Any, shape: Shape) -> None:
    texts = flattened(value, shape)
    kinds = leaves(shape)
    copies = [
        None if t is None else frame.num(k, t).text for k, t in zip(kinds, texts, strict=True)
    ]
    for variable, copy in zip(variables, copies, strict=True):
        if copy is not None:
            frame.emit(f"{variable} = {copy};")
