"""Mistakes that would change nothing but the numbers: they are refused where a component is built."""

from __future__ import annotations

from typing import Any, ClassVar

import pytest

from seatrial.errors import InputError
from seatrial.fmi.components.index import component_class, components
from seatrial.fmi.dependencies.checked import check, refuse_dependent
from seatrial.model.component import Component, Input, Output, Parameter


class Base(Component):
    u = Input("1", "in")
    v = Input("1", "another")
    force = Output("N", "out")


class Denies(Base):
    feedthrough: ClassVar = {"force": ("v",)}

    def outputs(self, t: float) -> None:
        self.force = 2.0 * self.u + self.v


class DeniesInABranch(Base):
    feedthrough: ClassVar = {"force": ()}

    def outputs(self, t: float) -> None:
        self.force = 1.0 if self.u > 0.0 else 2.0


class Narrows(Base):
    feedthrough: ClassVar = {"force": ("v",)}

    def outputs(self, t: float) -> None:
        self.force = 0.0 * self.u + self.v


class NarrowsUnknown(Base):
    feedthrough: ClassVar = {"force": ("v",)}

    def outputs(self, t: float) -> None:
        self.force = self.values[self.ports["v"].offset]


@pytest.mark.parametrize("cls", [Denies, DeniesInABranch])
def test_a_declaration_that_denies_what_acts_is_refused_with_values(cls: type[Component]) -> None:
    with pytest.raises(
        InputError,
        match=rf"{cls.__name__}.feedthrough says that 'force' does not depend on 'u', but at the "
        r"same instant force is \S+ with u = \S+ and \S+ with u = \S+",
    ):
        refuse_dependent(cls)


@pytest.mark.parametrize("cls", [Narrows, NarrowsUnknown])
def test_a_declaration_may_say_less_than_the_text(cls: type[Component]) -> None:
    known = check(cls)
    assert known.through == {"force": ("v",)}
    assert known.undecided == ""


def test_what_reaches_outside_is_not_started_for_a_check() -> None:
    class Outside(Denies):
        rolls_back = False

        def start(self, t: float) -> None:
            raise AssertionError("started")

    refuse_dependent(Outside)


class NeverSet(Base):
    def outputs(self, t: float) -> None:
        self.forse = self.u


class Reads(Base):
    speed = Input("m/s", "speed")

    def outputs(self, t: float) -> None:
        self.force = self.sped


class SetsBeside(Base):
    def outputs(self, t: float) -> None:
        self.force = 0.0
        if self.u > 1.0:
            self.forces = self.u


class Quiet(Base):
    def step(self, t: float, h: float) -> None:
        self._x = self.u


@pytest.mark.parametrize(
    ("cls", "said"),
    [
        (NeverSet, r"nothing sets the output 'force'; test_mistakes.py, line \d+, has self.forse"),
        (Reads, r"line \d+, reads self.sped, which nothing sets; did you mean the input 'speed'\?"),
        (SetsBeside, r"sets self.forces, which nothing reads; did you mean the output 'force'\?"),
        (Quiet, r"Quiet: nothing sets the output 'force'"),
    ],
)
def test_a_name_that_is_nearly_a_ports_is_refused(cls: type[Component], said: str) -> None:
    with pytest.raises(InputError, match=said):
        check(cls)


class Own(Base):
    forces: list[float]
    gain = Parameter(1.0, "1", "gain")

    def start(self, t: float) -> None:
        self.forced, self._force, self.gains = 0.0, 1.0, [self.gain]

    def outputs(self, t: float) -> None:
        self.gains.append(self.forced)
        for name in ("force",):
            setattr(self, name, self._force)


class SetByName(Base):
    def outputs(self, t: float) -> None:
        self.set("force", 1.0)


class Mixed:
    def put(self: Any, value: float) -> None:
        self.force = value


class SetByAMixin(Mixed, Base):
    def outputs(self, t: float) -> None:
        self.put(self.u)


class Constant(Component):
    y = Output("1", "always", start=3.0)


def into(part: Any) -> None:
    part.force = part.u


class SetElsewhere(Base):
    def outputs(self, t: float) -> None:
        into(self)


class SetInOneBranch(Base):
    def outputs(self, t: float) -> None:
        if self.u > 0.0:
            self.force += 1.0


@pytest.mark.parametrize(
    "cls", [Own, SetByName, SetByAMixin, Constant, SetElsewhere, SetInOneBranch]
)
def test_attributes_of_ones_own_are_no_mistakes(cls: type[Component]) -> None:
    check(cls)


@pytest.mark.sampled(5)
@pytest.mark.parametrize("name", components().names())
def test_of_every_shipped_component_it_is_known_what_acts_at_once(name: str) -> None:
    assert check(component_class(name)).undecided == ""
