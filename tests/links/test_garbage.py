"""Garbage at every component that reads bytes: counted or passed over, never fatal, and no output."""

from __future__ import annotations

import random

import pytest

from seatrial.fmi.components.index import component_class, components
from seatrial.links.text import Outbox
from seatrial.model.component import Component
from seatrial_kits.can.frame import Frame
from seatrial_kits.can.operations import Transmit, encode
from seatrial_kits.gprs import segments
from seatrial_kits.gprs.base_station import BaseStation


def readers() -> list[str]:
    """Return the components that take bytes in, from other components."""
    classes = {name: component_class(name) for name in components().names()}
    return [
        name
        for name, cls in classes.items()
        if cls.rolls_back
        and any(p.kind == "input" and p.role == "bytes" for p in cls.ports.values())
    ]


def started(name: str) -> Component:
    cls = component_class(name)
    component = cls(name)
    for key, value in cls.exercised.items():
        component.set(key, value)
    component.setup(0.0)
    component.initialise()
    component.begin()
    return component


def garbage(cls: type[Component], port: str, chance: random.Random) -> bytes:
    """Return noise: on a bus in frames, from a network in segments, which are themselves good."""
    data = chance.randbytes(chance.randint(0, 40))
    if "bus" in cls.terminals:
        extended = chance.random() < 0.8
        identifier = chance.getrandbits(29 if extended else 11)
        return encode(Transmit(Frame(identifier, data[:8], extended)))
    if cls is BaseStation or port == "downlink":
        return segments.encode(segments.Segment(chance.choice("OARDKC"), 1, data))
    return data


@pytest.mark.parametrize("name", readers())
@pytest.mark.parametrize("seed", range(3))
def test_garbage_is_no_end(name: str, seed: int) -> None:
    chance, component = random.Random(seed), started(name)
    ports = [p for p in component.ports.values() if p.kind == "input" and p.role == "bytes"]
    scalars = [scalar for port in ports for scalar in port.scalar_names]
    boxes: dict[str, dict[str, object]] = {scalar: {} for scalar in scalars}
    for k in range(200):
        for scalar in scalars:
            box = Outbox(boxes[scalar])
            box.put(k * 10_000_000, garbage(type(component), scalar, chance))
            component.set(scalar, box.flush())
        component.advance(k * 0.01, 0.01)
    component.close()
