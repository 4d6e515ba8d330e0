"""Motor of a propulsor: command in, order to the propulsor out."""

from __future__ import annotations

from ...model.component import Input, Output
from .lagged import LaggedActuator


class Motor(LaggedActuator):
    """Motor between a speed controller and a propulsor of a craft, with its failures.

        T y' = clip(command, 1) - y,    clip(x, a) = x held between -a and a

    exact for a command held over the step; with ``time_constant`` T = 0, for a craft whose
    propulsors have their own lag, the order y is the limited command at the same instant. Both
    are shares of the largest thrust or shaft speed, -1 to 1, positive ahead.

    Failures are those of `Actuator`: a wrong one gives half of its order, which is half of the
    thrust where that is linear in the order; a slow one has ten times its lag, and at least 1 s.

    Not modelled: torque, current, supply voltage.
    """

    command = Input("1", "share of the largest, -1 to 1, positive ahead", role="command")
    order = Output("1", "share that the propulsor is driven with, -1 to 1, positive ahead")

    def start(self, t: float) -> None:
        """Start at rest."""
        self.begin_lagged(1)

    def step(self, t: float, h: float) -> None:
        """Follow the command as it is."""
        self.follow(t, h, [self.command], [1.0])

    def outputs(self, t: float) -> None:
        """Publish the order."""
        self.order = self.lagged(t, [self.command], [1.0])[0]
