"""Programs of communication steps: operations for `master.c`, and calls for Python.

An operation acts where (steps + phase) is a multiple of ``every``: a component with a longer step
of its own is written and stepped at the beginning of it (phase 0) and read at its end (phase 1).
Values stand where `Network.signals` has them. What C cannot do, of components in Python, of texts
and bytes, and of connections with tables, is a call: C returns, Python does it as ever.
"""

from __future__ import annotations

import ctypes
from collections.abc import Callable, Sequence
from typing import TYPE_CHECKING, Any, ClassVar, TypeAlias, cast

from ...fmi.instance import Variable
from ...system.sums import SumInstance
from ..algorithms import Algorithm, Extrapolated, GaussSeidel, PastInputs, ahead
from ..feedthrough import Feedthrough, Group
from ..network import Network
from ..node import Chunk, Node, Writes
from .library import function_address
from .structures import (
    ARRIVE,
    BOOLEAN,
    CALL,
    GET,
    INTEGER,
    LOOP,
    REAL,
    STEP,
    STORE,
    WRITE,
    Marks,
    Operation,
    Times,
)

if TYPE_CHECKING:
    from ...fmi.instance import Variable
    from ...fmi.interfaces.fmi2 import Fmi2Slave
    from ...fmi.interfaces.fmi3slave import Fmi3Slave
    from ...system.sums import SumInstance
    from .fmi3 import CompiledFmi3

    Slave: TypeAlias = "Fmi2Slave | CompiledFmi3 | CompiledSum"

_TYPES: dict[type, tuple[int, str, Any]] = {
    float: (REAL, "Real", ctypes.c_double),
    int: (INTEGER, "Integer", ctypes.c_int),
    bool: (BOOLEAN, "Boolean", ctypes.c_int),
}


class Program:
    """Operations on a network whose communication step is ``step_ns``, in the order they came."""

    def __init__(self, network: Network, feedthrough: Feedthrough, step_ns: int) -> None:
        self.operations: list[Operation] = []
        self.calls: list[list[Callable[[int, int], None]]] = []
        """Of each operation CALL: what Python does, by the steps taken and its time, ns."""
        self.asked: dict[int, tuple[Slave, str]] = {}
        """By operation: which FMU is called, and the function."""
        self.chunks: dict[int, Chunk] = {}
        """By operation STORE."""
        self.loops: dict[int, Group] = {}
        self.past: dict[int, PastInputs] = {}
        """By operation WRITE that extrapolates."""
        self.times: dict[str, Times] = {}
        """Of each component that C steps."""
        self.fetched: dict[int, list[int]] = {}
        """Of each operation CALL: the places that Python must have before."""
        self.left: dict[int, list[Chunk]] = {}
        """Of each operation CALL: what Python has read, for C."""
        self.kept: list[Any] = []
        """Arrays that operations point to."""
        self._adapted: dict[str, CompiledFmi3 | CompiledSum] = {}
        """By component: what is not called as FMI 2.0 has it."""
        self._network, self._feedthrough, self._step_ns = network, feedthrough, step_ns

    def add_step(self, algorithm: Algorithm) -> int:
        """Add a communication step, by one of `choice.ALGORITHMS`.

        Return where its feed-through visits begin.
        """
        if isinstance(algorithm, GaussSeidel):
            self._in_turn([self._network.nodes[name] for name in algorithm.order])
        else:
            past = algorithm.past if isinstance(algorithm, Extrapolated) else None
            self._together(list(self._network.nodes.values()), past)
        visits = len(self.operations)
        self.add_visits(self._feedthrough.groups)
        return visits

    def add_visits(self, groups: Sequence[Group]) -> None:
        """Add visits of feed-through outputs."""
        for group in groups:
            self._visit(group)

    def add_reading(self, node: Node) -> None:
        """Add a reading of all outputs of a component, whenever it is carried out."""
        self._read(node, node.chunks, always=True)

    def add_writing(self, node: Node) -> None:
        """Add a writing of all connected inputs of a component, whenever it is carried out."""
        self._write_all(node, 0, always=True)

    # ------------------------------------------------------------------ algorithms

    def _together(self, nodes: Sequence[Node], past: list[list[PastInputs]] | None) -> None:
        """Jacobi: inputs change nobody's outputs before all have stepped."""
        for i, node in enumerate(nodes):
            if past is not None:
                for one in past[i]:
                    self._write(node, one.writes, 0, one)
            elif not node.written_by_visit:
                self._write_all(node, 0)
        for node in nodes:
            self._step(node, 0, 0)
        self._add(Operation(kind=ARRIVE, every=1))
        for node in nodes:
            self._read(node, node.reads)

    def _in_turn(self, nodes: Sequence[Node]) -> None:
        """Gauss-Seidel: what a longer step ends with is known when it ends."""
        self._add(Operation(kind=ARRIVE, every=1))
        for node in nodes:
            self._write_all(node, 1)
            self._step(node, 1, self._step_ns * (1 - node.every))
            self._read(node, node.chunks)

    def _visit(self, group: Group) -> None:
        if not group.is_loop:
            for visit in group.visits:
                self._write_all(visit.node, 1)
                self._read(visit.node, visit.chunks)
            return
        if not all(
            all(self._setting(visit.node, writes) for writes in visit.node.writes)
            and all(self._getting(visit.node, chunk) for chunk in visit.chunks)
            for visit in group.visits
        ):
            chunks = [chunk for visit in group.visits for chunk in visit.chunks]
            places = [
                place for v in group.visits for one in v.node.writes for place in one.places
            ] + [self._network.places[name] for name in group.outputs]
            self._call(lambda steps, _t: self._feedthrough.solve(group, steps + 1), places, chunks)
            return
        places = [self._network.places[name] for name in group.outputs]
        reals = [isinstance(self._network.signals[place], float) for place in places]
        loop = Operation(kind=LOOP, every=1, count=len(places))
        loop.places = self._array(ctypes.c_int64, places)
        loop.reals = self._array(ctypes.c_uint8, reals)
        loop.numbers = self._array(ctypes.c_double, [0.0] * (2 * len(places)))
        self._add(loop)
        self.loops[len(self.operations) - 1] = group
        begun = len(self.operations)
        for visit in group.visits:
            self._write_all(visit.node, 1)
            self._read(visit.node, visit.chunks)
        loop.length = len(self.operations) - begun

    # ------------------------------------------------------------------ operations

    def _write_all(self, node: Node, phase: int, *, always: bool = False) -> None:
        for writes in node.writes:
            self._write(node, writes, phase, always=always)

    def _write(
        self,
        node: Node,
        writes: Writes,
        phase: int,
        past: PastInputs | None = None,
        *,
        always: bool = False,
    ) -> None:
        slave = self._setting(node, writes)
        if slave is None:
            self._call(self._written(node, writes, phase, past), writes.places)
            return
        variables = [node.part.instance.variables[one.target[1]] for one in writes.connections]
        kind, name, of_fmu = _TYPES[variables[0].type]
        count = len(variables)
        every = 1 if always else node.every
        operation = Operation(kind=WRITE, type=kind, every=every, phase=phase, count=count)
        operation.places = self._array(ctypes.c_int64, writes.places)
        operation.numbers = self._array(ctypes.c_double, [0.0] * count)
        operation.values = ctypes.cast(
            operation.numbers if kind == REAL and not past else self._array(of_fmu, [0] * count),
            ctypes.c_void_p,
        )
        operation.scaled = len(writes.scales)
        operation.which = self._array(ctypes.c_int64, [i for i, _, _ in writes.scales])
        operation.factors = self._array(ctypes.c_double, [f for _, f, _ in writes.scales])
        operation.offsets = self._array(ctypes.c_double, [o for _, _, o in writes.scales])
        if past and kind == REAL:
            operation.continuous = len(writes.continuous)
            operation.moving = self._array(ctypes.c_int64, writes.continuous)
            operation.previous = self._array(ctypes.c_double, [0.0] * count)
            self.past[len(self.operations)] = past
        self._ask(operation, node, slave, f"Set{name}", variables)

    def _read(self, node: Node, chunks: Sequence[Chunk], *, always: bool = False) -> None:
        every = 1 if always else node.every
        for chunk in chunks:
            slave = self._getting(node, chunk)
            if slave is None:
                self._call(self._as_read(node, chunk), [], [chunk])
                continue
            names = [name for _, name in self._network.names[chunk.start : chunk.stop]]
            variables = [node.part.instance.variables[name] for name in names]
            number, name, of_fmu = _TYPES[variables[0].type]
            values = ctypes.cast(self._array(of_fmu, [0] * len(names)), ctypes.c_void_p)
            common = {"type": number, "every": every, "phase": 1, "count": len(names)}
            get = Operation(kind=GET, values=values, **common)
            self._ask(get, node, slave, f"Get{name}", variables)
            store = Operation(kind=STORE, values=values, start=chunk.start, **common)
            store.limited = len(chunk.limits)
            store.bounded = self._array(ctypes.c_int64, [i for i, _ in chunk.limits])
            store.limits = self._array(ctypes.c_double, [limit for _, limit in chunk.limits])
            self.chunks[len(self.operations)] = chunk
            self._add(store)

    def _step(self, node: Node, phase: int, start: int) -> None:
        slave, length = self._slave_of(node, "DoStep"), node.every * self._step_ns
        if slave is None:

            def step(steps: int, t_ns: int) -> None:
                if (steps + phase) % node.every == 0:
                    self._network.step(node, t_ns + start, length)

            self._call(step, [])
            return
        times = self.times[node.part.name] = Times(longest_at_ns=-1)
        operation = Operation(kind=STEP, every=node.every, phase=phase, start=start, length=length)
        operation.constant = not node.part.instance.any_step
        operation.never_back = slave.never_back
        operation.times = ctypes.pointer(times)
        self._ask(operation, node, slave, "DoStep", [])

    def _ask(
        self, operation: Operation, node: Node, slave: Slave, function: str, variables: list[Any]
    ) -> None:
        """Add an operation that calls a function of an FMU."""
        operation.function, operation.component = slave.address(function), slave.component
        operation.references = self._array(ctypes.c_uint32, slave.references(variables))
        marks = getattr(node.part.instance, "marks", None)
        if marks is not None:
            operation.mark = marks.codes[Marks.CALLS[operation.kind]]
        self.asked[len(self.operations)] = slave, function
        self._add(operation)

    def _add(self, operation: Operation) -> None:
        self.operations.append(operation)

    # ------------------------------------------------------------------ calls

    def _call(
        self, call: Callable[[int, int], None], fetched: Sequence[int], left: Sequence[Chunk] = ()
    ) -> None:
        """Add a call; those that follow each other are one operation."""
        if not (self.operations and self.operations[-1].kind == CALL):
            self._add(Operation(kind=CALL, every=1, start=len(self.calls)))
            self.calls.append([])
        at = len(self.operations) - 1
        self.calls[-1].append(call)
        self.fetched.setdefault(at, []).extend(fetched)
        self.left.setdefault(at, []).extend(left)

    def _written(
        self, node: Node, writes: Writes, phase: int, past: PastInputs | None
    ) -> Callable[[int, int], None]:
        signals = self._network.signals

        def write(steps: int, _t_ns: int) -> None:
            if (steps + phase) % node.every:
                return
            values = writes.values(signals)
            if past is None:
                writes.write(values)
            else:
                writes.write(ahead(values, past.previous, writes.continuous))
                past.previous = values

        return write

    def _as_read(self, node: Node, chunk: Chunk) -> Callable[[int, int], None]:
        def read(steps: int, _t_ns: int) -> None:
            if (steps + 1) % node.every == 0:
                self._network.read([chunk])

        return read

    # ------------------------------------------------------------------ arrays

    def _array(self, kind: Any, values: Sequence[Any]) -> Any:
        array = (kind * max(1, len(values)))(*values)
        self.kept.append(array)
        return array

    def _setting(self, node: Node, writes: Writes) -> Slave | None:
        """Return the FMU whose inputs C can write: numbers, without tables; else None."""
        variables = [node.part.instance.variables[one.target[1]] for one in writes.connections]
        kind = variables[0].type
        if kind not in _TYPES or writes.mappings or (writes.scales and kind is not float):
            return None
        return self._slave_of(node, f"Set{_TYPES[kind][1]}", variables)

    def _getting(self, node: Node, chunk: Chunk) -> Slave | None:
        """Return the FMU whose outputs C can read: numbers; else None."""
        names = [name for _, name in self._network.names[chunk.start : chunk.stop]]
        variables = [node.part.instance.variables[name] for name in names]
        kind = variables[0].type
        return self._slave_of(node, f"Get{_TYPES[kind][1]}", variables) if kind in _TYPES else None

    def _slave_of(
        self, node: Node, function: str, variables: Sequence[Variable] = ()
    ) -> Slave | None:
        """Return the FMU of a component if C may call its function for variables; else None."""
        instance, name = node.part.instance, node.part.name
        slave: Slave
        if node.part.is_sum:
            slave = self._adapted.setdefault(name, CompiledSum(cast("SumInstance", instance)))
        elif not getattr(instance, "is_native", False):
            return None
        elif hasattr(instance, "in_c"):
            from .fmi3 import CompiledFmi3

            own = cast("Fmi3Slave", instance)
            if not own.in_c(variables):
                return None
            slave = self._adapted.setdefault(name, CompiledFmi3(own))
        else:
            slave = cast("Fmi2Slave", instance)
        return slave if slave.address(function) else None


class Sum(ctypes.Structure):
    """The structure of `master.c`, field by field."""

    _fields_: ClassVar = [
        ("inputs", ctypes.POINTER(ctypes.c_double)),
        ("count", ctypes.c_int64),
        ("terms", ctypes.c_int64),
    ]


class CompiledSum:
    """What `program` asks of an FMU's instance, of a sum."""

    _FUNCTIONS: ClassVar = {"SetReal": "sum_set", "GetReal": "sum_get", "DoStep": "sum_step"}

    never_back = 0
    ended_at = None

    def __init__(self, instance: SumInstance) -> None:
        self.name = instance.name
        inputs = ctypes.cast(instance.inputs, ctypes.POINTER(ctypes.c_double))
        self._sum = Sum(inputs=inputs, count=len(instance.inputs), terms=instance.terms)
        self.component = ctypes.addressof(self._sum)

    def references(self, variables: Sequence[Variable]) -> list[int]:
        """Return the places of variables."""
        return [variable.reference for variable in variables]

    def address(self, function: str) -> int:
        """Return where a function is, 0 if there is none of that name."""
        return function_address(self._FUNCTIONS[function]) if function in self._FUNCTIONS else 0

    def answered(self, function: str, status: int) -> None:
        """Take what a call returned: nothing is ever refused."""

    def stepped(self, t: float, h: float, status: int) -> None:
        """Take what a step returned: nothing is ever refused."""

    def forward(self) -> None:
        """Log what it has said: nothing."""
