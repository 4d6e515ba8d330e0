"""A rig as a component in Python: its master runs within, and what is open is its own."""

from __future__ import annotations

import json
from collections.abc import Mapping
from pathlib import Path
from typing import Any, ClassVar

from seatrial.errors import InputError
from seatrial.fmi.direct import DirectInstance
from seatrial.fmi.instance import Instance
from seatrial.model.component import NS, Component, Input, Output, Parameter
from seatrial.model.ports import Port
from seatrial.model.terminals import Terminal
from seatrial.sim.algorithms import Algorithm
from seatrial.sim.master import Master, Snapshot
from seatrial.sim.rollback import Checkpoint
from seatrial.system.files import Source
from seatrial.system.part import Part
from seatrial.system.references.values import Given
from seatrial.system.rig import EccoEntry, IterationEntry, Rig, RigFile, Scope
from seatrial.system.sums import SumInstance
from seatrial.system.system import Bond, Connection, System

Name = tuple[str, str]


class RigComponent(Component):
    """A rig in the place of one component, as `rig_component` makes it.

    It takes whole multiples of the rig's step. What is set between steps acts as `Master.set` does.
    """

    frozen: ClassVar[Mapping[str, Any]]
    """The rig, as `frozen.frozen` writes it."""
    classes: ClassVar[Mapping[str, type[Component]]]
    """Of the parts, by module and name."""
    algorithm: ClassVar[type[Algorithm]]
    targets: ClassVar[list[list[Name]]]
    """Of each parameter and input, by reference: variables of the parts."""
    published: ClassVar[list[Name]]
    """Of each output, in order: that of a part."""
    transient = frozenset({"name", "_master"})

    def __init__(self, name: str = "rig") -> None:
        super().__init__(name)
        self._master: Master | None = None
        self._acting: list[Any] = []
        """Parameters and inputs as the parts have them."""
        self._places: list[int] = []
        self._has_begun = False

    def start(self, t: float) -> None:
        """Assemble and initialise the rig with the values that there are."""
        self.close()
        master = Master(self._system(), self.now_ns, algorithm=self.algorithm)
        try:
            master.initialise()
        except BaseException:
            master.system.discard()
            raise
        self._master = master
        place = {name: i for i, name in enumerate(master.names)}
        self._places = [place[name] for name in self.published]
        self._acting = self._own()

    def begin(self) -> None:
        """End the initialisation."""
        super().begin()
        self._has_begun = True

    def begin_anew(self) -> None:
        """Return to before the initialisation."""
        super().begin_anew()
        self._has_begun = False

    def step(self, t: float, h: float) -> None:
        """Take as many steps of the rig as fit. Raises InputError if they do not."""
        master, h_ns = self._running(), round(h * NS)
        count = round(h_ns / master.step_ns)
        if abs(h_ns - count * master.step_ns) > 1:  # a host's own sums of steps are not exact
            raise InputError(
                f"{self.name}: a step of {h!r} s is no whole multiple of this rig's, "
                f"{master.step_ns / NS!r} s"
            )
        self._follow()
        while count:
            count -= master.advance(count)

    def outputs(self, t: float) -> None:
        """Pass on what was set, and take over the outputs of the parts."""
        if not self._has_begun and self._own() != self._acting:
            self.start(t)
        self._follow()
        signals = self._running().signals
        self.values[len(self.targets) :] = [signals[place] for place in self._places]

    def close(self) -> None:
        """End the parts and release them."""
        master, self._master = self._master, None
        if master is not None:
            try:
                master.terminate()
            finally:
                master.system.free()

    def get_state(self) -> dict[str, Any]:
        """Return the whole state, with those of the parts, as plain data."""
        master = self._running()
        saved = master.save()
        master.free(saved)  # the parts run in process: their states are plain data
        rest = {"time": saved.time, "faults": saved.faults, "watch": saved.watch}
        return {**super().get_state(), "rig": {**rest, "checkpoint": vars(saved.checkpoint)}}

    def set_state(self, state: Mapping[str, Any]) -> None:
        """Restore what `get_state` returned."""
        saved = state["rig"]
        super().set_state({key: value for key, value in state.items() if key != "rig"})
        point = Checkpoint(**saved["checkpoint"])
        self._running().restore(Snapshot(saved["time"], point, saved["faults"], saved["watch"]))

    # ------------------------------------------------------------------ inside

    def _own(self) -> list[Any]:
        return self.values[: len(self.targets)]

    def _running(self) -> Master:
        if self._master is None:
            raise InputError(f"{self.name}: the rig has not started")
        return self._master

    def _follow(self) -> None:
        """Set in the parts what was set here since."""
        if self._own() == self._acting:
            return
        changed: dict[str, dict[str, Any]] = {}
        for reference, (old, new) in enumerate(zip(self._acting, self._own(), strict=True)):
            if old != new:
                for component, name in self.targets[reference]:
                    changed.setdefault(component, {})[name] = new
        for component, values in changed.items():
            self._running().set(component, list(values), list(values.values()))
        self._acting = self._own()

    def _system(self) -> System:
        """Return the rig assembled, its parts given the values of here."""
        frozen = self.frozen
        system = System(_rig(frozen), "direct", 0, None)
        for one in frozen["parts"]:
            given = {name: Given(value, "the rig") for name, value in one["given"].items()}
            instance = _instance(one, self.classes)
            system.parts[one["name"]] = Part(
                one["name"], one["class"], instance, "", "", one["every"], given,
                is_sum=one["sum"] is not None,
            )  # fmt: skip
        for reference, names in enumerate(self.targets):
            for component, name in names:
                given = system.parts[component].given
                given[name] = Given(self.values[reference], f"{self.name}")
        system.connections = [_connection(one) for one in frozen["connections"]]
        system.bonds = [_bond(*one) for one in frozen["bonds"]]
        system.initial = [_connection(one) for one in frozen["initial"]]
        return system


def rig_component(
    text: str, classes: Mapping[str, type[Component]], algorithm: type[Algorithm]
) -> type[RigComponent]:
    """Return the component of a frozen rig, whose parts are of ``classes``."""
    frozen = json.loads(text)
    targets = {name: [(c, n) for c, n in names] for name, names in frozen["targets"].items()}
    ports = {one["name"]: _port(one) for one in frozen["ports"]}
    settable = [
        name for kind in ("parameter", "input") for name, p in ports.items() if p.kind == kind
    ]
    members: dict[str, Any] = {
        **ports,
        "__doc__": frozen["title"],
        "frozen": frozen,
        "classes": classes,
        "algorithm": algorithm,
        "targets": [targets[name] for name in settable],
        "published": [targets[name][0] for name, port in ports.items() if port.kind == "output"],
        "feedthrough": {
            name: tuple(frozen["through"].get(name, ()))
            for name, port in ports.items()
            if port.kind == "output"
        },
        "rolls_back": frozen["rolls_back"],
        "discrete": frozen["discrete"],
        "fixed_step": frozen["fixed_step"],
    }
    made: type[RigComponent] = type("Rig", (RigComponent,), members)
    # Members may be several ports, and sums of inputs here: a class of its own declares neither.
    made.terminals = {name: Terminal(*one) for name, one in frozen["terminals"].items()}
    return made


def _port(one: Mapping[str, Any]) -> Port:
    common = {key: one[key] for key in ("min", "max", "nominal", "role")}
    if one["kind"] == "parameter":
        return Parameter(
            one["start"], one["unit"], one["description"], tunable=one["tunable"], **common
        )
    kind: type = {"float": float, "int": int, "bool": bool, "str": str}[one["type"]]
    if one["kind"] == "output":
        return Output(one["unit"], one["description"], type=kind, **common)
    port = Input(
        one["unit"],
        one["description"],
        type=kind,
        start=one["start"],
        optional=one["optional"],
        **common,
    )
    port.term_of = one["term_of"]
    return port


def _rig(frozen: Mapping[str, Any]) -> Rig:
    iteration, ecco = frozen["iteration"], frozen["ecco"]
    file = RigFile(
        title=frozen["title"],
        step=frozen["step"],
        algorithm=frozen["algorithm"],
        iteration=None if iteration is None else IterationEntry(**iteration),
        ecco=None if ecco is None else EccoEntry(**ecco),
        components={},
    )
    source = Source(frozen["name"], Path(frozen["name"]), "")
    return Rig(file, source, Scope("", file, source, Path(), {}, {}))


def _instance(one: Mapping[str, Any], classes: Mapping[str, type[Component]]) -> Instance:
    if one["sum"] is not None:
        return SumInstance(one["name"], *one["sum"])
    # A host need not have a compiler, nor a place for what one makes.
    return DirectInstance(classes[one["class"]](one["name"]), compiles=False)


def _bond(name: str, pairs: list[Any]) -> Bond:
    return Bond(name, tuple((tuple(one), tuple(other)) for one, other in pairs))


def _connection(one: list[Any]) -> Connection:
    source, target, factor, offset, to_real, mapping = one
    return Connection(tuple(source), tuple(target), factor, offset, to_real, dict(mapping))
