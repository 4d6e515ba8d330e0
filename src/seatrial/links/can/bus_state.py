"""The state of a simulated bus as plain data."""

from __future__ import annotations

from dataclasses import fields
from typing import Any

from .controller import Controller, Request
from .operations import Transmit, decode, encode
from .simulated_bus import SimulatedBus

_BUS = ("now_ps", "free_ps", "busy_ps", "attempts", "requests", "counted_ps")
_LISTS = ("queue", "ready")
_NUMBERS = tuple(f.name for f in fields(Controller) if f.name not in (*_LISTS, "name"))


def saved(bus: SimulatedBus) -> dict[str, Any]:
    """Return all that changes while a bus runs."""
    return {
        **{name: getattr(bus, name) for name in _BUS},
        "arriving": [[when, node, _plain(request)] for when, _, node, request in bus.arriving],
        "controllers": [
            {
                **{name: getattr(each, name) for name in _NUMBERS},
                **{name: [_plain(request) for request in getattr(each, name)] for name in _LISTS},
            }
            for each in bus.controllers
        ],
    }


def restore(bus: SimulatedBus, state: dict[str, Any]) -> None:
    """Bring a bus of the same nodes back to what `saved` returned."""
    for name in _BUS:
        setattr(bus, name, state[name])
    requests = [(when, node, _request(plain)) for when, node, plain in state["arriving"]]
    bus.arriving = [(when, each.number, node, each) for when, node, each in requests]
    for controller, values in zip(bus.controllers, state["controllers"], strict=True):
        for name in _NUMBERS:
            setattr(controller, name, values[name])
        controller.queue.clear()
        controller.queue.extend(_request(plain) for plain in values["queue"])
        controller.ready[:] = [_request(plain) for plain in values["ready"]]


def _plain(request: Request) -> list[Any]:
    frame = encode(Transmit(request.frame)).hex()
    return [request.priority, request.number, request.asked_ps, frame]


def _request(plain: list[Any]) -> Request:
    priority, number, asked_ps, text = plain
    (operation,) = decode(bytes.fromhex(text))
    assert isinstance(operation, Transmit)
    return Request(priority, number, asked_ps, operation.frame)
