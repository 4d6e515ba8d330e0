"""Tables of C of a rig as one FMU: its components, operations and variables, as in `rig.h`."""

from __future__ import annotations

import ctypes
from collections.abc import Iterable, Mapping, Sequence
from typing import Any

from seatrial.sim.compiled.program import Program
from seatrial.sim.compiled.structures import GET, LOOP, STEP, STORE, WRITE, Operation
from seatrial.sim.network import Network
from seatrial_kits.native.tables import quoted

from .face import Face

_SIZES = """\
/* Sizes of a rig as one FMU. */
#define RIG_GUID "{guid}"
#define STEP_NS INT64_C({step_ns})
enum {{
    NODES = {nodes}, SIGNALS = {signals}, BUFFER = {buffer}, PREVIOUS = {previous}, LOOPS = {loops},
    SETTLING = {settling}, EXCHANGE = {exchange}, STEPS = {steps}, VISITS = {visits},
    OPERATIONS = {operations}, VARIABLES = {variables}, GIVEN = {given},
    FOLLOWS_AT_ONCE = {at_once}
}};
"""
_TYPES = {float: "REAL_TYPE", int: "INTEGER_TYPE", bool: "BOOLEAN_TYPE", str: "STRING_TYPE"}


class RigTables:
    """The tables of an initialised rig; ``carriers`` name the C of each of its components."""

    def __init__(
        self,
        network: Network,
        program: Program,
        begins: Mapping[str, int],
        face: Face,
        carriers: Mapping[str, str],
    ) -> None:
        self._network, self._program, self._begins, self._face = network, program, begins, face
        self._carriers = carriers
        self._nodes = {name: i for i, name in enumerate(network.nodes)}
        self._references: list[int] = []
        self._places: list[int] = []
        self._numbers: list[float] = []
        self._reals: list[int] = []
        self._buffer, self._previous = _Places(), _Places()
        """Of values on their way, and of those that an instance has from the step before."""
        self._rows = [self._row(at, one) for at, one in enumerate(program.operations)]
        self._targets: list[str] = []
        self._variables = [self._variable(name) for name in face.variables]
        self._given = list(self._values_given())

    def sizes(self, guid: str, step_ns: int, *, at_once: bool) -> str:
        """Return ``sizes.h``."""
        return _SIZES.format(
            guid=guid,
            step_ns=step_ns,
            nodes=len(self._nodes),
            signals=len(self._network.signals),
            buffer=self._buffer.size,
            previous=self._previous.size,
            loops=len(self._program.loops),
            settling=self._begins["settling"],
            exchange=self._begins["exchange"],
            steps=self._begins["steps"],
            visits=self._begins["visits"],
            operations=len(self._rows),
            variables=len(self._variables),
            given=len(self._given),
            at_once=int(at_once),
        )

    def text(self) -> str:
        """Return ``tables.c``."""
        externs = sorted(set(self._carriers.values()))
        numbers = [repr(v).replace("inf", "INFINITY") for v in self._numbers]
        signals = [quoted(".".join(name)) for name in self._network.names]
        return "\n".join(
            [
                '#include <math.h>\n\n#include "rig.h"\n',
                *(f"extern const Carrier {name};" for name in externs),
                _table("uint32_t", "references", map(str, self._references)),
                _table("int64_t", "places", map(str, self._places)),
                _table("double", "numbers", numbers),
                _table("uint8_t", "reals", map(str, self._reals)),
                _table("Node", "nodes", self._node_rows()),
                _table("Row", "rows", self._rows),
                _table("Target", "targets", self._targets),
                _table("Variable", "variables", self._variables),
                _table("Given", "given", self._given),
                _table("char *const", "names", map(quoted, self._face.variables)),
                _table("char *const", "signals", signals),
                "",
            ]
        )

    def _node_rows(self) -> Iterable[str]:
        lasts = [*(self._begins[f"read {name}"] for name in self._nodes), self._begins["settling"]]
        for i, (name, node) in enumerate(self._network.nodes.items()):
            first, last = lasts[i], lasts[i + 1]
            yield f"{{&{self._carriers[name]}, {quoted(name)}, {node.every}, {first}, {last}}}"

    # ------------------------------------------------------------------ operations

    def _row(self, at: int, o: Operation) -> str:
        node = -1
        if o.kind in (WRITE, STEP, GET):
            node = self._nodes[self._program.asked[at][0].name]
        fields: dict[str, Any] = {"kind": o.kind, "type": o.type, "node": node}
        fields |= {"every": o.every, "phase": o.phase, "count": o.count}
        fields |= {"start": o.start, "length": o.length}
        if o.kind in (WRITE, GET):
            fields["references"] = _pooled(self._references, o.references[: o.count])
        if o.kind in (WRITE, LOOP):
            fields["places"] = _pooled(self._places, o.places[: o.count])
        fields["numbers"] = self._buffer.of(o.numbers, o.count * (2 if o.kind == LOOP else 1))
        fields["values"] = self._buffer.of(o.values, o.count)
        fields["previous"] = self._previous.of(o.previous, o.count)
        if o.kind == WRITE and o.scaled:
            scales = self._pair(o.which, o.scaled, o.factors, o.offsets)
            fields |= {"scaled": o.scaled, "scales": scales}
        if o.kind == WRITE and o.continuous:
            fields["continuous"] = o.continuous
            fields["moving"] = _pooled(self._places, o.moving[: o.continuous])
        if o.kind == STORE and o.limited:
            fields |= {"limited": o.limited, "bounds": self._pair(o.bounded, o.limited, o.limits)}
        if o.kind == LOOP:
            fields["reals"] = _pooled(self._reals, o.reals[: o.count])
            fields["loop"] = list(self._program.loops).index(at)
        return "{" + ", ".join(f".{name} = {value}" for name, value in fields.items()) + "}"

    def _pair(self, which: Any, count: int, *numbers: Any) -> int:
        """Add places, and numbers of each, which begin at the same index; return it."""
        begin = max(len(self._places), len(self._numbers))
        self._places += [0] * (begin - len(self._places)) + which[:count]
        self._numbers += [0.0] * (begin - len(self._numbers))
        self._numbers += [value for each in numbers for value in each[:count]]
        return begin

    # ------------------------------------------------------------------ variables

    def _variable(self, name: str) -> str:
        variable = self._face.variables[name]
        targets = self._face.targets[name]
        if variable.causality == "output":
            place, node = self._network.places[targets[0]], self._nodes[targets[0][0]]
            return f"{{{_TYPES[variable.type]}, OUTPUT_VALUE, {place}, {node}, 0, 0}}"
        kind = "PARAMETER_VALUE"
        if variable.causality == "input":
            continuous = variable.variability == "continuous"
            kind = "CONTINUOUS_INPUT" if continuous else "OTHER_INPUT"
        first = len(self._targets)
        for component, own in targets:
            reference = self._network.nodes[component].part.instance.variables[own].reference
            self._targets.append(f"{{{self._nodes[component]}, {reference}}}")
        return f"{{{_TYPES[variable.type]}, {kind}, -1, -1, {first}, {len(targets)}}}"

    def _values_given(self) -> Iterable[str]:
        """Yield the start values that are not the components' own."""
        for number, (name, variable) in enumerate(self._face.variables.items()):
            component, own = self._face.targets[name][0]
            part = self._network.nodes[component].part
            if variable.causality == "output" or own not in part.given:
                continue
            value = part.given[own].value
            if isinstance(value, str):
                yield f"{{{number}, 0.0, {quoted(value)}}}"
            else:
                yield f"{{{number}, {float(value)!r}, 0}}"


class _Places:
    """Arrays one behind the other, each once."""

    def __init__(self) -> None:
        self.size = 0
        self._known: dict[int, int] = {}

    def of(self, pointer: Any, count: int) -> int:
        """Return where an array begins, the same for the same array; -1 for none."""
        address = ctypes.cast(pointer, ctypes.c_void_p).value
        if not address:
            return -1
        if address not in self._known:
            self._known[address] = self.size
            self.size += max(1, count)
        return self._known[address]


def _pooled(pool: list[Any], values: Sequence[Any]) -> int:
    pool += values
    return len(pool) - len(values)


def _table(kind: str, name: str, cells: Iterable[str]) -> str:
    """Return a table of C; an empty one has a cell all the same."""
    nothing = "{0}" if kind[0].isupper() else "0"
    rows = ",\n    ".join(cells) or nothing
    return f"const {kind} rig_{name}[] = {{\n    {rows}\n}};"
