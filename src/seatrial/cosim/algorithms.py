"""Algorithms: how all components move over one communication step.

An algorithm knows the network, nothing of recording, events or time keeping. The master calls
`advance` once per communication step, with every output valid and propagated at its beginning;
afterwards every output is valid and propagated at its end. To add one, write a class with
``advance`` and name it in `ALGORITHMS`.

``steps`` counts communication steps since the start. A component with a longer step of its own
has values at whole multiples of it only: it steps when its interval begins (and is read when it
ends), or, where inputs at the end are known, when it ends.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, Protocol

from .feedthrough import Feedthrough
from .network import Network, sources_by_target
from .order import ordered_groups


class Algorithm(Protocol):
    """Moves all components of a network over one communication step."""

    def advance(self, steps: int, t_ns: int, h_ns: int) -> None:
        """Step from ``t_ns`` to ``t_ns + h_ns``. Raises DiscardError, SimulationError."""


class Jacobi:
    """All components step with the inputs that they have at the beginning; first order.

    Outputs that depend on inputs at once are read again at the end, so that no hop adds a
    delay of its own.
    """

    def __init__(self, network: Network, feedthrough: Feedthrough) -> None:
        self._network, self._feedthrough = network, feedthrough
        self._nodes = list(network.nodes.values())

    def advance(self, steps: int, t_ns: int, h_ns: int) -> None:
        """Write, step all, read, propagate."""
        network = self._network
        for node in self._nodes:
            if steps % node.every == 0:
                if not node.written_by_visit:
                    network.write(node)
                network.step(node, t_ns, node.every * h_ns)
        arrive(network, self._feedthrough, steps + 1, t_ns + h_ns)


class PlainJacobi(Jacobi):
    """Jacobi that reads nothing again: one step of delay per hop, as libcosim and ecos do it."""

    def __init__(self, network: Network, feedthrough: Feedthrough) -> None:
        super().__init__(network, feedthrough)
        feedthrough.forget()


class GaussSeidel:
    """Components step one after the other, with the newest outputs; first order.

    The order is that of the strongly connected components of the connections; within one, that of
    the declared feed-through; what is still tied, the rig's. A chain of components without a
    loop has no delay at all.
    """

    def __init__(self, network: Network, feedthrough: Feedthrough) -> None:
        self._network, self._feedthrough = network, feedthrough
        self.order = stepping_order(network)
        self._nodes = [network.nodes[name] for name in self.order]

    def advance(self, steps: int, t_ns: int, h_ns: int) -> None:
        """Write, step and read one after the other, propagate."""
        network = self._network
        network.time_ns = t_ns + h_ns
        for node in self._nodes:
            if (steps + 1) % node.every == 0:
                network.write(node)
                length = node.every * h_ns
                network.step(node, t_ns + h_ns - length, length)
                network.read(node.chunks)
        self._feedthrough.propagate(steps + 1)


class Extrapolated:
    """Jacobi with inputs extrapolated linearly from the last two points; second order.

    A component holds its inputs while it steps, so it gets the extrapolated value at the middle
    of its step: u + (u - u_before) / 2. Only connections whose ends are both declared continuous
    are extrapolated; sampled signals are held, and so is everything in the first step and after
    an event.
    """

    def __init__(self, network: Network, feedthrough: Feedthrough) -> None:
        self._network, self._feedthrough = network, feedthrough
        self._nodes = list(network.nodes.values())

    def advance(self, steps: int, t_ns: int, h_ns: int) -> None:
        """Write extrapolated inputs, step all, read, propagate."""
        network = self._network
        for node in self._nodes:
            if steps % node.every == 0:
                for writes in node.writes:
                    values = writes.values(network.signals)
                    writes.write(_ahead(values, writes.previous, writes.continuous))
                    writes.previous = values
                network.step(node, t_ns, node.every * h_ns)
        arrive(network, self._feedthrough, steps + 1, t_ns + h_ns)


def arrive(network: Network, feedthrough: Feedthrough, steps: int, t_ns: int) -> None:
    """Read what is valid at ``t_ns``, after all components stepped there."""
    network.time_ns = t_ns
    for node in network.nodes.values():
        if steps % node.every == 0:
            network.read(node.reads)
    feedthrough.propagate(steps)


def stepping_order(network: Network) -> list[str]:
    """Return the components' names in the order in which Gauss-Seidel steps them."""
    source_of = sources_by_target(network.system)
    depends: dict[str, list[str]] = {name: [] for name in network.nodes}
    for target, source in source_of.items():
        depends[target[0]].append(source[0])
    at_once: dict[str, set[str]] = {}
    for name, part in network.system.parts.items():
        inputs = {i for through in part.instance.feedthrough.values() for i in through}
        at_once[name] = {source_of[name, i][0] for i in inputs if (name, i) in source_of}
    rank = {name: i for i, name in enumerate(network.nodes)}
    order = []
    for group in ordered_groups(depends):
        inside = sorted(group, key=rank.__getitem__)
        through = {name: [other for other in inside if other in at_once[name]] for name in inside}
        for loop in ordered_groups(through):
            order += sorted(loop, key=rank.__getitem__)
    return order


def _ahead(
    values: Sequence[Any], previous: Sequence[Any] | None, continuous: Sequence[int]
) -> Sequence[Any]:
    if previous is None or not continuous:
        return values
    ahead = list(values)
    for i in continuous:
        ahead[i] += 0.5 * (values[i] - previous[i])
    return ahead
