"""Processes that run the cases of a campaign: of this machine, or those that `cluster` has."""

from __future__ import annotations

import os
from collections.abc import Sequence
from concurrent.futures import Future, ThreadPoolExecutor
from pathlib import Path
from queue import SimpleQueue
from typing import Protocol

from seatrial.trial.running.hooks import Hooks

from .asked import Asked
from .case_list import Cases
from .ended import Ended
from .evaluator import Evaluator, Plan
from .pool import cores

_TASK_S = 0.5
"""s of wall time, in which nothing is seen of a task's cases."""
_MOST_CASES = 32

Task = Sequence[int]
"""Numbers of cases that are run one after the other; one, unless they are short."""


class Workers(Protocol):
    """Runs tasks side by side."""

    @property
    def places(self) -> int:
        """How many tasks are worth having under way."""

    def size(self, wall: float) -> int:
        """Return how many cases a task has whose cases take ``wall`` s each."""

    def submit(self, task: Task, below: Path) -> Future[list[Ended | None]]:
        """Begin a task with folders ``below``. None in the place of a case that was stopped."""

    def lost(self, error: BaseException) -> bool:
        """Say if an error of a task is that its worker died, and others that took it over."""

    def close(self) -> None:
        """End what runs."""


class Here:
    """Processes of this machine, an `Evaluator` each; ``jobs`` None: as many as there are cores."""

    def __init__(self, cases: Cases | Asked, plan: Plan, jobs: int | None, hooks: Hooks) -> None:
        self._closing = False
        self._shares = plan.engine == "native" and not plan.recorded
        count = 1
        if hasattr(os, "fork") and not plan.recorded:
            count = jobs or cores()
            if isinstance(cases, Cases):
                count = min(count, len(cases))

        def asked() -> int:
            return 2 if self._closing else hooks.stop_requested()

        own = Hooks(stop_requested=asked)
        self._evaluators = [Evaluator(cases, plan, own) for _ in range(count)]
        self._idle: SimpleQueue[Evaluator] = SimpleQueue()
        for evaluator in self._evaluators:
            self._idle.put(evaluator)
        self._threads = ThreadPoolExecutor(count)
        self.places = 2 * count

    def size(self, wall: float) -> int:
        """Return how many cases make a task of `_TASK_S`, if they may share a program, else 1."""
        return min(max(1, int(_TASK_S / max(wall, 1e-6))), _MOST_CASES) if self._shares else 1

    def submit(self, task: Task, below: Path) -> Future[list[Ended | None]]:
        """Begin a task."""
        return self._threads.submit(self._ended, task, below)

    def lost(self, error: BaseException) -> bool:
        """Return False: what dies is no worker, but the process of its evaluator."""
        return False

    def close(self) -> None:
        """End what runs."""
        self._closing = True
        self._threads.shutdown(cancel_futures=True)
        for evaluator in self._evaluators:
            evaluator.__exit__()

    def _ended(self, task: Task, below: Path) -> list[Ended | None]:
        evaluator = self._idle.get()
        evaluator.foresee(task)
        try:
            return [evaluator.ended(number, below) for number in task]
        finally:
            self._idle.put(evaluator)
