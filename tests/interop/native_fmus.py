"""All native components as FMUs, and what each does in Python when it gets some inputs."""

from __future__ import annotations

import fcntl
import random
from dataclasses import dataclass
from functools import cache, cached_property
from pathlib import Path
from typing import Any

import fmpy

from seatrial.fmi.cache import cache_folder
from seatrial.fmi.compiler import library_here
from seatrial.fmi.components.index import component_class, components
from seatrial.fmi.components.source import find_source
from seatrial.model.component import Component
from seatrial.model.faults.text import FAILURES, fault_text
from seatrial.model.plant import Plant
from seatrial_kits.native.carriers import why_python
from seatrial_kits.native.export import build_native_fmu

H, STEPS = 0.05, 40
CHANGES = (5, 15, 30)
"""Steps before which inputs change; texts change in the second."""

DRIVER = Path(__file__).parents[1] / "fmi" / "slaves" / "driver.c"
HEADERS = Path(fmpy.__file__).parent / "c-code"


_MORE = {
    "wind": {"intensity": 0.2, "direction_deviation": 0.3, "gust_size": 0.5, "gust_start": 1.0}
}


@cache
def native_names() -> list[str]:
    """Return the components that have C."""
    return [n for n in components().names() if not why_python(component_class(n))]


def start_values(name: str) -> dict[str, Any]:
    """Return values with which everything in a component acts, but for its surroundings."""
    cls = component_class(name)
    ports, plant = cls.ports, issubclass(cls, Plant)
    allowed = {n for n, p in ports.items() if not (p.role if plant else p.role == "sea")}
    own = {n: v for n, v in cls.exercised.items() if n in allowed}
    return {**own, **_MORE.get(name, {})}


def moved(drawn: random.Random, start: float) -> float:
    """Return a value of an input, by a fifth or so from its start: a pulse remains a pulse."""
    return start + drawn.uniform(-0.2, 0.2) * (abs(start) or 1.0)


@dataclass(frozen=True)
class Change:
    """An input that has another value from a step on."""

    step: int
    name: str
    reference: int
    type: type
    value: Any


@dataclass(frozen=True)
class Case:
    """A native FMU with inputs."""

    name: str

    @property
    def cls(self) -> type[Component]:
        return component_class(self.name)

    @cached_property
    def path(self) -> Path:
        """The FMU, built once for all workers of a run."""
        source = find_source(self.name, Path.cwd())
        path = cache_folder("hosts") / f"{source.stem}.fmu"
        with path.with_suffix(".lock").open("w") as lock:
            fcntl.flock(lock, fcntl.LOCK_EX)
            if not path.is_file():
                build_native_fmu(source, path, ("linux64",), start_values(self.name), library_here)
        return path

    @cached_property
    def guid(self) -> str:
        return str(fmpy.read_model_description(str(self.path), validate=False).guid)

    @cached_property
    def outputs(self) -> list[Any]:
        return [s for s in self.cls.scalars if s.port.kind == "output"]

    @cached_property
    def changes(self) -> list[Change]:
        drawn, found = random.Random(self.name), []
        for step in CHANGES:
            for scalar in self.cls.scalars:
                port = scalar.port
                if port.kind == "input" and (port.type is not str or step == CHANGES[1]):
                    value = self._value(drawn, port, scalar.index)
                    found.append(Change(step, scalar.name, scalar.reference, port.type, value))
        return found

    def _value(self, drawn: random.Random, port: Any, index: int) -> Any:
        if port.type is float:
            return moved(drawn, port.start[index])
        if port.type is int:
            return drawn.randrange(3)
        if port.type is bool:
            return drawn.random() < 0.8
        if port.role != "fault":
            return drawn.choice(port.choices)
        measured = getattr(self.cls, "measured", ())
        bias = [fault_text("bias", m.name, {"value": [0.25] * m.size}, 1.0, 0.5) for m in measured]
        return drawn.choice([*FAILURES, *bias])

    def starts(self, names: list[str]) -> list[float]:
        """Return the values that inputs start with, in the FMU."""
        component = self._made()
        return [component.values[component.scalar_by_name[name].reference] for name in names]

    def _made(self) -> Component:
        component = self.cls("x")
        for port, value in start_values(self.name).items():
            component.set(port, value)
        return component

    def python(self, changes: list[Change]) -> list[list[float]]:
        """Return the outputs after each step, of the component in Python."""
        component = self._made()
        component.setup(0.0)
        component.initialise()
        component.begin()
        rows = []
        for k in range(STEPS):
            for it in changes:
                if it.step == k:
                    component.write([it.reference], [it.value], it.type)
            component.advance(component.now, H)
            values = [component.read([s.reference], s.port.type)[0] for s in self.outputs]
            rows.append([float(value) for value in values])
        return rows

    def job(self, library: str) -> str:
        """Return what the driver reads."""
        lines = [f"fmu {library} {self.guid}"]
        for it in self.changes:
            text = it.value.hex() if it.type is float else it.value
            text = int(text) if it.type is bool else text
            lines.append(f"set {it.step} {it.type.__name__[:1]} {it.reference} {text}")
        lines += [f"get {s.port.type.__name__[:1]} {s.reference}" for s in self.outputs]
        return "\n".join([*lines, f"run {H} {STEPS}", ""])
