"""Declarations of a component's class, collected and checked when the class is made."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

from .ports import VIEWS, Parameter, Port, ScalarPort
from .terminals import Terminal
from .terms import Terms


def declared_ports(cls: type) -> dict[str, Port]:
    """Return the ports that a class and its bases declare, the nearest declaration of each."""
    ports: dict[str, Port] = {}
    others = {"name", "values"}
    for base in reversed(cls.__mro__):
        # A component class also holds placed copies of inherited ports: they declare nothing.
        own = vars(base).get("_declared", vars(base))
        for name, value in vars(base).items():
            if not isinstance(value, Port):
                others.add(name)
            elif name in own:
                ports.pop(name, None)
                ports[name] = value
            if name in ports and name in others:
                raise TypeError(f"{cls.__name__}.{name} is a port and something else too")
            if name in ports and ports[name].name != name:
                raise TypeError(f"{cls.__name__}.{name} is the same port as {ports[name].name}")
    return ports


def declared_terms(cls: type) -> dict[str, Terms]:
    """Return the inputs that sum, of a class and its bases, by name."""
    of_bases = [vars(base) for base in reversed(cls.__mro__)]
    return {n: v for base in of_bases for n, v in base.items() if isinstance(v, Terms)}


def with_terms(
    feedthrough: Mapping[str, Sequence[str]], terms: Mapping[str, Terms]
) -> dict[str, tuple[str, ...]]:
    """Return feed-through with the terms of each sum in the place of its name."""
    return {
        output: tuple(name for i in inputs for name in (terms[i].names if i in terms else (i,)))
        for output, inputs in feedthrough.items()
    }


def check_feedthrough(
    owner: str, ports: Mapping[str, Port | Terms], feedthrough: Mapping[str, Sequence[str]]
) -> None:
    """Raise TypeError where ``feedthrough`` names what is no output, or no input."""
    for output, inputs in feedthrough.items():
        if isinstance(inputs, str):
            raise TypeError(f"{owner}.feedthrough[{output!r}]: a list of names is needed")
        for name, kind in [(output, "output"), *((i, "input") for i in inputs)]:
            if name not in ports or ports[name].kind != kind:
                raise TypeError(f"{owner}.feedthrough names {name!r}: no such {kind}")


def check_views(owner: str, views: Mapping[str, Mapping[str, str]]) -> None:
    """Raise TypeError for a view that is none of `ports.VIEWS`, with its ports."""
    for kind, ports in views.items():
        if kind not in VIEWS or set(ports) != set(VIEWS[kind]):
            raise TypeError(f"{owner}.views: {kind!r} is none of {VIEWS}, with its ports")


def check_terminals(
    owner: str, terminals: Mapping[str, Terminal], named: Mapping[str, Any], terms: Sequence[str]
) -> None:
    """Raise TypeError for a terminal called as a port, or a member that is none.

    ``named`` has ports and scalars, ``terms`` the names of the inputs that sum. A parameter that
    is not tunable may be called as a terminal: nothing is connected to it.
    """
    for name, terminal in terminals.items():
        if name in terms or (name in named and not _is_fixed(named[name])):
            raise TypeError(f"{owner}.{name} is a port and a terminal too")
        for member, port in terminal.members.items():
            if port not in named and port not in terms:
                raise TypeError(f"{owner}.terminals[{name!r}][{member!r}]: no port {port!r}")


def _is_fixed(named: Port | ScalarPort) -> bool:
    port = named.port if isinstance(named, ScalarPort) else named
    return isinstance(port, Parameter) and not port.tunable
