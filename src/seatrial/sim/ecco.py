"""Energy-conserving step control: the step follows the energy that power bonds lose or gain."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any

from ..errors import InputError
from ..model.component import NS
from ..system.rig import EccoEntry
from ..system.system import Connection
from .algorithms import PlainJacobi
from .feedthrough import Feedthrough
from .instants import interval
from .network import Network

_STEPS_BEFORE = 2
"""Steps of the first length, after which the control begins."""
Powers = Sequence[tuple[Sequence[float], Sequence[float]]]
"""By bond: values that its first connections carry, and its second ones."""


class Ecco(PlainJacobi):
    """Plain Jacobi with a variable step, controlled by the energy residual of power bonds.

    Between two communication points of the rig it takes steps of its own. Connected components
    hold their inputs over a step of length h, so that the two ends of a bond count different
    powers. With the values s and v that its two connections carry, the energy residual of
    the bond is h abs(s_new v_old - v_new s_old), and with the absolute tolerance a and the relative
    tolerance r the error indicator of N bonds is

        epsilon = sqrt(1/N sum((residual / (a + r max(residual)))^2)).

    The next step is h times alpha epsilon^-(I + P) epsilon_before^P, within the limits of change
    and of length; where all residuals are exactly zero, h stays. No step is repeated. Source:
    S. Sadjina, L. T. Kyllingstad, S. Skjong, E. Pedersen, "Energy conservation and power bonds in
    co-simulations", arXiv:1602.06434; the indicator and the order of operations are those of
    libcosim's ``ecco_algorithm``.

    A step that ends at a communication point because the next one would begin beyond it says
    little about longer ones: it shortens what follows if its own residual asks for that, and
    changes nothing else. A remainder below the shortest step is no step of its own.

    Lengths are whole nanoseconds. After an event the control begins anew. Raises InputError for
    components with a step of their own, or with steps of one length.
    """

    bonds = True

    def __init__(self, network: Network, feedthrough: Feedthrough) -> None:
        super().__init__(network, feedthrough)
        rig = network.system.rig
        path, self._settings = rig.read_from.path, rig.file.ecco or EccoEntry()
        lengths = self._settings.lengths(rig.step_ns, f"{path}: ecco")
        self._shortest, self._first, self._longest = lengths
        if not network.system.bonds:
            raise InputError(
                f'{path}: algorithm = "ecco" controls its steps by power bonds; bonds names none'
            )
        for node in network.nodes.values():
            if node.every != 1 or not node.part.instance.any_step:
                why = (
                    "has a step of its own" if node.every != 1 else "takes steps of one length only"
                )
                raise InputError(f'{path}: algorithm = "ecco": {node.part.name} {why}')
        by_target = {connection.target: connection for connection in network.system.connections}
        self._bonds = [
            [(by_target[one], by_target[other]) for one, other in bond.pairs]
            for bond in network.system.bonds
        ]
        self._taken, self._least, self._most, self._at_shortest = 0, self._longest, 0, 0
        self.forget()

    def advance(self, steps: int, t_ns: int, h_ns: int) -> None:
        """Take as many steps as the control needs from ``t_ns`` to ``t_ns + h_ns``."""
        end_ns = t_ns + h_ns
        while t_ns < end_ns:
            length, left = self._step, end_ns - t_ns
            if left < length + self._shortest:
                length = left if left <= self._longest else left // 2
            before = self._powers()
            super().advance(steps, t_ns, length)
            self._control(before, t_ns, length)
            t_ns += length

    def save(self) -> Any:
        """Return the state of the control, and the counts for the notes."""
        control = self._step, self._before, self._since
        return control, (self._taken, self._least, self._most, self._at_shortest)

    def restore(self, state: Any) -> None:
        """Restore what `save` returned."""
        (self._step, self._before, self._since), counts = state
        self._taken, self._least, self._most, self._at_shortest = counts

    def forget(self) -> None:
        """Begin with the first step again."""
        self._step, self._before, self._since = self._first, 1.0, 0

    def notes(self, steps: int) -> list[str]:
        """Return how many steps were taken, how long, and how many should have been shorter."""
        if not self._taken:
            return []
        notes = [
            f"ecco took {self._taken} steps of {self._least / NS!r} s to {self._most / NS!r} s "
            f"for {steps} communication steps"
        ]
        if self._at_shortest:
            notes.append(
                f"{self._at_shortest} of them missed the tolerance of the power bonds at "
                f"ecco.min_step, {self._shortest / NS!r} s"
            )
        return notes

    def _powers(self) -> Powers:
        """Return what the connections of each bond carry now."""
        return [
            ([self._carried(one) for one, _ in bond], [self._carried(other) for _, other in bond])
            for bond in self._bonds
        ]

    def _carried(self, connection: Connection) -> float:
        network = self._network
        return float(connection.value(network.signals[network.places[connection.source]]))

    def _control(self, before: Powers, t_ns: int, length: int) -> None:
        """Choose the next step by the energy residuals of the last one."""
        self._taken += 1
        self._since += 1
        self._least, self._most = min(self._least, length), max(self._most, length)
        h = interval(t_ns, length, constant=False)[1]
        error = self._indicator(before, h)
        if error > 1.0 and length <= self._shortest:
            self._at_shortest += 1
        if self._since < _STEPS_BEFORE:
            return
        if self._before == 0.0 or error == 0.0:
            self._before = error
            return
        given = self._settings
        gain = (
            given.safety_factor
            * error ** (-given.integral_gain - given.proportional_gain)
            * self._before**given.proportional_gain
        )
        gain = min(max(gain, given.min_change), given.max_change)
        if length < self._step and gain >= 1.0:
            return
        self._before = error
        self._step = min(max(int(gain * h * NS), self._shortest), self._longest)

    def _indicator(self, before: Powers, h: float) -> float:
        residuals = [
            abs(_power(flow, effort_before) - _power(effort, flow_before))
            for (flow, effort), (flow_before, effort_before) in zip(
                self._powers(), before, strict=True
            )
        ]
        given = self._settings
        scale = given.absolute_tolerance + given.relative_tolerance * (max(residuals) * h)
        squares = sum((residual * h / scale) ** 2 for residual in residuals)
        return math.sqrt(squares / len(residuals))


def _power(flow: Sequence[float], effort: Sequence[float]) -> float:
    return sum(one * other for one, other in zip(flow, effort, strict=True))
