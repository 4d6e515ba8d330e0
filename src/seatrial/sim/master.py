"""The master: steps components, moves values along connections, and knows nothing of boats.

Time is a whole number of nanoseconds. `Network` holds the signals, `Feedthrough` keeps outputs
that depend on inputs at once up to date at every communication point, an `Algorithm` moves
everything over one step, and `Rollback` repeats a discarded step in smaller ones.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from contextlib import ExitStack
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from ..errors import InputError, SimulationError
from ..model.component import NS
from ..model.faults.operators import Fixed
from ..system.registry import ALGORITHMS
from ..system.system import System
from .algorithms import Algorithm
from .compiled.choice import is_compiled, lost_by_algorithm
from .divergence import DivergenceWatch
from .fault_schedule import Schedule
from .injected import Acting
from .network import Name, Network
from .node import Node
from .outside import LastChange
from .rollback import Checkpoint, Rollback
from .starting import start
from .timing import StepTimes

if TYPE_CHECKING:
    from .compiled.program import Program
    from .compiled.rows import Rows
    from .compiled.steps import CompiledSteps

_MOST_STEPS = 256
"""Longest block of compiled steps."""
_LOOKS = 3
"""Most looks for arrivals at one point: a flood does not hold the step."""


@dataclass(frozen=True)
class Snapshot:
    """The whole state of a run at a communication point; `Master.save` makes one."""

    time: float
    """Simulated time, s."""
    checkpoint: Checkpoint
    faults: Any
    watch: Any


class Master:
    """Runs an assembled system; without ``stop_ns`` the components are given no stop time.

    ``signals`` holds the current value of every output; ``names`` says which is which. A value
    is valid at ``time``. ``algorithm`` is the class of the rig's, where its name cannot be looked
    up.
    """

    def __init__(
        self,
        system: System,
        start_ns: int = 0,
        stop_ns: int | None = None,
        *,
        algorithm: type[Algorithm] | None = None,
    ) -> None:
        self.system = system
        self._algorithm_class = algorithm
        self.step_ns = system.rig.step_ns
        self.start_ns, self.stop_ns = start_ns, stop_ns
        self.steps = 0
        self._network = Network(system)
        self._network.time_ns = start_ns
        self._outside = LastChange(self._network)
        self._instances = [(name, part.instance) for name, part in system.parts.items()]
        self._ends = False
        """Whether a component has asked for the end."""
        self._compiled: CompiledSteps | None = None
        self._linked: list[Node] = []
        """Whose outputs follow what arrives from outside between two points."""
        self.faults = Schedule()
        """What goes wrong, and when; add to it before `initialise` or at any point."""

    @property
    def algorithm(self) -> Algorithm:
        """How the components are coupled, once initialised."""
        return self._algorithm

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
        if self._compiled is not None:
            self._compiled.merge_times()
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
        """Set parameters, start every component and solve the connections at the start time.

        Raises SimulationError if a component refuses or a feed-through loop has no solution,
        InputError if the rig's algorithm cannot step its components.
        """
        nodes = self._network.nodes.values()
        self._feedthrough = start(self.system, self._network, self.start_ns, self.stop_ns)
        self._settling = list(self._feedthrough.groups)
        chosen = self._algorithm_class or self._chosen()
        self._algorithm = chosen(self._network, self._feedthrough)
        self._rollback = Rollback(self._network, self._feedthrough, self._algorithm)
        self._watch = DivergenceWatch(self._network)
        self._linked = [n for n in nodes if n.part.instance.variables.of_role("arrivals")]
        if is_compiled(self.system):
            self._compiled = self._compiled_steps()
        self.faults.act(self)

    def step(self) -> None:
        """Advance everything by one communication step. Raises SimulationError."""
        self.advance(1)

    def advance(self, most: int, rows: Rows | None = None) -> int:
        """Advance by up to ``most`` communication steps; return by how many, one at least.

        It goes on until somebody must look: a component asks for the end, in compiled steps a fault
        begins or ends. ``rows`` gets the points in between. Raises SimulationError.
        """
        try:
            return self._advance(most, rows)
        except SimulationError as error:
            self._outside.tell(error)
            raise

    def meet_arrivals(self) -> None:
        """Let outputs of links follow what came since the step ended, before the next one.

        In real time a point is due later than its outputs were read: a command that comes
        meanwhile would wait for a whole step. Raises SimulationError.
        """
        linked = [node for node in self._linked if self.steps % node.every == 0]
        for _ in range(_LOOKS if linked else 0):
            before = [*self.signals]
            for node in linked:
                self._network.read(node.chunks)
            if self.signals == before:
                return
            self._changed()

    @property
    def is_compiled(self) -> bool:
        """Whether steps are taken in C as long as nothing disturbs them."""
        return self._compiled is not None

    def ended(self) -> list[str]:
        """Return the components that have asked to end the simulation."""
        return [name for name, instance in self._instances if instance.ended_at is not None]

    def end_notes(self) -> list[str]:
        """Return a note on every component that has asked to end the simulation."""
        ended = {name: part.instance.ended_at for name, part in self.system.parts.items()}
        return [
            f"{name} ended the simulation at t = {at!r} s; the last row has its outputs of then"
            for name, at in ended.items()
            if at is not None
        ]

    def set(self, component: str, names: Sequence[str], values: Sequence[Any]) -> None:
        """Set tunable parameters or unconnected inputs now; outputs follow at once.

        With an algorithm such as plain Jacobi they follow after the next step. Raises
        SimulationError.
        """
        self._outside.note_set(self.time_ns, component, names, values)
        self._network.set(component, names, values)
        self._follow(component)
        self._changed()

    def inject(self, component: str, name: str, fault: Acting) -> None:
        """Let a fault act from now on: on an output for all its readers, or on one input."""
        what = f"{fault.key}, {fault.operator}, on {component}.{name}"
        self._outside.note(self.time_ns, what)
        self._network.inject(component, name, fault)
        self._follow(component)
        self._changed()

    def clear(self, key: str) -> None:
        """End all that the fault ``key`` does: what it acted on has its own value again."""
        for component in self._network.clear(key):
            self._follow(component)
        self._changed()

    def override(self, component: str, name: str, value: Any) -> None:
        """Replace an output for all its readers, or one input, until `release`."""
        self._network.clear(_override(component, name))
        self.inject(component, name, Acting(_override(component, name), Fixed(value), self.time_ns))

    def release(self, component: str, name: str) -> None:
        """End an override: the connection carries its own value again."""
        self.clear(_override(component, name))

    def restart(self, component: str) -> None:
        """Start a component anew, as at the start of the run, with the present time.

        Raises SimulationError.
        """
        node = self._network.nodes[component]
        instance = node.part.instance
        instance.reset()
        instance.set_start({name: one.value for name, one in node.part.given.items()})
        stop = math.inf if self.stop_ns is None else self.stop_ns / NS
        instance.initialise(self.time, stop)
        self._network.restarted(node)
        instance.begin()
        self._network.read(node.chunks)
        self._changed()

    def values(self, component: str, names: Sequence[str]) -> list[Any]:
        """Return current values of outputs, inputs or parameters of a component, by name.

        A connected input has what arrives now. Raises SimulationError.
        """
        return self._network.values(component, names)

    def save(self) -> Snapshot:
        """Return the whole state, faults included; `free` it when it is of no more use.

        Raises InputError naming the components that cannot save and restore theirs,
        SimulationError if one cannot after all.
        """
        parts = self.system.parts.items()
        stuck = [name for name, part in parts if not part.instance.rolls_back]
        if stuck:
            raise InputError(
                f"the state of {', '.join(stuck)} cannot be saved and restored: what is outside "
                "the simulation does not go back, and some FMUs say that they cannot"
            )
        checkpoint = self._rollback.save(self.steps)
        self._rollback.keep(checkpoint)
        self._in_python()
        return Snapshot(self.time, checkpoint, self.faults.save(), self._watch.save())

    def restore(self, snapshot: Snapshot) -> None:
        """Return to a state that `save` returned; it stays valid. Raises SimulationError."""
        self._rollback.forget()
        self._rollback.restore(snapshot.checkpoint)
        self.faults.restore(snapshot.faults)
        self._watch.restore(snapshot.watch)
        self.steps = snapshot.checkpoint.steps
        self._in_python()
        self._ends = bool(self.ended())

    def free(self, snapshot: Snapshot) -> None:
        """Release a state."""
        self._rollback.free(snapshot.checkpoint)
        self._in_python()

    def terminate(self) -> None:
        """Tell every component that the run has ended, the rest too if one raises.

        Raises SimulationError.
        """
        self._rollback.forget()
        with ExitStack() as ends:
            for part in reversed(self.system.parts.values()):
                ends.callback(part.instance.terminate)

    def notes(self) -> list[str]:
        """Return what the user should know of the steps taken so far."""
        lost = lost_by_algorithm(self.system)
        notes = [lost] if lost else []
        if self._rollback.splits:
            notes.append(
                f"{self._rollback.splits} of {self.steps} steps were discarded by a component "
                "and repeated in smaller ones"
            )
        return [*notes, *self._algorithm.notes(self.steps)]

    # ------------------------------------------------------------------ inside

    def program(self) -> tuple[Network, Program, dict[str, int]]:
        """Return the network, once initialised, and operations for C, with where some begin.

        The readings of all outputs, component by component, come first. "settling" are the visits
        of the initialisation, where a step has not the same; "exchange" are the readings again,
        each after what is connected to it is written; "steps" is a step, whose feed-through
        visits begin at "visits".
        """
        from .compiled.program import Program

        program = Program(self._network, self._feedthrough, self.step_ns)
        begins, nodes = {}, self._network.nodes
        for name, node in nodes.items():
            begins[f"read {name}"] = len(program.operations)
            program.add_reading(node)
        begins["settling"] = len(program.operations)
        if not self._algorithm.follows_at_once:
            program.add_visits(self._settling)
        begins["exchange"] = len(program.operations)
        for node in nodes.values():
            program.add_writing(node)
            program.add_reading(node)
        begins["steps"] = len(program.operations)
        begins["visits"] = program.add_step(self._algorithm)
        return self._network, program, begins

    def _advance(self, most: int, rows: Rows | None) -> int:
        compiled = self._compiled
        if compiled is None:
            return self._advance_in_python(most, rows)
        if self._network.is_disturbed or self._ends:
            return self._advance_in_python(1, rows)
        taken = self._advance_compiled(compiled, most, rows)
        self.faults.act(self)
        return taken

    def _compiled_steps(self) -> CompiledSteps:
        from .compiled.steps import CompiledSteps

        return CompiledSteps(
            self._network, self._feedthrough, self._algorithm, self._watch, self.step_ns
        )

    def _advance_in_python(self, most: int, rows: Rows | None) -> int:
        self._in_python()
        begun, step_ns = self.steps, self.step_ns
        until = begun + most
        advance, look, act = self._rollback.advance, self._watch.look, self.faults.act
        keep = None if rows is None else rows.keeping(begun, self.signals)
        while True:
            advance(self.steps, self.time_ns, step_ns)
            self.steps = steps = self.steps + 1
            look(steps)
            act(self)
            for _, instance in self._instances:
                if instance.ended_at is not None:
                    until = steps
            if steps >= until:
                return steps - begun
            if keep is not None:
                keep(steps)

    def _advance_compiled(self, compiled: CompiledSteps, most: int, rows: Rows | None) -> int:
        next_ns = self.faults.next_ns()
        if next_ns is not None:
            most = min(most, max(1, -((self.time_ns - next_ns) // self.step_ns)))
        begun, compiled.taken = self.steps, 0
        try:
            taken = self._rollback.advance_block(
                compiled, begun, self.time_ns, min(most, _MOST_STEPS), rows
            )
        except BaseException:
            self.steps = begun + compiled.taken
            raise
        self.steps = begun + taken
        if taken > compiled.taken:  # a discarded step, which Python has repeated
            self._watch.look(self.steps)
        self._ends = compiled.ends
        return taken

    def _in_python(self) -> None:
        """Note that what the compiled steps know is no longer so."""
        if self._compiled is not None:
            self._compiled.is_current = False

    def _follow(self, component: str) -> None:
        """Read a component's outputs where they follow at once what was set."""
        node = self._network.nodes[component]
        if self._algorithm.follows_at_once and self.steps % node.every == 0:
            self._network.read(node.chunks)

    def _chosen(self) -> type[Algorithm]:
        rig = self.system.rig
        where = f"{rig.read_from.path}: algorithm"
        try:
            made = ALGORITHMS.load(rig.file.algorithm)
        except InputError as error:
            raise InputError(f"{where}: {error}") from None
        if not (isinstance(made, type) and issubclass(made, Algorithm)):
            raise InputError(
                f"{where}: {rig.file.algorithm!r} is {made!r}, "
                f"which is not derived from {Algorithm.__module__}.Algorithm"
            )
        return made

    def _changed(self) -> None:
        """Let feed-through outputs follow a change from outside, which is no continuous one."""
        self._rollback.forget()
        self._algorithm.forget()
        self._feedthrough.propagate(self.steps)
        self._in_python()


def _override(component: str, name: str) -> str:
    return f"override of {component}.{name}"
