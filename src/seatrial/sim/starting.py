"""Start of a run: parameters set, components started, connections solved at the start time."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any

from ..model.component import NS
from ..system.part import Part
from ..system.system import System
from .feedthrough import Feedthrough
from .network import Network
from .node import Node


def start(system: System, network: Network, start_ns: int, stop_ns: int | None) -> Feedthrough:
    """Start every component and let all values agree; return the feed-through of the network.

    Raises SimulationError if a component refuses or a feed-through loop has no solution.
    """
    span = start_ns / NS, math.inf if stop_ns is None else stop_ns / NS
    nodes = network.nodes.values()
    for node in nodes:
        given = node.part.given
        node.part.instance.set_start({name: one.value for name, one in given.items()})
    early = [node for node in nodes if not node.part.instance.at_once]
    for node in early:
        node.part.instance.initialise(*span)
    for node in early:
        _give_again(node.part)
    feedthrough = Feedthrough(network)
    _start_late([node for node in nodes if node.part.instance.at_once], network, feedthrough, span)
    _settle(network, feedthrough)
    _carry_initial(system, network, feedthrough)
    for node in nodes:
        node.part.instance.begin()
    _settle(network, feedthrough)
    return feedthrough


def _start_late(
    late: Sequence[Node], network: Network, feedthrough: Feedthrough, span: tuple[float, float]
) -> None:
    """Initialise one by one what takes its inputs in one call, with the others' values.

    One that feeds others comes first; of a loop of such components, the first one written.
    """
    nodes, waiting = network.nodes, [node.part.name for node in late]
    while waiting:
        started = [name for name in nodes if name not in waiting]
        _settle(network, feedthrough.among(started), started)
        free = [name for name in waiting if nodes[name].fed_by.isdisjoint(waiting)]
        node = nodes[(free or waiting)[0]]
        network.write(node)
        node.part.instance.initialise(*span)
        _give_again(node.part)
        waiting.remove(node.part.name)


def _carry_initial(system: System, network: Network, feedthrough: Feedthrough) -> None:
    """Carry calculated parameters to what they feed, until one that follows another does."""
    parts, made = system.parts, system.initial
    reads = [parts[one.source[0]].instance.reader([one.source[1]]) for one in made]
    writes = [parts[one.target[0]].instance.writer([one.target[1]]) for one in made]
    before: list[Any] = []
    for _ in range(len(made) + 1):
        values = [one.value(read()[0]) for one, read in zip(made, reads, strict=True)]
        if values == before:
            break
        for write, value in zip(writes, values, strict=True):
            write([value])
        before = values
        _settle(network, feedthrough)


def _settle(network: Network, feedthrough: Feedthrough, names: Sequence[str] | None = None) -> None:
    """Move values along connections until they agree; among some components alone."""
    nodes = [network.nodes[name] for name in (network.nodes if names is None else names)]
    for node in nodes:
        network.read(node.chunks)
    feedthrough.propagate(0)
    for node in nodes:
        network.write(node)
        network.read(node.chunks)


def _give_again(part: Part) -> None:
    """Set parameters of another tool's FMU again that it has lost on its way to initialisation.

    Some return to their own start values there; FMI lets parameters be set until its end.
    """
    variables = part.instance.variables
    parameters = [name for name in part.given if variables[name].causality == "parameter"]
    if part.code or not parameters:
        return
    wanted = [part.given[name].value for name in parameters]
    found = part.instance.reader(parameters)()
    lost = [i for i, value in enumerate(found) if value != wanted[i]]
    if lost:
        part.instance.writer([parameters[i] for i in lost])([wanted[i] for i in lost])
