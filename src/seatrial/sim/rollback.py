"""Rollback: a discarded step is repeated in smaller ones from a restored state.

FMI components may refuse a step and take a smaller one, but those that stepped already must go
back first. Saving all states before every step would cost more than the steps, so they are
saved now and then; after a discard the steps since are run again, which gives the same values
because nothing here depends on the wall clock.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from ..errors import DiscardError, FatalError, SimulationError
from ..model.component import NS
from .algorithms import Algorithm
from .feedthrough import Feedthrough
from .network import Network

if TYPE_CHECKING:
    from .compiled.rows import Rows
    from .compiled.steps import CompiledSteps

_STEPS_BETWEEN = 250
_COMPILED_BETWEEN = 2000
"""The same of compiled steps: to save a state takes as long as hundreds of them."""
_HALVINGS = 6


@dataclass
class Checkpoint:
    """Everything that steps change, at one communication point."""

    steps: int
    states: list[Any]
    network: Any
    feedthrough: Any
    algorithm: Any
    independent: list[list[Any]]
    """Outputs that tell if the states have been restored."""


class Rollback:
    """Advances an algorithm; splits a step that a component discards, if all can roll back."""

    def __init__(self, network: Network, feedthrough: Feedthrough, algorithm: Algorithm) -> None:
        self._network, self._feedthrough = network, feedthrough
        self.algorithm = algorithm
        self._instances = [node.part.instance for node in network.nodes.values()]
        self._checkpoint: Checkpoint | None = None
        self._obstacle = _obstacle(network)
        self.splits = 0
        """Steps that were split."""
        self._kept: set[int] = set()
        """Checkpoints, by identity, that somebody else may restore."""

    def advance(self, steps: int, t_ns: int, h_ns: int) -> None:
        """Advance by one communication step. Raises SimulationError."""
        self._save_if_due(steps)
        try:
            self.algorithm.advance(steps, t_ns, h_ns)
            return
        except DiscardError as refused:
            error = refused  # left here: what follows must not be reported as caused by it
        self._try_again(steps, t_ns, h_ns, error)

    def advance_block(
        self, compiled: CompiledSteps, steps: int, t_ns: int, count: int, rows: Rows | None
    ) -> int:
        """Advance by up to ``count`` compiled steps; return by how many. Raises SimulationError."""
        self._save_if_due(steps, _COMPILED_BETWEEN)
        h_ns = compiled.step_ns
        if self._checkpoint is not None:
            count = min(count, self._checkpoint.steps + _COMPILED_BETWEEN - steps)
        try:
            return compiled.take(steps, t_ns, count, rows)
        except DiscardError as refused:
            error = refused
        self._try_again(steps + compiled.taken, t_ns + compiled.taken * h_ns, h_ns, error)
        return compiled.taken + 1

    def forget(self) -> None:
        """Say that something was changed from outside: the steps before cannot be run again."""
        if self._checkpoint is not None:
            self.free(self._checkpoint)
            self._checkpoint = None

    def save(self, steps: int) -> Checkpoint:
        """Return everything that steps change. Raises SimulationError."""
        states: list[Any] = []
        try:
            for instance in self._instances:
                states.append(instance.get_state())
        except SimulationError:
            self._free(states)
            raise
        return Checkpoint(
            steps,
            states,
            self._network.save(),
            self._feedthrough.save(),
            self.algorithm.save(),
            self._network.independent(),
        )

    def restore(self, checkpoint: Checkpoint) -> None:
        """Return to a checkpoint, which stays valid. Raises SimulationError."""
        for instance, state in zip(self._instances, checkpoint.states, strict=True):
            instance.set_state(state)
        self._network.restore(checkpoint.network)
        self._feedthrough.restore(checkpoint.feedthrough)
        self.algorithm.restore(checkpoint.algorithm)
        self._network.refuse_unrestored(checkpoint.independent)

    def free(self, checkpoint: Checkpoint) -> None:
        """Release a checkpoint."""
        self._free(checkpoint.states)
        if id(checkpoint) in self._kept:
            self._kept.remove(id(checkpoint))
            self._tell()

    def keep(self, checkpoint: Checkpoint) -> None:
        """Say that a checkpoint may be restored, whenever somebody likes, until it is released."""
        self._kept.add(id(checkpoint))
        self._tell()

    # ------------------------------------------------------------------ inside

    def _tell(self) -> None:
        """Tell the components whether states of before their next steps may be restored.

        Checkpoints for discarded steps are left out: FMUs exist that stand still where a restored
        state is announced, a discard is rare, and a component that cannot go back is found
        (`Network.refuse_unrestored`).
        """
        for instance in self._instances:
            instance.goes_back(bool(self._kept))

    def _save_if_due(self, steps: int, between: int = _STEPS_BETWEEN) -> None:
        if not self._obstacle and (
            self._checkpoint is None or steps - self._checkpoint.steps >= between
        ):
            self._save(steps)

    def _try_again(self, steps: int, t_ns: int, h_ns: int, error: DiscardError) -> None:
        """Repeat a discarded step in smaller ones, if there is a state to begin from."""
        if self._checkpoint is None:
            raise SimulationError(f"{error}\n(not tried in smaller steps: {self._obstacle})")
        self._repeat(steps, t_ns, h_ns, error)

    def _repeat(self, steps: int, t_ns: int, h_ns: int, error: DiscardError) -> None:
        """Return to the beginning of a discarded step, and take it in parts."""
        checkpoint = self._checkpoint
        assert checkpoint is not None
        self.restore(checkpoint)
        for k in range(checkpoint.steps, steps):
            self.algorithm.advance(k, t_ns - (steps - k) * h_ns, h_ns)
        self._split(steps, t_ns, h_ns, 1, error)
        self.algorithm.forget()
        self.forget()
        self.splits += 1

    def _split(self, steps: int, t_ns: int, h_ns: int, depth: int, error: DiscardError) -> None:
        """Take a step in two halves; either is split again if it is discarded."""
        if depth > _HALVINGS or h_ns < 2:
            raise SimulationError(
                f"{error}\n(tried again from a restored state, in steps down to {h_ns / NS!r} s)"
            )
        half = h_ns // 2
        for begin_ns, length_ns in ((t_ns, half), (t_ns + half, h_ns - half)):
            self._save(steps)
            self.algorithm.forget()  # the parts are not as long as what came before
            if not self._taken(steps, begin_ns, length_ns):
                self._split(steps, begin_ns, length_ns, depth + 1, error)

    def _taken(self, steps: int, t_ns: int, h_ns: int) -> bool:
        """Take a step; if it is discarded, return to its beginning and say so."""
        try:
            self.algorithm.advance(steps, t_ns, h_ns)
        except DiscardError as error:
            refused = error
        else:
            return True
        if self._checkpoint is None:
            raise SimulationError(f"{refused}\n({self._obstacle})")
        self.restore(self._checkpoint)
        return False

    def _save(self, steps: int) -> None:
        self.forget()
        try:
            self._checkpoint = self.save(steps)
        except FatalError:
            raise
        except SimulationError as error:  # it says it can, but it cannot: the run may go on
            self._obstacle = str(error)

    def _free(self, states: list[Any]) -> None:
        for instance, state in zip(self._instances, states, strict=False):
            instance.free_state(state)


def _obstacle(network: Network) -> str:
    """Return why a discarded step cannot be repeated, empty if it can."""
    for name, node in network.nodes.items():
        if not node.part.instance.rolls_back:
            return f"{name} cannot save and restore its state"
        if not node.part.instance.any_step:
            return f"{name} takes steps of one length only"
        if node.every != 1:
            return f"{name} has a step of its own"
    return ""
