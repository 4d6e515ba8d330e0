"""A component as C: its ports, the attributes that it remembers, and its methods."""

from __future__ import annotations

import ast
from collections.abc import Iterator, Mapping
from types import FunctionType, ModuleType
from typing import Any

from seatrial.kits import is_ours
from seatrial.model.component import Component as Base

from . import dense, loops  # noqa: F401  which register what they translate
from .calls import call
from .classes import FRAMEWORK, ROOTS, refuse_unusual
from .constants import is_record, scope_of, why_no_constant
from .domain import (
    C_TYPES,
    Choice,
    Component,
    Draws,
    FaultValues,
    Known,
    Method,
    Num,
    OwnName,
    Queue,
    Record,
    Seq,
    Super,
    TranslationError,
    UnshapedError,
    described,
)
from .expressions import storable
from .frame import WORD, Frame, lines
from .functions import appended_attributes, found_method, invoke
from .intrinsics import begun, fault_value
from .operations import binary, held
from .port_access import publish, read
from .shapes import Shape, flattened, joined, leaves, opened, shape_of
from .statements import assign

_PASSES = 12


class Unit:
    """The translation of one component."""

    def __init__(self, example: Base) -> None:
        self.example, self.cls = example, type(example)
        self.own = Component()
        self.attributes: dict[str, Shape] = {}
        self.queues: dict[str, Shape] = {}
        self.here = self.cls.__name__
        """Where the translation is, for messages."""
        self.appended = appended_attributes(self.cls)
        self.made: dict[str, Known] = {}
        """Objects that are built in, by the method that makes them."""
        self.tabulated: dict[str, Known] = {}
        """Attributes that are tables, made when C is written."""
        self.tables: dict[Any, tuple[str, str, int]] = {}
        self.changed = True
        self._begin()

    def _begin(self) -> None:
        self.counter = 0
        self.functions: list[tuple[str, str]] = []
        """By name, in the order in which they are written: after those that they call."""
        self.written: dict[Any, Any] = {}
        self.open: set[Any] = set()
        self.started: list[str] = []
        """Attributes that have a value when `start` has run."""
        self.changed = False

    # ------------------------------------------------------------------ whole

    def translate(self) -> str:
        """Return the functions of C.

        Raises TranslationError, naming file, line and construct, for whatever has none.
        """
        try:
            refuse_unusual(self.cls)
            return self._settled()
        except TranslationError:
            raise
        except Exception as error:
            # A mistake of the translator, or a value that Python would refuse when it comes there.
            what = f"{type(error).__name__}: {error}"
            raise TranslationError(f"{self.here}: {what}: that has no C") from error

    def _settled(self) -> str:
        for _ in range(_PASSES):
            self._begin()
            roots, missing = [], ""
            for name in ROOTS:
                try:
                    roots.append(self._root(name))
                except UnshapedError as error:
                    missing = str(error)
            if not self.changed:
                if missing:
                    raise TranslationError(missing)
                return "\n".join([*self._called(roots), *roots])
        raise TranslationError(f"{self.cls.__name__}: the types of its attributes do not settle")

    def _called(self, roots: list[str]) -> list[str]:
        """Return the functions that are called: not those of loops that were written again."""
        found: list[str] = []
        words = {word for root in roots for word in WORD.findall(root)}
        for name, text in reversed(self.functions):
            if name in words:
                found.append(text)
                words.update(WORD.findall(text))
        return found[::-1]

    def _root(self, name: str) -> str:
        function, owner = found_method(self.cls, name)
        file = function.__code__.co_filename
        where = (file, function.__code__.co_firstlineno)
        frame = Frame(self, f"{self.cls.__name__}.{name}", where, {}, owner)
        kinds = "dd" if name == "step" else "d"
        arguments = [Num("d", text) for text, _ in zip(("t", "h"), kinds, strict=False)]
        if function is not vars(Base).get(name):
            frame.has_set(self.started)
            invoke(frame, function, owner, [self.own, *arguments], {})
            if frame.needed and not self.changed:
                names = ", ".join(sorted(frame.needed))
                raise TranslationError(
                    f"{self.cls.__name__}: {names} may be read before start() gives a value: "
                    "that has no C"
                )
            if name == "start":
                self.started = [each[1:] for each in frame.sets()]
        parameters = "".join(f", double {a.text}" for a in arguments)
        unused = "".join(f"    (void){a.text};\n" for a in arguments)
        declared = "".join(f"    {t} {n} = 0;\n" for t, n in frame.variables)
        body = "\n".join(lines(frame.code))
        return (
            f"void model_{name}(Instance *self{parameters}) {{\n{declared}    (void)self;\n{unused}"
            f"{body}\n}}\n"
        )

    def memory(self) -> Iterator[str]:
        """Yield the fields of the struct that holds what the component remembers."""
        for name, shape in self.attributes.items():
            for kind in "bid":
                count = leaves(shape).count(kind)
                if count:
                    yield f"{C_TYPES[kind]} {name}_{kind}[{count}];"
        yield from (f"Queue {name}_q;" for name in self.queues)
        for name, shape in self.queues.items():
            yield f"double {name}_e[QUEUE_SIZE][{max(1, len(leaves(shape)))}];"

    def constants(self) -> Iterator[str]:
        """Yield the tables of numbers that are looked up by an index of the run."""
        for table, (name, kind, _) in self.tables.items():
            cells = ", ".join(repr(v) for v in table)
            yield f"static const {C_TYPES[kind]} {name}[] = {{{cells}}};"

    def constant_table(self, values: Any) -> tuple[str, str, int] | None:
        """Return name, kind and size of a table of C; None for what is no list of numbers."""
        if not isinstance(values, (tuple, list, range)) or not values:
            return None
        kinds = {type(v) for v in values}
        if not kinds <= {int, float}:
            return None
        kind = "d" if float in kinds else "i"
        key = tuple(float(v) if kind == "d" else v for v in values)
        if key not in self.tables:
            self.tables[key] = (f"table_{len(self.tables)}", kind, len(key))
        return self.tables[key]

    # ------------------------------------------------------------------ attributes

    def attribute(self, frame: Frame, owner: Any, name: str) -> Any:
        """Return an attribute of a value."""
        if name.startswith("__"):
            raise frame.refused(f"the attribute {name}")
        if isinstance(owner, Choice):
            return frame.each(owner, lambda one: self.attribute(frame, one, name))
        if isinstance(owner, Component):
            return self._own(frame, name)
        if isinstance(owner, Super):
            found, where = found_method(_class_of(self, owner.receiver), name, owner.owner)
            return Method(found, where, owner.receiver)
        if isinstance(owner, Known) and not is_record(type(owner.value)):
            if isinstance(owner.value, (list, tuple, Mapping)):
                return Method(name, None, opened(owner))
            return self._known(frame, owner.value, name)
        owner = opened(owner)
        if isinstance(owner, Record):
            if name in owner.fields:
                return owner.fields[name]
            found, where = found_method(owner.cls, name)
            is_own = callable(found) or isinstance(found, property)
            if is_own and name not in ("_replace", "index", "count"):
                return self._bound(frame, name, found, where, owner)
        return Method(name, None, owner)

    def _known(self, frame: Frame, owner: Any, name: str) -> Known:
        """Return an attribute of a module, class or object that is as it is in every run."""
        found = getattr(owner, name)
        if isinstance(owner, (str, bytes, int, float)) or is_ours(type(owner).__module__):
            return Known(found)
        is_module = isinstance(owner, ModuleType)
        cls = owner if isinstance(owner, type) else type(owner)
        why = why_no_constant(vars(owner) if is_module else scope_of(cls), name, found)
        if why and type(owner).__module__ != "numpy":
            raise frame.refused(f"{name} of {described(Known(owner))}, {why},")
        return Known(found)

    def _own(self, frame: Frame, name: str) -> Any:
        if name in self.cls.ports:
            return read(frame, self.cls.ports[name])
        match name:
            case "name":
                return OwnName()
            case "now_ns" | "_now_ns":
                return frame.num("i", "self->state.now_ns")
            case "_stale":
                return frame.num("b", "self->state.stale != 0")
            case "now":
                return frame.num("d", "(double)self->state.now_ns / 1e9")
        known = (frame.names or {}).get(f"self.{name}")
        if known is not None:
            return known
        if name in self.tabulated:
            return self.tabulated[name]
        if name in self.appended:
            frame.needs([name])
            return Queue(name) if name in self.queues else Seq(list, [], fresh=False)
        if name in self.attributes:
            frame.needs([name])
            shape = self.attributes[name]
            return frame.loaded(shape, iter(self._fields(name, shape)))
        found, where = found_method(self.cls, name)
        if where is None:
            raise UnshapedError(
                f"{frame.file}:{frame.line} ({frame.title}): {name} is read and nothing sets it"
            )
        return self._bound(frame, name, found, where, self.own)

    def has(self, frame: Frame, name: str) -> bool:
        """Return whether the component has an attribute; the caller must have set it then."""
        if name in self.attributes or name in self.queues:
            frame.needs([name])
            return True
        raise UnshapedError(f"{frame.file}:{frame.line} ({frame.title}): nothing sets {name}")

    def _bound(self, frame: Frame, name: str, found: Any, where: Any, receiver: Any) -> Any:
        if isinstance(found, property):
            return invoke(frame, found.fget, where, [receiver], {})
        if isinstance(found, staticmethod):
            return Known(found.__func__)
        if isinstance(found, classmethod):
            return Method(found.__func__, where, Known(_class_of(self, receiver)))
        if isinstance(found, FunctionType):
            return Method(found, where, receiver)
        getter, base = found_method(type(found), "__get__")
        if base is not None and hasattr(getter, "__code__"):
            arguments = [Known(found), receiver, Known(_class_of(self, receiver))]
            return invoke(frame, getter, base, arguments, {})
        why = why_no_constant(scope_of(where), name, found)
        if base is not None and not isinstance(found, type):
            why = "whose value is found its own way"
        if why:
            raise frame.refused(f"{where.__name__}.{name}, {why},")
        return Known(found)

    def remembers(self, name: str) -> bool:
        """Return whether a name is an attribute that the component sets."""
        return name in self.attributes

    def _fields(self, name: str, shape: Shape) -> list[str]:
        counts = dict.fromkeys("bid", 0)
        texts = []
        for kind in leaves(shape):
            texts.append(f"M.{name}_{kind}[{counts[kind]}]")
            counts[kind] += 1
        return texts

    def store(self, frame: Frame, owner: Any, name: str, value: Any) -> None:
        """Give an attribute its value."""
        if not isinstance(owner, Component):
            raise frame.refused(f"an assignment to {name} of {described(owner)}")
        if name in self.cls.ports:
            publish(frame, self.cls.ports[name], value)
        elif name in self.appended:
            if not (isinstance(value, Seq) and not value.items):
                raise frame.refused(f"a list from elsewhere as {name}, which is appended to,")
            if name in self.queues:
                frame.emit(f"M.{name}_q.count = 0;")
        else:
            found = found_method(self.cls, name)[0]
            if name.startswith("__") or name in FRAMEWORK or hasattr(type(found), "__set__"):
                raise frame.refused(f"an assignment to {name}")
            self._remember(frame, name, storable(frame, value))
        frame.stores([name])
        frame.has_set([name])

    def _remember(self, frame: Frame, name: str, value: Any) -> None:
        before = self.attributes.get(name)
        shape = shape_of(value)
        wider = shape if before is None else joined(before, shape)
        if wider != before:
            self.attributes[name], self.changed = wider, True
        held([value])
        texts = flattened(value, wider)
        # All are read before one is written: they may be parts of each other.
        for field, text in zip(self._fields(name, wider), texts, strict=True):
            if text is not None:
                frame.emit(f"{field} = {text};")

    # ------------------------------------------------------------------ queues

    def is_own(self, frame: Frame, node: ast.expr) -> bool:
        """Return whether a node is an attribute of the component itself."""
        return isinstance(node, ast.Attribute) and isinstance(frame.evaluate(node.value), Component)

    def queue(self, queue: Queue) -> str:
        """Return the C expression of a queue."""
        return f"(&M.{queue.name}_q)[0]"

    def enqueue(self, frame: Frame, name: str, value: Any) -> None:
        """Append to an attribute, which thereby becomes a queue."""
        before, shape = self.queues.get(name), shape_of(value)
        wider = shape if before is None else joined(before, shape)
        if wider != before:
            self.queues[name], self.changed = wider, True
        frame.needs([name])
        frame.stores([name])
        ring = f"&M.{name}_q, M.{name}_e, sizeof M.{name}_e[0]"
        at = frame.num("i", f"appended(self, {ring}, {frame.place()})")
        texts = flattened(storable(frame, value), wider)
        for place, (kind, text) in enumerate(zip(leaves(wider), texts, strict=True)):
            if text is not None:
                cell = f"M.{name}_e[{at.text}][{place}]"
                whole = f"exact(self, {text}, {frame.place()})"
                frame.emit(f"{cell} = {whole if kind == 'i' else f'(double)({text})'};")

    def queue_entry(self, frame: Frame, queue: Queue, index: Any) -> Any:
        """Return an entry of a queue."""
        shape = self.queues[queue.name]
        text = frame.text_of(index, "i")
        at = frame.num("i", f"entry_at(self, &M.{queue.name}_q, {text})")
        kinds = leaves(shape)
        cells = [f"({C_TYPES[k]})M.{queue.name}_e[{at.text}][{i}]" for i, k in enumerate(kinds)]
        return frame.loaded(shape, iter(cells))

    # ------------------------------------------------------------------ calls

    def call(self, frame: Frame, function: Any, arguments: list[Any], named: dict[str, Any]) -> Any:
        """Return what a function returns."""
        return call(frame, function, arguments, named)

    def tabulate(self, name: str) -> Known:
        """Call a method that makes tables of what is built in, here and now."""
        if name not in self.made:
            self.made[name] = Known(getattr(self.example, name)())
            attributes = self.cls.tabulated[name]
            self.tabulated |= {a: Known(getattr(self.example, a)) for a in attributes}
            self.changed = True
        return self.made[name]

    # ------------------------------------------------------------------ for the other modules

    def assign(self, frame: Frame, target: ast.expr, value: Any) -> None:
        """Give a target of an assignment its value."""
        assign(frame, target, value)

    def begin(self, frame: Frame, draws: Draws) -> None:
        """Let a generator begin, which may be drawn from in several places."""
        begun(frame, draws)

    def added(self, frame: Frame, a: Any, b: Any) -> Any:
        """Return a + b."""
        return binary(frame, ast.Add(), a, b)

    def fault_value(self, frame: Frame, values: FaultValues, index: Any) -> Any:
        """Return one number of a fault's setting."""
        return fault_value(frame, values, index)

    def fault_values(self, frame: Frame, values: FaultValues, kind: type) -> Any:
        """Return the five coefficients of a fault."""
        return Seq(kind, [fault_value(frame, values, Known(i)) for i in range(5)])


def _class_of(unit: Unit, receiver: Any) -> type:
    return receiver.cls if isinstance(receiver, Record) else unit.cls
