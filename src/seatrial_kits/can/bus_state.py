"""The state of a simulated bus as plain data."""

from __future__ import annotations

from dataclasses import fields
from typing import Any

from .controller import Controller, Request
from .frame import Frame
from .operations import Error, Transmit, decode, encode
from .simulated_bus import Attempt, SimulatedBus

_BUS = ("now_ps", "free_ps", "taken_ps", "attempts", "requests", "counted_ps")
_LISTS = ("queue", "ready")
_NUMBERS = tuple(f.name for f in fields(Controller) if f.name not in (*_LISTS, "name", "sending"))
_ATTEMPT = ("start_ps", "end_ps", "first", "missed_by")
_NODES = ("senders", "losers", "gave_way")


def saved(bus: SimulatedBus) -> dict[str, Any]:
    """Return all that changes while a bus runs."""
    return {
        **{name: getattr(bus, name) for name in _BUS},
        "arriving": [[when, node, _plain(request)] for when, _, node, request in bus.arriving],
        "controllers": [_plain_controller(each) for each in bus.controllers],
        "attempt": None if bus.attempt is None else _plain_attempt(bus.attempt),
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
        sending = values["sending"]
        controller.sending = None if sending is None else _request(sending)
    bus.attempt = None if state["attempt"] is None else _attempt(state["attempt"])


def _plain_controller(each: Controller) -> dict[str, Any]:
    return {
        **{name: getattr(each, name) for name in _NUMBERS},
        **{name: [_plain(request) for request in getattr(each, name)] for name in _LISTS},
        "sending": None if each.sending is None else _plain(each.sending),
    }


def _plain_attempt(attempt: Attempt) -> dict[str, Any]:
    return {
        **{name: getattr(attempt, name) for name in _ATTEMPT},
        **{name: list(getattr(attempt, name)) for name in _NODES},
        "frame": _text(attempt.frame),
        "error": None if attempt.error is None else int(attempt.error),
    }


def _attempt(plain: dict[str, Any]) -> Attempt:
    senders, losers, gave_way = (list(plain[name]) for name in _NODES)
    return Attempt(
        plain["start_ps"],
        plain["end_ps"],
        _frame(plain["frame"]),
        senders,
        losers,
        gave_way,
        None if plain["error"] is None else Error(plain["error"]),
        plain["first"],
        plain["missed_by"],
    )


def _plain(request: Request) -> list[Any]:
    return [request.priority, request.number, request.requested_ps, _text(request.frame)]


def _request(plain: list[Any]) -> Request:
    priority, number, requested_ps, text = plain
    return Request(priority, number, requested_ps, _frame(text))


def _text(frame: Frame) -> str:
    return encode(Transmit(frame)).hex()


def _frame(text: str) -> Frame:
    (operation,) = decode(bytes.fromhex(text))
    assert isinstance(operation, Transmit)
    return operation.frame
