"""The master: steps components, moves values along wires, and knows nothing of boats.

Time is a whole number of nanoseconds. `Network` holds the signals, `Feedthrough` keeps outputs
that depend on inputs at once up to date at every communication point, an `Algorithm` moves
everything over one step, and `Rollback` repeats a discarded step in smaller ones.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any

from ..component import NS
from .algorithms import Algorithm, Extrapolated, GaussSeidel, Jacobi, PlainJacobi
from .divergence import DivergenceWatch
from .feedthrough import Feedthrough
from .iteration import Iterated
from .network import Name, Network
from .rig import AlgorithmName, IterationEntry
from .rollback import Rollback
from .system import System
from .timing import StepTimes

_ALGORITHMS: dict[AlgorithmName, Callable[[Network, Feedthrough], Algorithm]] = {
    "jacobi": Jacobi,
    "plain-jacobi": PlainJacobi,
    "gauss-seidel": GaussSeidel,
    "extrapolated": Extrapolated,
}


class Master:
    """Runs an assembled system.

    ``signals`` holds the current value of every output; ``names`` says which is which. A value
    is valid at ``time``.
    """

    def __init__(self, system: System, start_ns: int = 0, stop_ns: int = 0) -> None:
        self.system = system
        self.step_ns = system.rig.step_ns
        self.start_ns, self.stop_ns = start_ns, stop_ns
        self.steps = 0
        self._network = Network(system)
        self._network.time_ns = start_ns

    @property
    def names(self) -> list[Name]:
        """(component, output) of every signal."""
        return self._network.names

    @property
    def signals(self) -> list[Any]:
        """Current value of every output, in the order of ``names``."""
        return self._network.signals

    @property
    def step_times(self) -> dict[str, StepTimes]:
        """Wall time of each component's steps."""
        return {name: node.times for name, node in self._network.nodes.items()}

    @property
    def time_ns(self) -> int:
        """Simulated time, ns."""
        return self.start_ns + self.steps * self.step_ns

    @property
    def time(self) -> float:
        """Simulated time, s."""
        return self.time_ns / NS

    def initialise(self) -> None:
        """Set parameters, start every component and solve the wires at the start time.

        Raises SimulationError if a component refuses or a feed-through loop has no solution,
        InputError if the rig's algorithm cannot step its components.
        """
        instances = [part.instance for part in self.system.parts.values()]
        for part in self.system.parts.values():
            part.instance.set_start({name: given.value for name, given in part.given.items()})
        for instance in instances:
            instance.initialise(self.start_ns / NS, self.stop_ns / NS)
        self._feedthrough = Feedthrough(self._network)
        self._settle()
        for instance in instances:
            instance.begin()
        self._settle()
        self._algorithm = self._chosen()
        self._rollback = Rollback(self._network, self._feedthrough, self._algorithm)
        self._watch = DivergenceWatch(self._network)

    def step(self) -> None:
        """Advance everything by one communication step. Raises SimulationError."""
        self._rollback.advance(self.steps, self.time_ns, self.step_ns)
        self.steps += 1
        self._watch.look(self.steps)

    def set(self, component: str, names: Sequence[str], values: Sequence[Any]) -> None:
        """Set tunable parameters or unconnected inputs now; outputs follow at once.

        With plain Jacobi they follow after the next step. Raises SimulationError.
        """
        node = self._network.nodes[component]
        node.part.instance.writer(names)(values)
        if not isinstance(self._algorithm, PlainJacobi) and self.steps % node.every == 0:
            self._network.read(node.chunks)
        self._changed()

    def override(self, component: str, name: str, value: Any) -> None:
        """Replace an output for all its readers, or one connected input, until `release`."""
        self._network.override(component, name, value)
        self._changed()

    def release(self, component: str, name: str) -> None:
        """End an override: the wire carries its own value again."""
        self._network.override(component, name, None)
        self._changed()

    def terminate(self) -> None:
        """Tell every component that the run has ended. Raises SimulationError."""
        self._rollback.forget()
        for part in self.system.parts.values():
            part.instance.terminate()

    def notes(self) -> list[str]:
        """Return what the user should know of the steps taken so far."""
        notes = []
        if self._rollback.splits:
            notes.append(
                f"{self._rollback.splits} of {self.steps} steps were discarded by a component "
                "and repeated in smaller ones"
            )
        if isinstance(self._algorithm, Iterated) and self._algorithm.unsettled:
            notes.append(
                f"{self._algorithm.unsettled} of {self.steps} steps ended after the last "
                "repetition with changes above the tolerance of the iteration"
            )
        return notes

    # ------------------------------------------------------------------ inside

    def _chosen(self) -> Algorithm:
        file = self.system.rig.file
        if file.algorithm == "iterated":
            settings = file.iteration or IterationEntry()
            return Iterated(self._network, self._feedthrough, settings)
        return _ALGORITHMS[file.algorithm](self._network, self._feedthrough)

    def _settle(self) -> None:
        network, nodes = self._network, self._network.nodes.values()
        for node in nodes:
            network.read(node.chunks)
        self._feedthrough.propagate(self.steps)
        for node in nodes:
            network.write(node)
            network.read(node.chunks)

    def _changed(self) -> None:
        """Let feed-through outputs follow a change from outside, which is no continuous one."""
        self._rollback.forget()
        self._network.forget_previous()
        self._feedthrough.propagate(self.steps)
