"""Dependencies of outputs, found: against what a change of the inputs shows."""

import random
from typing import Any

import pytest

from seatrial.fmi.dependencies.found import found
from seatrial.model.component import Component
from tests.fmi import dependent_parts

PARTS = [one for one in vars(dependent_parts).values() if getattr(one, "truth", None)]


@pytest.mark.parametrize("cls", PARTS, ids=lambda cls: cls.__name__)
def test_dependencies_are_found_output_by_output(cls: Any) -> None:
    answer = found(cls)
    inputs = {name for name, port in cls.ports.items() if port.kind == "input"}
    assert bool(answer.undecided) == cls.unknown, answer.undecided
    for output, names in cls.truth.items():
        more = cls.more.get(output, "")
        expected = inputs if cls.unknown else {*names.split(), *more.split()}
        assert set(answer.through[output]) == expected, output


@pytest.mark.parametrize("cls", PARTS, ids=lambda cls: cls.__name__)
def test_what_is_written_here_as_true_is_what_changes(cls: Any) -> None:
    # So that the truths above are Python's, and not ours.
    assert changing(cls) == {output: set(names.split()) for output, names in cls.truth.items()}


def changing(cls: type[Component], points: int = 60) -> dict[str, set[str]]:
    """Return the inputs that change outputs at the same instant, by trying."""
    draw, component = random.Random(3), cls("part")
    component.setup(0.0)
    component.initialise()
    component.begin()
    changes: dict[str, set[str]] = {n: set() for n, p in cls.ports.items() if p.kind == "output"}
    inputs = [port for port in cls.ports.values() if port.kind == "input"]

    def drawn(port: Any) -> Any:
        if port.type is str:
            return str(draw.random())
        return [draw.uniform(-2.0, 2.0) for _ in range(port.size)]

    def put(port: Any, value: Any) -> None:
        component.set(port.name, value if port.axes or port.type is str else value[0])

    for point in range(points):
        at = {port.name: drawn(port) for port in inputs}
        for port in inputs:
            put(port, at[port.name])
        before = {output: component.get(output) for output in changes}
        for port in inputs:
            put(port, drawn(port))
            for output, value in before.items():
                if component.get(output) != value:
                    changes[output].add(port.name)
            put(port, at[port.name])
        component.advance(point * 0.01, 0.01)
    return changes
