"""Components with a sample period of their own: sensors, controllers, digital links."""

from __future__ import annotations

from .component import NS, Component, Parameter, seconds


class Sampled(Component):
    """A component that acts at instants ``t0 + k period``, whatever the communication step.

    An instant takes no time: at an instant, `sample` computes outputs from the inputs there
    and they act from then on; `update` advances the memory afterwards. Output first, memory
    after. If several instants fall into one step, all run and the last is published. Instants
    are counted in whole nanoseconds from the start of the run.

    Override ``reset(t)`` (instead of `start`), ``sample(t, k)`` and ``update(t, k)``:
    `sample` may run several times for one instant (inputs may still change) and must not
    change the memory; `update` runs once per instant, with the inputs and outputs as of it.
    """

    discrete = True

    period = Parameter(0.01, "s", "sample period", min=1e-6)

    def reset(self, t: float) -> None:
        """Set the memory for the start of the run."""

    def sample(self, t: float, k: int) -> None:
        """Set the outputs of instant ``k``, which is at time ``t``."""

    def update(self, t: float, k: int) -> None:
        """Advance the memory after instant ``k``."""

    def hold(self, t: float) -> None:
        """Set outputs that change between instants (a delayed value that falls due)."""

    def start(self, t: float) -> None:
        """Start counting instants and reset the memory."""
        self._start_ns = self.now_ns
        self._period_ns = max(1, round(self.period * NS))
        self._next = 0
        self.reset(t)

    def outputs(self, t: float) -> None:
        """Sample at an instant; hold otherwise."""
        if self._instant_ns() == round(t * NS):
            self.sample(t, self._next)
        self.hold(t)

    def step(self, t: float, h: float) -> None:
        """Run the instants from ``t`` to before ``t + h``."""
        end_ns = round(t * NS) + round(h * NS)
        while self._instant_ns() < end_ns:
            instant = seconds(self._instant_ns())
            self.sample(instant, self._next)
            self.update(instant, self._next)
            self._next += 1

    def _instant_ns(self) -> int:
        instant: int = self._start_ns + self._next * self._period_ns
        return instant
