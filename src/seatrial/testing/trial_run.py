"""A trial that a test has run: its result, conditions on its signals, and its folder."""

from __future__ import annotations

import contextlib
import datetime
import re
import shutil
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING, Any

import pytest

from ..api.results import TrialResult, run_loaded
from ..api.signals import Signals
from ..errors import SeatrialError
from ..system.system import Engine
from ..trial.records.run_folder import is_as_expected
from .holding import During, failure_of, hold_or_fail

if TYPE_CHECKING:
    from ..trial.files.trial import Trial


class TrialRun:
    """The result of a trial in a test; everything of `seatrial.TrialResult` is here too."""

    def __init__(self, loaded: Trial, result: TrialResult) -> None:
        self.result = result
        self.properties = [("seatrial_trial", loaded.name)]
        self._loaded = loaded

    @classmethod
    def of(cls, loaded: Trial, folder: Path, engine: Engine) -> TrialRun:
        """Run a trial under its supervisor, into an empty folder.

        Raises what `seatrial.run_trial` raises; a folder in which nothing was written is removed.
        """
        try:
            return cls(loaded, run_loaded(loaded, folder, engine))
        except SeatrialError:
            with contextlib.suppress(OSError):
                folder.rmdir()
            raise

    def __getattr__(self, name: str) -> Any:
        return getattr(self.result, name)

    @cached_property
    def signals(self) -> Signals:
        """The recorded signals."""
        return self.result.signals

    @cached_property
    def _paths(self) -> dict[str, str]:
        """Recorded names of signals that the criteria name by a rig's shown names."""
        criteria = self.result.manifest["criteria"]
        return {name: path for entry in criteria for name, path in entry["paths"].items()}

    def _path(self, written: str) -> str:
        return self._paths.get(written, written)

    def assert_holds(self, condition: str, *, during: During = None) -> None:
        """Assert a criterion on the recorded signals, ``during`` a part of the run or all of it.

        The times of its operators count from the start of that part. Raises AssertionError with
        the worst moment and a plot, InputError for a condition that does not fit.
        """
        __tracebackhide__ = True
        signals = self.signals
        units = {name: entry["unit"] for name, entry in self.result.manifest["signals"].items()}
        name = self._loaded.name
        hold_or_fail(condition, during, signals.t, signals, units, name, self._path)

    def assert_passed(self) -> None:
        """Assert that the run came to its end and every criterion is as its trial expects."""
        __tracebackhide__ = True
        if not self.result.passed:
            raise AssertionError(self.failures())

    def failures(self) -> str:
        """Return what a person should see of criteria that are not as expected."""
        said = []
        criteria = [
            criterion.renamed({n: self._path(n) for n in criterion.signals})
            for _, criterion in self._loaded.criteria
        ]
        for verdict, criterion in zip(self.result.verdicts, criteria, strict=False):
            if is_as_expected(vars(verdict)):
                continue
            if verdict.passed:
                said.append(f"{verdict.name}: holds, but is expected to fail: {verdict.why}")
            else:
                shown = failure_of(criterion, verdict.detail, self.signals, self._loaded.name)
                said.append(f"{verdict.name}: {shown}")
        if not said:
            said.append(f"{self._loaded.name}: the run is {self.result.status}")
        return "\n\n".join(said)

    def report_sections(self, *, failed: bool) -> list[tuple[str, str]]:
        """Return what a report of the test shows."""
        if not failed:
            return []
        rows = [
            f"{'holds' if v.passed else 'FAILS'}  {v.name}: {v.detail}"
            + (f", margin {v.margin}" if v.margin else "")
            for v in self.result.verdicts
        ]
        rows.append(f"run folder: {self.result.folder}")
        self.properties.append(("seatrial_run", str(self.result.folder)))
        return [("seatrial", "\n".join(rows))]

    def leave(self, *, keep: bool) -> None:
        """Write the report of a run that is kept; remove another."""
        if keep:
            with contextlib.suppress(SeatrialError, OSError):
                self.result.report()
        else:
            shutil.rmtree(self.result.folder, ignore_errors=True)
            with contextlib.suppress(OSError):  # others are in it
                self.result.folder.parent.rmdir()


def limited(loaded: Trial, config: pytest.Config) -> Trial:
    """Return a trial with the limits of ``--seatrial-limit``. Raises InputError."""
    from ..trial.files.limit_entry import limits_of

    option = "--seatrial-limit"
    return loaded.limited(limits_of(config.getoption(option), option), option)


def run_folder(config: pytest.Config, node_id: str) -> Path:
    """Return a new folder for a test's run, which is not there yet."""
    base = config.rootpath / str(config.getoption("--seatrial-runs"))
    name = re.sub(r"[^A-Za-z0-9.]+", "-", node_id.removesuffix("]")).strip("-")[-80:]
    stamp = datetime.datetime.now().strftime("%Y%m%d-%H%M%S")
    for number in range(1, 1000):
        folder = base / f"{name}-{stamp}{f'-{number}' if number > 1 else ''}"
        with contextlib.suppress(FileExistsError):
            folder.mkdir(parents=True)
            return folder
    raise FileExistsError(base / name)
