"""Evaluation of cases one after the other: a process of their own, and another once that dies."""

from __future__ import annotations

import platform
import shutil
import threading
import time
from collections.abc import Iterator, Mapping, Sequence
from contextlib import chdir, contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Literal, overload

from seatrial.errors import InputError, SimulationError
from seatrial.system.system import Engine
from seatrial.trial.files.trial import Trial
from seatrial.trial.running.hooks import BeyondLimitError, Hooks, InterruptedRun, StoppedError
from seatrial.trial.running.measuring import Measured, measured_of
from seatrial.trial.running.run import Result
from seatrial.trial.running.supervision import Changes, Order, Outcome, Supervisor

from .asked import Asked
from .case_list import Cases
from .cases import case_folder
from .ended import Ended

Keep = Literal["all", "failed", "none"]
_FORKING = threading.Lock()
"""A process is copied while no other thread imports or copies."""


@dataclass(frozen=True)
class Plan:
    """How the cases of a campaign are run, and which folders stay."""

    engine: Engine = "fmu"
    keep: Keep = "failed"
    samples: int = 0
    """One case in so many keeps its folder whatever becomes of it; 0: none."""
    recorded: bool = False
    """Each is run into a folder at once: links are safe there, and their runs are not repeated."""

    def keeps(self, number: int, *, passed: bool) -> bool:
        """Say if the folder of a case stays."""
        sampled = self.samples > 0 and number % self.samples == 0
        return sampled or self.keep == "all" or (self.keep == "failed" and not passed)


class _Trials(Sequence[Trial]):
    """The trials of cases, each made when it is asked for."""

    def __init__(self, cases: Cases) -> None:
        self._cases = cases

    def __len__(self) -> int:
        return len(self._cases)

    @overload
    def __getitem__(self, number: int) -> Trial: ...

    @overload
    def __getitem__(self, number: slice) -> list[Trial]: ...

    def __getitem__(self, number: int | slice) -> Trial | list[Trial]:
        if isinstance(number, slice):
            return [case.trial for case in self._cases[number]]
        return self._cases[number].trial


class Evaluator:
    """Runs cases one after the other, in one process for as long as that lives.

    A case is measured (`measure_trial`), and run again into a folder if that is kept: the same
    settings give the same bytes. One whose process dies is run into a folder at once, where each
    call of a component is noted; if it dies there too it has failed, and its error says where.
    ``home`` is the folder that its process is in (None: the one of now). Use it from one thread at
    a time, as a context manager.
    """

    def __init__(
        self, cases: Cases | Asked, plan: Plan, hooks: Hooks | None = None, home: Path | None = None
    ) -> None:
        self._cases, self._plan, self._home = cases, plan, home or Path.cwd()
        trials: Sequence[Trial]
        if isinstance(cases, Asked):
            trials = alike = [cases.base]
        else:
            trials, alike = _Trials(cases), [block.case(0).trial for block in cases.blocks]
        self._supervisor = Supervisor(trials, plan.engine, hooks, alike=alike)
        self._ahead: Sequence[int] = ()
        self._foreseen: dict[int, Measured] = {}

    def __enter__(self) -> Evaluator:
        return self

    def __exit__(self, *_: object) -> None:
        self._supervisor.__exit__(None, None, None)

    def expect(self, rows: Mapping[int, Mapping[str, Any]]) -> None:
        """Take what cases set that a question asks for, by number."""
        assert isinstance(self._cases, Asked)
        self._cases.rows.update(rows)

    def foresee(self, numbers: Sequence[int]) -> None:
        """Take the numbers of cases that will be asked for next: some are measured together."""
        self._ahead = numbers if self._plan.engine == "native" and not self._plan.recorded else ()

    def check(self, number: int) -> bool:
        """Return whether a case must run alone. Raises what `Supervisor.check` raises."""
        return self._carried_out("check", number) is True

    def measured(self, number: int) -> Measured:
        """Measure a case. Raises what `Supervisor.measure` raises."""
        ahead, self._ahead = self._ahead, ()  # if their process dies, each gets its own
        if ahead:
            self._foreseen = self._together(ahead)
        if number in self._foreseen:
            return self._foreseen.pop(number)
        measured = self._carried_out("measure", number)
        assert isinstance(measured, Measured)
        return measured

    def ended(self, number: int, below: Path) -> Ended | None:
        """Run a case, in a folder of its own ``below``, to its end; None if it was stopped."""
        name = case_folder(number + 1, self._cases[number])
        begun, folder = time.time(), below / name
        try:
            measured, ran = self._attempted(number, folder)
            if measured.status == "stopped":
                shutil.rmtree(folder, ignore_errors=True)
                return None
            keeps = self._plan.keeps(number, passed=measured.passed)
            if keeps and not ran:
                self._recorded(number, folder)
        except StoppedError:
            return None
        except InputError as error:
            measured, keeps = Measured("failed", str(error)), False
        if not keeps:
            shutil.rmtree(folder, ignore_errors=True)
        kept = name if folder.is_dir() else ""
        return Ended(number, measured, kept, platform.node(), begun)

    # ------------------------------------------------------------------ inside

    def _together(self, numbers: Sequence[int]) -> dict[int, Measured]:
        """Measure cases that can share a program, in one order; return what was found."""
        try:
            found = self._carried_out("measure together", numbers[0], several=numbers)
        except StoppedError:
            raise
        except SimulationError:
            return {}
        assert isinstance(found, list)
        pairs = zip(numbers, found, strict=False)
        return {number: each for number, each in pairs if each is not None}

    def _attempted(self, number: int, folder: Path) -> tuple[Measured, bool]:
        """Return what a case comes to, and whether it ran into its folder."""
        if not self._plan.recorded:
            try:
                return self.measured(number), False
            except StoppedError:
                raise
            except BeyondLimitError as error:
                if not self._plan.keeps(number, passed=False):
                    return Measured("failed", str(error)), True
            except SimulationError:
                pass  # its process died: once more, with each call noted
        return self._recorded(number, folder), True

    def _recorded(self, number: int, folder: Path) -> Measured:
        """Run a case into a folder, in place of what was there."""
        shutil.rmtree(folder, ignore_errors=True)
        try:
            result = self._carried_out("run", number, folder)
        except StoppedError:
            raise
        except SimulationError as error:
            return Measured("failed", str(error))
        assert isinstance(result, Result)
        return measured_of(result)

    def _carried_out(
        self, what: Order, number: int, folder: Path | None = None, several: Sequence[int] = ()
    ) -> Outcome:
        placed = [self._placed(each) for each in several]
        number, changes = self._placed(number)
        with _FORKING, chdir(self._home):
            self._supervisor.begin(what, number, folder, changes, placed)
        try:
            while (outcome := self._supervisor.poll()) is None:
                pass
        except InterruptedRun:
            raise StoppedError("stopped before the run began; nothing was written") from None
        return outcome

    def _placed(self, number: int) -> tuple[int, Changes | None]:
        """Return which of its trials the supervisor takes for a case, and what changes in it."""
        if isinstance(self._cases, Asked):
            return 0, self._cases.changes(number)
        return number, None


@contextmanager
def still() -> Iterator[None]:
    """Copy no process while this goes on."""
    with _FORKING:
        yield
