"""Inputs from which each output follows, by the text of ``outputs`` and all that it calls.

The text is run with abstract values (`values`): a value is the set of inputs that it follows from.
Both ways of a branch are taken, and what they do follows from the branch's condition too; loops
are repeated until nothing more follows. What was left in attributes by earlier steps follows from
no input of now. The text of helper methods and functions is run where it is reached with
the component, or with what can reach it; other functions give what follows from all their
arguments. Where none of this can tell, `UndecidedError` says what and where.
"""

from __future__ import annotations

import ast
import sys
from collections.abc import Iterator, Sequence
from contextlib import contextmanager

from .calls import Calls, Frame
from .values import NONE, NOTHING, SHARED, Inputs, UndecidedError, Value, joined, mixed

_MOST_PASSES = 30


class Interpreter(Calls):
    """Runs statements. Raises UndecidedError."""

    def run(self) -> dict[str, set[str]]:
        """Return the inputs by output port."""
        for _ in range(_MOST_PASSES):
            self.changed = False
            self.known_calls.clear()
            self.call_method("outputs", [NOTHING], {})
            if not self.changed:
                return {name: set(cell.inputs) for name, cell in self.output_cells.items()}
        raise UndecidedError("the text does not come to rest")

    def run_body(self, frame: Frame, body: Sequence[ast.stmt]) -> Value:
        """Run a function's statements; return what it returns."""
        outer, self.frame = self.frame, frame
        try:
            self._block(body)
        finally:
            self.frame = outer
        return (frame.returned or NOTHING).after(frame.left)

    @contextmanager
    def under(self, inputs: Inputs) -> Iterator[None]:
        """Run something that runs only if values of ``inputs`` say so."""
        before = self.condition
        self.condition = before | inputs
        try:
            yield
        finally:
            self.condition = before

    # ------------------------------------------------------------------ statements

    def _block(self, body: Sequence[ast.stmt]) -> bool:
        """Run statements; return whether the end is reached."""
        for statement in body:
            with self.under(self.frame.left):
                if not self._statement(statement):
                    return False
        return True

    def _statement(self, node: ast.stmt) -> bool:
        method = getattr(self, f"_run_{type(node).__name__}", None)
        if method is None:
            raise self.undecided(node, f"{type(node).__name__} is not followed")
        ends: object = method(node)
        return ends is not False

    def _run_Expr(self, node: ast.Expr) -> None:
        self.evaluate(node.value)

    def _run_Pass(self, node: ast.stmt) -> None:
        pass

    def _run_Import(self, node: ast.Import) -> None:
        for alias in node.names:
            name = alias.name if alias.asname else alias.name.partition(".")[0]
            self.frame.names[alias.asname or name] = self.object(sys.modules.get(name))

    def _run_ImportFrom(self, node: ast.ImportFrom) -> None:
        base = self.globals.get("__package__") or ""
        if node.level:
            parents = base.split(".")[: len(base.split(".")) - node.level + 1]
            base = ".".join([*parents, *([node.module] if node.module else [])])
        else:
            base = node.module or ""
        for alias in node.names:
            found = getattr(sys.modules.get(base), alias.name, None)
            self.frame.names[alias.asname or alias.name] = self.object(found)

    def _run_Assert(self, node: ast.Assert) -> None:
        self.evaluate(node.test)

    def _run_Raise(self, node: ast.Raise) -> bool:
        if node.exc is not None:
            self.evaluate(node.exc)
        return False

    def _run_Assign(self, node: ast.Assign) -> None:
        value = self.evaluate(node.value)
        for target in node.targets:
            self.assign(target, value)

    def _run_AnnAssign(self, node: ast.AnnAssign) -> None:
        if node.value is not None:
            self.assign(node.target, self.evaluate(node.value))

    def _run_AugAssign(self, node: ast.AugAssign) -> None:
        before, value = self.evaluate(_loaded(node.target)), self.evaluate(node.value)
        self.pour(before, value.depends, carries=value.carries)
        self.assign(node.target, mixed([before, value]).after(NONE, before.cells))

    def _run_Delete(self, node: ast.Delete) -> None:
        for target in node.targets:
            if isinstance(target, (ast.Subscript, ast.Attribute)):
                self.pour(self.evaluate(target.value), NONE)

    def _run_Return(self, node: ast.Return) -> bool:
        value = NOTHING if node.value is None else self.evaluate(node.value)
        self.frame.returned = joined(self.frame.returned, value.after(self.condition))
        self._leave()
        return False

    def _run_Break(self, node: ast.stmt) -> bool:
        self._leave()
        self.frame.broken[-1].append(dict(self.frame.names))
        return False

    _run_Continue = _run_Break

    def _leave(self) -> None:
        self.frame.left |= self.condition

    def _run_If(self, node: ast.If) -> bool:
        test = self.evaluate(node.test)
        before = self.frame.names
        with self.under(test.depends):
            self.frame.names = dict(before)
            ends = self._block(node.body)
            after, self.frame.names = self.frame.names, dict(before)
            other_ends = self._block(node.orelse)
        if ends and other_ends:
            self.frame.names = _joined_names(after, self.frame.names)
        elif ends:
            self.frame.names = after
        return ends or other_ends

    def _run_While(self, node: ast.While) -> bool:
        self.frame.broken.append([])
        for _ in range(_MOST_PASSES):
            before = dict(self.frame.names)
            test = self.evaluate(node.test)
            with self.under(test.depends):
                self._block(node.body)
            if not self._loop_goes_on(before):
                break
        self._after_loop()
        return self._block(node.orelse)

    def _run_For(self, node: ast.For) -> bool:
        over = self.evaluate(node.iter)
        parts = self.iterated(over, node)
        self.frame.broken.append([])
        if parts is not None:
            for part in parts:
                self.assign(node.target, part)
                with self.under(over.inputs):
                    if not self._block(node.body) and not self.frame.broken[-1]:
                        break
        else:
            with self.under(over.depends):
                for _ in range(_MOST_PASSES):
                    before = dict(self.frame.names)
                    self.assign(node.target, self.element(over))
                    self._block(node.body)
                    if not self._loop_goes_on(before):
                        break
        self._after_loop()
        return self._block(node.orelse)

    def _loop_goes_on(self, before: dict[str, Value]) -> bool:
        """Say if a further repetition could show more; the names are those of any number."""
        for names in self.frame.broken[-1]:
            self.frame.names = _joined_names(self.frame.names, names)
        self.frame.broken[-1].clear()
        self.frame.names = _joined_names(before, self.frame.names)
        goes_on: bool = self.frame.names != before
        return goes_on

    def _after_loop(self) -> None:
        for names in self.frame.broken.pop():
            self.frame.names = _joined_names(self.frame.names, names)

    def _run_With(self, node: ast.With) -> bool:
        for item in node.items:
            value = mixed([self.evaluate(item.context_expr)])
            if item.optional_vars is not None:
                self.assign(item.optional_vars, value)
        before = dict(self.frame.names)
        self._attempted(node.body)
        self.frame.names = _joined_names(before, self.frame.names)
        return True  # an error that is caught goes on behind it

    def _attempted(self, body: Sequence[ast.stmt]) -> tuple[bool, Inputs]:
        """Run statements that an error may leave; return whether the end is reached.

        How far they come follows from anything that is read there, which is returned too.
        """
        outer, self.read = self.read, set()
        names = dict(self.frame.names)
        self._block(body)
        met, self.read = frozenset(self.read), outer | self.read
        self.frame.names = names
        with self.under(met):
            return self._block(body), met

    def _run_Try(self, node: ast.Try) -> bool:
        before = dict(self.frame.names)
        ends, met = self._attempted(node.body) if node.handlers else (self._block(node.body), NONE)
        after = self.frame.names
        self.frame.names = _joined_names(before, after)  # an error may come anywhere
        reached = [after] if ends and self._block(node.orelse) else []
        if reached:
            reached = [self.frame.names] if node.orelse else [after]
        for handler in node.handlers:
            self.frame.names = _joined_names(before, after)
            if handler.name:
                self.frame.names[handler.name] = Value(met)
            with self.under(met):
                if self._block(handler.body):
                    reached.append(self.frame.names)
        if reached:
            self.frame.names = reached[0]
            for names in reached[1:]:
                self.frame.names = _joined_names(self.frame.names, names)
        final = self._block(node.finalbody)
        return bool(reached) and final

    def _run_FunctionDef(self, node: ast.FunctionDef) -> None:
        if node.decorator_list:
            raise self.undecided(node, "a decorator of an inner function is not followed")
        self.assign(ast.Name(node.name, ast.Store()), self.inner_function(node))

    def _run_Match(self, node: ast.Match) -> bool:
        subject = self.evaluate(node.subject)
        before, reached = self.frame.names, []
        with self.under(subject.depends):
            for case in node.cases:
                self.frame.names = dict(before)
                for pattern in ast.walk(case.pattern):
                    name = getattr(pattern, "name", None) or getattr(pattern, "rest", None)
                    if isinstance(name, str):
                        self.frame.names[name] = mixed([subject])
                tests = [] if case.guard is None else [self.evaluate(case.guard)]
                with self.under(mixed(tests).depends):
                    if self._block(case.body):
                        reached.append(self.frame.names)
        self.frame.names = before
        for names in reached:
            self.frame.names = _joined_names(self.frame.names, names)
        return True

    # ------------------------------------------------------------------ targets

    def assign(self, target: ast.expr, value: Value) -> None:
        """Let a target of an assignment be ``value``."""
        value = value.after(self.condition)
        if isinstance(target, ast.Name):
            held = bool(value.cells - SHARED) or value.is_self or value.known is not None
            self.frame.names[target.id] = value if held else value.after(NONE, self.made_at(target))
        elif isinstance(target, ast.Attribute):
            self.set_attribute(self.evaluate(target.value), target.attr, value, target)
        elif isinstance(target, ast.Subscript):
            base, index = self.evaluate(target.value), self.evaluate(target.slice)
            self.pour(base, value.depends | index.depends, carries=value.carries)
        elif isinstance(target, ast.Starred):
            self.assign(target.value, mixed([value]))
        elif isinstance(target, (ast.Tuple, ast.List)):
            parts = value.parts
            starred = any(isinstance(one, ast.Starred) for one in target.elts)
            if parts is None or starred or len(parts) != len(target.elts):
                parts = (self.element(value),) * len(target.elts)
            for one, part in zip(target.elts, parts, strict=True):
                self.assign(one, part)
        else:
            raise self.undecided(target, "this target is not followed")


def _joined_names(a: dict[str, Value], b: dict[str, Value]) -> dict[str, Value]:
    return {name: joined(a.get(name), b.get(name)) for name in [*a, *(n for n in b if n not in a)]}


def _loaded(target: ast.expr) -> ast.expr:
    """Return what an augmented assignment reads before it writes."""
    if isinstance(target, ast.Name):
        return ast.Name(target.id, ast.Load())
    if isinstance(target, ast.Attribute):
        return ast.copy_location(ast.Attribute(target.value, target.attr, ast.Load()), target)
    assert isinstance(target, ast.Subscript)
    return ast.copy_location(ast.Subscript(target.value, target.slice, ast.Load()), target)
