"""Iteration with rollback: each step is repeated until the connections' values agree at its end."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

from ..errors import InputError, SimulationError
from ..model.component import NS
from ..system.rig import IterationEntry
from .algorithms import Remembering, arrive
from .feedthrough import Feedthrough
from .network import Network
from .node import Writes

_ROUND_OFF = 1e-14
_BEYOND_RETURN = 1e6
_OVER = 4


@dataclass
class _Inputs:
    """Connected inputs of one type of one component, during a step."""

    writes: Writes
    begin: Sequence[Any]
    """Values at the beginning of the step."""
    end: list[Any]
    """Values at its end, as far as they are known."""
    nominals: Sequence[float]

    def middle(self) -> Sequence[Any]:
        """Return what is held: continuous inputs as at the middle, others as at the beginning."""
        values = list(self.begin)
        for i in self.writes.continuous:
            values[i] = 0.5 * (self.begin[i] + self.end[i])
        return values


class Iterated(Remembering):
    """Repeats each step with inputs interpolated linearly between its ends; second order.

    The first pass extrapolates, each further one rolls all components back and steps them with
    the mean of the inputs at the beginning and, from the pass before, at the end. It ends when
    no connection's value at the end changes by more than ``tolerance`` times its nominal value, or
    after ``count`` repetitions. Sampled signals are held.

    A change that grows from one repetition to the next (contraction factor above 1) is an error
    that names the connection.
    """

    iterates = True

    def __init__(self, network: Network, feedthrough: Feedthrough) -> None:
        super().__init__(network, feedthrough)
        self._settings = network.system.rig.file.iteration or IterationEntry()
        self._parts = [node.part for node in network.nodes.values()]
        self._proven = False
        """Whether the components have shown that they can restore their states."""
        self._unsettled = 0
        """Steps that ended after ``count`` repetitions above the tolerance."""
        where = f'{network.system.rig.read_from.path}: algorithm = "iterated"'
        for part in self._parts:
            if not part.instance.rolls_back:
                raise InputError(f"{where}: {part.name} cannot save and restore its state")
            if part.every != 1:
                raise InputError(
                    f"{where}: {part.name} has a step of its own; all must step together"
                )
        self._nominals = {
            connection.target: network.nominal(connection.source)
            for connection in network.system.connections
        }

    def advance(self, steps: int, t_ns: int, h_ns: int) -> None:
        """Step and repeat. Raises DiscardError, SimulationError for a divergence."""
        states = [part.instance.get_state() for part in self._parts]
        try:
            self._repeat(steps, t_ns, h_ns, states)
        finally:
            for part, state in zip(self._parts, states, strict=True):
                part.instance.free_state(state)

    def save(self) -> Any:
        """Return the inputs of the point before, and how many steps did not settle."""
        return super().save(), self._unsettled

    def restore(self, state: Any) -> None:
        """Restore what `save` returned."""
        previous, self._unsettled = state
        super().restore(previous)

    def notes(self, steps: int) -> list[str]:
        """Return how many steps did not settle."""
        if not self._unsettled:
            return []
        return [
            f"{self._unsettled} of {steps} steps ended after the last repetition with changes "
            "above the tolerance of the iteration"
        ]

    def _repeat(self, steps: int, t_ns: int, h_ns: int, states: Sequence[Any]) -> None:
        independent = [] if self._proven else self._network.independent()
        inputs = self._inputs()
        changes: list[float] = []
        for repetition in range(self._settings.count + 1):
            if repetition:
                for part, state in zip(self._parts, states, strict=True):
                    part.instance.set_state(state)
                if not self._proven:
                    self._network.time_ns = t_ns
                    self._network.refuse_unrestored(independent)
                    self._proven = True
            self._pass(inputs, steps, t_ns, h_ns)
            change, worst = self._update(inputs)
            if change <= self._settings.tolerance:
                return
            changes.append(change)
            if change > _BEYOND_RETURN * changes[0] and change > _ROUND_OFF:
                break
        factor = _contraction(changes)
        if factor > 1.0 and changes[-1] > _ROUND_OFF:
            self._refuse(worst, factor, t_ns + h_ns)
        self._unsettled += 1

    def _inputs(self) -> list[_Inputs]:
        """Return all inputs at the beginning of a step, extrapolated to its end."""
        inputs = []
        for of_node in self.past:
            for past in of_node:
                writes = past.writes
                begin = writes.values(self._network.signals)
                end = list(begin)
                if past.previous is not None:
                    for i in writes.continuous:
                        end[i] = 2.0 * begin[i] - past.previous[i]
                nominals = [self._nominals[connection.target] for connection in writes.connections]
                inputs.append(_Inputs(writes, begin, end, nominals))
                past.previous = begin
        return inputs

    def _pass(self, inputs: Sequence[_Inputs], steps: int, t_ns: int, h_ns: int) -> None:
        for one in inputs:
            one.writes.write(one.middle())
        for node in self._network.nodes.values():
            self._network.step(node, t_ns, h_ns)
        arrive(self._network, self._feedthrough, steps + 1, t_ns + h_ns)

    def _update(self, inputs: Sequence[_Inputs]) -> tuple[float, tuple[str, str] | None]:
        """Take the new values at the end; return the largest relative change and its connection."""
        largest, worst = 0.0, None
        for one in inputs:
            values = one.writes.values(self._network.signals)
            for i in one.writes.continuous:
                difference = values[i] - one.end[i]
                change = abs(difference) / one.nominals[i]
                if change > largest:
                    largest, worst = change, one.writes.connections[i].source
                one.end[i] += self._settings.relaxation * difference
        return largest, worst

    def _refuse(self, worst: tuple[str, str] | None, factor: float, t_ns: int) -> None:
        assert worst is not None
        raise SimulationError(
            f"the iteration diverges at t = {t_ns / NS!r} s on {self._network.targets(worst)}: "
            f"its contraction factor is {factor:.3g}, above 1, so each repetition changes it more "
            "than the one before; a smaller relaxation or step may do, or another cut of the "
            "system (added mass belongs with its rigid body)"
        )


def _contraction(changes: Sequence[float]) -> float:
    """Return the mean factor from one change to the next, over the last four."""
    over = min(_OVER, len(changes) - 1)
    return float((changes[-1] / changes[-1 - over]) ** (1.0 / over)) if over else 0.0
