"""A C function as it is written: its variables, its branches and where they meet."""

from __future__ import annotations

import ast
import re
from collections import Counter
from collections.abc import Callable, Iterable, Iterator, Sequence
from contextlib import contextmanager, suppress
from functools import partial
from typing import Any

from .domain import (
    C_TYPES,
    Choice,
    EndedError,
    Known,
    MismatchError,
    Num,
    Seq,
    TranslationError,
    described,
)
from .shapes import Shape, built, flattened, joined, leaves, number, number_kind, shape_of

FAILED = "failed"
"""Label at the end of a function that has failed."""
WORD = re.compile(r"[A-Za-z_]\w*")
_ORDER = "bid"
_WORDS = {"b": "truth value", "i": "whole number", "d": "float"}
SET = Known(True)
"""What ``=NAME`` among the names is where the attribute NAME of the component has a value."""

EXPRESSIONS: dict[type, Callable[[Any, Any], Any]] = {}
STATEMENTS: dict[type, Callable[[Any, Any], None]] = {}
"""What is done for a kind of syntax, with the frame and the node."""


def expression(*kinds: type) -> Callable[[Any], Any]:
    """Register a function that evaluates nodes of these kinds."""
    return partial(_registered, EXPRESSIONS, kinds)


def statement(*kinds: type) -> Callable[[Any], Any]:
    """Register a function that executes nodes of these kinds."""
    return partial(_registered, STATEMENTS, kinds)


def _registered(where: dict[type, Any], kinds: Sequence[type], function: Any) -> Any:
    where.update(dict.fromkeys(kinds, function))
    return function


def merged(values: Sequence[Any]) -> Shape:
    """Return the shape of what is one of the values."""
    shape = shape_of(values[0])
    for value in values[1:]:
        shape = joined(shape, shape_of(value))
    return shape


class Join:
    """A place that control reaches in several ways: from each, names and what they are there."""

    def __init__(self, frame: Frame, label: str = "") -> None:
        self.frame, self.label = frame, label
        self.sites: list[tuple[dict[str, Any], list[Any]]] = []

    def come(self, names: dict[str, Any]) -> None:
        """Come from here with these names."""
        slot: list[Any] = []
        self.frame.code.append(slot)
        self.sites.append((dict(names), slot))

    def names(self) -> dict[str, Any] | None:
        """Return what the names are there, None if nothing comes."""
        if not self.sites:
            return None
        if self.label and len(self.sites) == 1 and self.sites[0][1] is self.frame.code[-1]:
            return self.sites[0][0]  # what comes is just above
        common = [n for n in self.sites[0][0] if all(n in names for names, _ in self.sites)]
        found = {name: self._met(name) for name in common}
        if self.label:
            for _, slot in self.sites:
                slot.append(f"goto {self.label};")
            self.frame.code.append(f"{self.label}:;")
        return found

    def _met(self, name: str) -> Any:
        values = [names[name] for names, _ in self.sites]
        first = values[0]
        if all(value is first for value in values):
            return first
        shape = merged(values)
        kinds = leaves(shape)
        columns = [flattened(value, shape) for value in values]
        texts = []
        for place, kind in enumerate(kinds):
            own = {column[place] for column in columns}
            same = own.pop() if len(own) == 1 else None
            if same is not None:
                texts.append(same)
                continue
            temp = self.frame.variable(kind)
            texts.append(temp)
            for (_, slot), column in zip(self.sites, columns, strict=True):
                if column[place] is not None:
                    slot.append(f"{temp} = {column[place]};")
        value = built(shape, iter(texts))
        if isinstance(value, Seq):
            # What an expression has come to may be a list that has a name.
            value.fresh = name != "" and all(isinstance(v, Seq) and v.fresh for v in values)
            value.spent = any(isinstance(v, Seq) and v.spent for v in values)
        return value


class Frame:
    """One function of Python as it becomes C: names, the C written so far, and where it returns."""

    def __init__(
        self, unit: Any, title: str, where: tuple[str, int], scope: Any, owner: type | None
    ) -> None:
        self.unit, self.title, self.owner = unit, title, owner
        self.file, self.line = where
        self.scope: dict[str, Any] = scope
        self.names: dict[str, Any] | None = {}
        """Local names; None where control does not come."""
        self.code: list[Any] = []
        self.variables: list[tuple[str, str]] = []
        self.loops: list[tuple[Join, Join]] = []
        self.returns = Join(self)
        self.counter = [0]
        self.stored: set[str] = set()
        """Attributes of the component that it has set."""
        self.needed: set[str] = set()
        """Attributes that it reads, and that its caller has to have set."""
        self.given: set[str] = set()
        """Attributes that it has set wherever it returns."""
        self.closed = False
        """It is a function inside a function, in whose place it is written."""
        self.locals: frozenset[str] = frozenset()
        """Names that are its own wherever they stand: they have no value before they are set."""

    def inner(self, names: dict[str, Any]) -> Frame:
        """Return a frame for a function that is written in this one's place."""
        frame = Frame(self.unit, self.title, (self.file, self.line), self.scope, self.owner)
        frame.names, frame.code, frame.variables = names, self.code, self.variables
        frame.counter, frame.stored, frame.needed = self.counter, self.stored, self.needed
        frame.returns = Join(frame, self.label())
        return frame

    # ------------------------------------------------------------------ syntax

    def evaluate(self, node: ast.expr) -> Any:
        """Return the value of an expression."""
        handler = EXPRESSIONS.get(type(node))
        if handler is None:
            raise self.refused(f"{type(node).__name__} in an expression", node)
        return handler(self, node)

    def execute(self, body: Iterable[ast.stmt]) -> None:
        """Execute statements until control does not come any further."""
        for node in body:
            if self.names is None:
                return
            self.line = node.lineno
            self.unit.here = f"{self.file}:{self.line} ({self.title})"
            handler = STATEMENTS.get(type(node))
            if handler is None:
                raise self.refused(f"a statement {type(node).__name__}", node)
            try:
                handler(self, node)
            except EndedError:
                self.names = None

    def place(self) -> str:
        """Return the current line of Python as a C string."""
        return f'"{self.file.rpartition("/")[2]}:{self.line}"'

    def refused(self, what: str, node: ast.AST | None = None) -> TranslationError:
        """Return the error for a construct without C, at a node or the current line."""
        line = getattr(node, "lineno", self.line)
        return TranslationError(f"{self.file}:{line} ({self.title}): {what} has no C")

    def mismatched(self, what: str, *operands: Any) -> TranslationError:
        """Return the error for an operation on operands that it cannot be done with here.

        With None among them Python cannot either: that may end the run where it happens.
        """
        if any(isinstance(own, Known) and own.value is None for own in operands):
            return self.impossible(what)
        return self.refused(what)

    def impossible(self, what: str) -> MismatchError:
        """Return the error for what Python refuses too, if it comes there."""
        return MismatchError(str(self.refused(what)))

    def fail(self, arguments: str) -> None:
        """Write what ends the call with an error. Raises EndedError, always."""
        self.emit(f"fail(self, {arguments});")
        self.end()

    def end(self) -> None:
        """Write that control does not come any further. Raises EndedError, always."""
        self.emit(f"goto {FAILED};")
        raise EndedError

    def stores(self, attributes: Iterable[str]) -> None:
        """Note that attributes of the component have changed: what was known of them is not."""
        self.stored |= set(attributes)
        for name in attributes:
            (self.names or {}).pop(f"self.{name}", None)

    def has_set(self, attributes: Iterable[str]) -> None:
        """Note that attributes of the component have values from here on."""
        if self.names is not None:
            self.names = {**self.names, **{f"={name}": SET for name in attributes}}

    def sets(self) -> dict[str, Any]:
        """Return the names that say which attributes have values here."""
        return {name: SET for name in self.names or {} if name.startswith("=")}

    def needs(self, attributes: Iterable[str]) -> None:
        """Note that attributes are read here: those that have no value yet are the caller's."""
        self.needed |= {name for name in attributes if f"={name}" not in (self.names or {})}

    # ------------------------------------------------------------------ C

    def emit(self, text: str) -> None:
        """Write a line of C."""
        self.code.append(text)

    def variable(self, kind: str) -> str:
        """Return the name of a new C variable."""
        self.counter[0] += 1
        name = f"{kind}{self.counter[0]}"
        self.variables.append((C_TYPES[kind], name))
        return name

    def label(self) -> str:
        """Return a new label."""
        self.counter[0] += 1
        return f"L{self.counter[0]}"

    def num(self, kind: str, text: str) -> Num:
        """Return a new number with the value of a C expression."""
        name = self.variable(kind)
        self.emit(f"{name} = {text};")
        return Num(kind, name)

    def loaded(self, shape: Shape, texts: Iterator[str]) -> Any:
        """Return the value of a shape from C expressions, copied to variables."""
        return built(
            shape, (self.num(k, t).text for k, t in zip(leaves(shape), texts, strict=True))
        )

    @contextmanager
    def block(self, opening: str) -> Iterator[None]:
        """Write what is emitted inside as a block, which has its end whatever happens inside.

        What Python refuses inside it refuses in this block only: that has no place outside.
        """
        outer, self.code = self.code, []
        outer.append(opening)
        outer.append(self.code)
        try:
            yield
        except MismatchError as error:
            raise TranslationError(str(error)) from error
        finally:
            outer.append("}")
            self.code = outer

    def branch(self, condition: Num | Known, yes: Callable[[], Any], no: Callable[[], Any]) -> Any:
        """Return what ``yes`` or ``no`` returns, by a condition; each may change names."""
        if isinstance(condition, Known):
            return yes() if condition.value else no()
        join, before = Join(self), self.names
        for opening, act in ((f"if ({condition.text}) {{", yes), ("else {", no)):
            with self.block(opening):
                self.names = dict(before or {})
                with suppress(EndedError):
                    value = act()
                    if self.names is not None:
                        join.come({**self.names, "": value})
        return self._arrived(join)

    def each(self, choice: Choice, act: Callable[[Any], Any]) -> Any:
        """Return what ``act`` returns for the alternative that a choice is."""
        flags = self._flags(choice, act)
        return self.alternatives(choice, act) if flags is None else flags

    def alternatives(self, choice: Choice, act: Callable[[Any], Any]) -> Any:
        """Return the same; ``act`` may change names."""
        join, before = Join(self), self.names
        mistake: MismatchError | None = None
        for at, value in enumerate(choice.alternatives):
            last = at == len(choice.alternatives) - 1
            word = "else " if at else ""
            with self.block(f"{word}{{" if last else f"{word}if ({choice.tag} == {at}) {{"):
                self.names = dict(before or {})
                with suppress(EndedError):
                    try:
                        result = act(value)
                    except MismatchError as error:
                        mistake = error
                        self.fail(f'"%s: another kind of value at %s", self->name, {self.place()}')
                    if self.names is not None:
                        join.come({**self.names, "": result})
        if mistake is not None and not join.sites:
            raise mistake
        return self._arrived(join)

    def _arrived(self, join: Join) -> Any:
        """Go on where a join is; return the value with which control comes there."""
        self.names = names = join.names()
        if names is None:
            raise EndedError
        return names.pop("", Known(None))

    def _flags(self, choice: Choice, act: Callable[[Any], Any]) -> Any:
        """Return the results if all are known truth values, which takes no branches."""
        outer, before, own = self.code, self.names, len(self.variables)
        self.code = []
        try:
            results = [act(value) for value in choice.alternatives]
            silent = not self.code
        except (MismatchError, EndedError):
            return None
        finally:
            self.code, self.names = outer, before
            del self.variables[own:]
        if not silent or not all(
            isinstance(r, Known) and isinstance(r.value, bool) for r in results
        ):
            return None
        true = [i for i, r in enumerate(results) if r.value]
        if len(true) in (0, len(results)):
            return Known(bool(true))
        return self.num("b", " || ".join(f"{choice.tag} == {i}" for i in true))

    def text_of(self, value: Any, kind: str = "") -> str:
        """Return the C expression of a number. Raises TranslationError for anything else."""
        plain = isinstance(value, Known) and bool(number_kind(value.value))
        if not plain and not isinstance(value, Num):
            raise self.mismatched(f"{described(value)} where a number is needed", value)
        own = value.kind if isinstance(value, Num) else number_kind(value.value)
        if kind and _ORDER.index(own) > _ORDER.index(kind):
            raise self.refused(f"a {_WORDS[own]} where a {_WORDS[kind]} is needed")
        return number(value, kind)


def pruned(variables: Sequence[tuple[str, str]], code: Sequence[Any]) -> tuple[list[Any], set[str]]:
    """Return code without what nothing reads, and the names of the variables that are left."""
    rows, names = list(_flat(code)), {name for _, name in variables}
    while True:
        code_rows = [row for row in rows if not row.startswith("/*")]
        counts = Counter(word for row in code_rows for word in WORD.findall(row))
        writes = Counter(row.partition(" = ")[0] for row in code_rows)
        kept: list[Any] = []
        for row in rows:
            name, is_set, value = row.partition(" = ")
            if not (is_set and name in names and counts[name] == writes[name]):
                kept.append(row)
            elif "(self" in value or "drawn_" in value:
                kept.append(f"(void)({value.rstrip(';')});")
        if kept == rows:
            return kept, {name for name in names if counts[name]}
        rows = kept


def lines(code: Sequence[Any]) -> Iterator[str]:
    """Yield the lines of nested code, indented by their braces."""
    depth = 1
    for text in _flat(code):
        depth -= text.startswith("}")
        yield f"{'    ' * depth}{text}"
        depth += text.endswith("{")


def _flat(code: Sequence[Any]) -> Iterator[str]:
    for each in code:
        if isinstance(each, str):
            yield each
        else:
            yield from _flat(each)
