"""Coupling algorithms: how all components move over one communication step.

`Algorithm` is the contract; what is shipped besides `Iterated` (`iteration`) follows it. A name
is given to an algorithm in `registry.ALGORITHMS`, or by a package in its entry-point group.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, ClassVar

from .feedthrough import Feedthrough
from .network import Network, sources_by_target
from .node import Writes
from .order import ordered_groups


class Algorithm(ABC):
    """Moves all components of a network over one communication step.

    Whoever implements one derives from this class, writes `advance`, and gives the class a name:
    a shipped one in `registry.ALGORITHMS`, one of another package in its ``pyproject.toml``::

        [project.entry-points."seatrial.algorithms"]
        "my-algorithm" = "my_package.coupling:MyAlgorithm"

    Rig files then say ``algorithm = "my-algorithm"``. The class is imported when a rig asks for it.

    1.  **Made once**, as ``MyAlgorithm(network, feedthrough)``, when every component has been
        initialised and every output is valid at the start time. Settings are those of the rig,
        ``network.system.rig.file``. For components that it cannot step it raises InputError,
        with the file and the key; nothing has been recorded yet.
    2.  **On entry of** `advance`, every component stands at ``t_ns``, and ``network.signals`` has
        every output there, feed-through included. Inputs hold what was written last, not
        necessarily what the signals are.
    3.  **On return**, every component stands at ``t_ns + h_ns``, but for rule 5,
        ``network.time_ns`` is that instant, every output has been read there (`Network.read`), and
        ``feedthrough.propagate(steps + 1)`` was called after the last reading.
    4.  **Values move** by `Network.write`, or by ``writes.write`` of the values that
        ``writes.values(network.signals)`` returns, changed as the algorithm sees fit in the places
        of ``writes.continuous``: only so are units converted and overrides kept. An input holds
        its value while its component steps. Nothing writes to ``network.signals`` but
        `Network.read`. Components step by `Network.step` alone, which takes the times.
    5.  **Longer steps.** A component whose ``node.every`` is above 1 has values at whole multiples
        of it: it steps once, by ``node.every * h_ns``, either when its interval begins
        (``steps % node.every == 0``) or, where its inputs at the end are known, when it ends
        (``(steps + 1) % node.every == 0``); it is read when its interval ends.
    6.  **Steps are counted** by ``steps``, from the start of the run. A step that is repeated in
        smaller ones comes as several calls with the same ``steps`` and a shorter ``h_ns``; none
        of the components has a longer step then.
    7.  **What may be raised**: DiscardError and any SimulationError of a component goes through,
        wherever the components stand by then: the caller restores them or ends the run. The
        algorithm's own failure is a SimulationError that names time and connection. An algorithm
        that rolls components back itself frees what it saved, whatever is raised.
    8.  **Memory** of earlier calls belongs to the algorithm. `save` returns all of it that changes
        values or notes, as data that later calls leave alone; `restore` may be given the same
        data many times; `forget` drops what holds for signals that go on evenly, since a value
        has jumped (an event) or the step has another length. All three are called between two
        calls of `advance` only. An algorithm without memory writes none of them.
    9.  **Repeatable**: the same calls from the same state give the same bytes. Steps are run again
        after a discard, so no clock, no random numbers, no file.
    10. **Shorter steps** of its own, of any length in ns, may lead from ``t_ns`` to
        ``t_ns + h_ns``: rules 2 to 4 hold for each, with the same ``steps``, and
        ``network.time_ns`` is the end of each. All components must say that they take them
        (``instance.any_step``), none may have a longer step. Events act and rows are recorded at
        the end, ``t_ns + h_ns``, alone.
    11. **Nothing else**: events, recording, time keeping and the check for divergence are the
        master's.
    """

    follows_at_once: ClassVar[bool] = True
    """Whether outputs follow an event at its own instant, or after the next step only."""
    iterates: ClassVar[bool] = False
    """Whether it takes the rig's settings ``iteration``."""
    bonds: ClassVar[bool] = False
    """Whether it takes the rig's settings ``ecco``; the bonds are ``network.system.bonds``."""

    @abstractmethod
    def __init__(self, network: Network, feedthrough: Feedthrough) -> None: ...

    @abstractmethod
    def advance(self, steps: int, t_ns: int, h_ns: int) -> None:
        """Step from ``t_ns`` to ``t_ns + h_ns``. Raises DiscardError, SimulationError."""

    def save(self) -> Any:
        """Return everything that `advance` remembers of earlier calls."""
        return None

    def restore(self, state: Any) -> None:  # noqa: B027  many have no memory
        """Restore what `save` returned."""

    def forget(self) -> None:  # noqa: B027
        """Drop what was remembered of earlier points: a value jumps, or a step differs."""

    def notes(self, steps: int) -> list[str]:
        """Return what the user should know of the ``steps`` taken."""
        return []


@dataclass
class PastInputs:
    """Connected inputs of one type of one component, and what they were a step before."""

    writes: Writes
    previous: Sequence[Any] | None = None


class Remembering(Algorithm):
    """Base of algorithms that look back on the inputs of one communication point before."""

    def __init__(self, network: Network, feedthrough: Feedthrough) -> None:
        self._network, self._feedthrough = network, feedthrough
        self.past = [[PastInputs(one) for one in node.writes] for node in network.nodes.values()]
        """By component, in their order."""

    def save(self) -> Any:
        """Return the inputs of the point before."""
        return [past.previous for of_node in self.past for past in of_node]

    def restore(self, state: Any) -> None:
        """Restore what `save` returned."""
        pasts = [past for of_node in self.past for past in of_node]
        for past, previous in zip(pasts, state, strict=True):
            past.previous = previous

    def forget(self) -> None:
        """Hold what comes next: there is no point before."""
        for of_node in self.past:
            for past in of_node:
                past.previous = None


class Jacobi(Algorithm):
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

    follows_at_once = False

    def __init__(self, network: Network, feedthrough: Feedthrough) -> None:
        super().__init__(network, feedthrough)
        feedthrough.forget()


class GaussSeidel(Algorithm):
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


class Extrapolated(Remembering):
    """Jacobi with inputs extrapolated linearly from the last two points; second order.

    A component holds its inputs while it steps, so it gets the extrapolated value at the middle
    of its step: u + (u - u_before) / 2. Only connections whose ends are both declared continuous
    are extrapolated; sampled signals are held, and so is everything in the first step and after
    an event.
    """

    def __init__(self, network: Network, feedthrough: Feedthrough) -> None:
        super().__init__(network, feedthrough)
        self._nodes = list(zip(network.nodes.values(), self.past, strict=True))

    def advance(self, steps: int, t_ns: int, h_ns: int) -> None:
        """Write extrapolated inputs, step all, read, propagate."""
        network = self._network
        for node, inputs in self._nodes:
            if steps % node.every == 0:
                for past in inputs:
                    writes = past.writes
                    values = writes.values(network.signals)
                    writes.write(ahead(values, past.previous, writes.continuous))
                    past.previous = values
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


def ahead(
    values: Sequence[Any], previous: Sequence[Any] | None, continuous: Sequence[int]
) -> Sequence[Any]:
    """Return values extrapolated by half a step, where they are continuous."""
    if previous is None or not continuous:
        return values
    found = list(values)
    for i in continuous:
        found[i] += 0.5 * (values[i] - previous[i])
    return found
