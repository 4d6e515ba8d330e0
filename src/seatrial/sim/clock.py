"""Pacing: when a communication point may be presented, in wall time."""

from __future__ import annotations

import time
from collections.abc import Callable
from typing import Any, Literal

from ..model.component import NS
from .timing import StepTimes

OverrunPolicy = Literal["catch-up", "slip", "abort"]

SLICE_NS = 20_000_000
"""A request to stop is seen within this time while waiting."""
SPIN_NS = 200_000
"""The last part of a wait is spent reading the clock: a sleep alone wakes up 0.1 ms late."""


class Pacer:
    """Holds a run to wall time: the point of time t comes at the start + t / ``factor``.

    A step that ends before its deadline waits for it; one that ends later is an overrun. With
    ``catch-up`` the deadlines stay where they are and the run goes on without waiting until it
    has caught up; with ``slip`` they all move by the lateness, which is lost. With ``abort``
    whoever runs the steps ends the run. `change` gives another factor, `pause` leaves time out.

    ``now`` is a monotonic clock in ns, ``sleep`` takes seconds.
    """

    def __init__(
        self,
        factor: float,
        policy: OverrunPolicy,
        *,
        now: Callable[[], int] = time.monotonic_ns,
        sleep: Callable[[float], None] = time.sleep,
        spin_ns: int = SPIN_NS,
    ) -> None:
        self.factor, self.policy = factor, policy
        self.overruns, self.slack, self.wake_ups = StepTimes(), StepTimes(), StepTimes()
        self.lost_ns = 0
        """By how much the deadlines have moved."""
        self.drift_ns = 0
        """By how much the last point came later than one of a run without any lateness."""
        self.paused_ns = 0
        """Wall time that is left out."""
        self._now, self._sleep, self._spin_ns = now, sleep, spin_ns
        self._wall_start = self._time_start = 0

    def start(self, t_ns: int) -> None:
        """Start the clock: the simulated time ``t_ns`` is now."""
        self._wall_start, self._time_start = self._now(), t_ns

    def keep(self, t_ns: int, stop_requested: Callable[[], int] = lambda: 0) -> int:
        """Wait until the point ``t_ns`` is due, or a stop is requested.

        Returns by how many ns the step to it ended too late, 0 if it was in time.
        """
        due = self._due(t_ns)
        deadline = due + self.lost_ns
        arrived = self._now()
        lateness = max(0, arrived - deadline)
        if lateness:
            self.overruns.add(lateness, t_ns)
            if self.policy == "slip":
                self.lost_ns += lateness
            self.drift_ns = arrived - due
            return lateness
        self.slack.add(deadline - arrived, t_ns)
        woken = self._wait(deadline, stop_requested)
        if woken >= deadline:
            self.wake_ups.add(woken - deadline, t_ns)
        self.drift_ns = woken - due
        return 0

    def change(self, factor: float, t_ns: int) -> None:
        """Go on with another factor from the point ``t_ns``, which was presented just now.

        Lateness that there was is lost: a run that could not keep up does not race on.
        """
        if factor == self.factor:
            return
        due = self._due(t_ns)
        self.lost_ns += max(0, self._now() - due - self.lost_ns)
        self._wall_start, self._time_start = due, t_ns
        self.factor = factor

    def pause(self, elapsed_ns: int) -> None:
        """Leave wall time out that has passed since the last point."""
        self.paused_ns += elapsed_ns
        self._wall_start += elapsed_ns

    def _due(self, t_ns: int) -> int:
        return self._wall_start + round((t_ns - self._time_start) / self.factor)

    def _wait(self, deadline: int, stop_requested: Callable[[], int]) -> int:
        """Return the wall time at which it was over."""
        while (left := deadline - (now := self._now())) > 0 and not stop_requested():
            if left > self._spin_ns:
                self._sleep(min(left - self._spin_ns, SLICE_NS) / NS)
        return now

    def note(self) -> str:
        """Return for a person how well the run kept its time."""
        paused = f"; {self.paused_ns / NS:.3g} s paused" if self.paused_ns else ""
        if not self.overruns.count:
            return f"no overrun: every step ended before its deadline{paused}"
        said = (
            f"{self.overruns.count} of {self.overruns.count + self.slack.count} steps ended after "
            f"their deadline, the latest {self.overruns.longest_ns / 1e6:.3g} ms, "
            f"at t = {(self.overruns.longest_at_ns or 0) / NS:g} s"
        )
        return said + (f"; {self.lost_ns / NS:.3g} s lost" if self.lost_ns else "") + paused

    def as_json(self) -> dict[str, Any]:
        """Return what ``timing.json`` says of it."""
        return {
            "factor": self.factor,
            "overrun": self.policy,
            "lost_s": self.lost_ns / NS,
            "paused_s": self.paused_ns / NS,
            "drift_s": self.drift_ns / NS,
            "overruns": self.overruns.as_json(),
            "slack": self.slack.as_json(),
            "wake_ups": self.wake_ups.as_json(),
        }
