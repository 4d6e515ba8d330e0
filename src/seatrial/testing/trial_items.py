"""Trials and campaigns in TOML as tests: ``pytest --seatrial trials/*.toml``."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import TYPE_CHECKING, Any

import pytest

from ..api.written import as_engine
from ..errors import InputError, SeatrialError
from ..plugins import service
from ..system.files import read_toml
from .trial_run import TrialRun, limited, run_folder

if TYPE_CHECKING:
    from ..trial.files.trial import Trial


def is_trial_file(path: Path) -> bool:
    """Return whether a TOML file is a trial or a campaign, by its keys; not if it is broken."""
    try:
        content = read_toml(path)[0]
    except InputError:
        return False
    return {"rig", "stop"} <= content.keys() or "trials" in content


class TrialFile(pytest.File):
    """A file with one trial, or a campaign with its cases."""

    def collect(self) -> Iterator[TrialItem]:
        """Yield a test for each run. Raises InputError for what is wrong in the file."""
        from ..trial.files.trial import load_trial

        try:
            if "trials" in read_toml(self.path)[0]:
                cases = service("campaigns.load_campaign")(str(self.path)).cases()
                found = [(case.name, case.trial) for case in cases]
            else:
                loaded = load_trial(str(self.path))
                found = [(loaded.name, loaded)]
        except InputError as error:
            raise self.CollectError(str(error)) from None
        for name, trial in found:
            yield TrialItem.from_parent(self, name=name, loaded=trial)


class TrialFailedError(Exception):
    """A trial of which a criterion is not as expected; the text is for a person."""


class TrialItem(pytest.Item):
    """One trial: it passes if every criterion is as expected."""

    def __init__(self, *, loaded: Trial, **rest: Any) -> None:
        super().__init__(**rest)
        self._loaded = loaded

    def runtest(self) -> None:
        """Run the trial. Raises TrialFailedError, SeatrialError."""
        folder = run_folder(self.config, self.nodeid)
        self.user_properties.append(("seatrial_trial", self._loaded.name))
        engine = as_engine(self.config.getoption("--seatrial-engine"))
        run = TrialRun.of(limited(self._loaded, self.config), folder, engine)
        if run.result.passed:
            run.leave(keep=False)
            return
        said = run.failures()
        ((title, text),) = run.report_sections(failed=True)
        self.add_report_section("call", title, text)
        self.user_properties += run.properties[1:]
        run.leave(keep=True)
        raise TrialFailedError(said)

    def repr_failure(self, excinfo: pytest.ExceptionInfo[BaseException], style: Any = None) -> Any:
        """Return what is shown of a failure: no traceback of ours."""
        if isinstance(excinfo.value, (TrialFailedError, SeatrialError)):
            return str(excinfo.value)
        return super().repr_failure(excinfo, style)

    def reportinfo(self) -> tuple[Path, int | None, str]:
        """Return the place and the name."""
        return self.path, None, self.name
