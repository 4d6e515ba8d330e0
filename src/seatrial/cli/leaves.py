"""A page and a JUnit file that ``seatrial run`` leaves, and the status it ends with."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from dataclasses import dataclass
from pathlib import Path
from xml.etree import ElementTree

import typer

from ..errors import InputError, SimulationError
from ..files.whole_file import write_whole
from ..printable import printable
from ..trial.records.ending import is_whole
from ..trial.running.run import Result
from .show import console, print_notes
from .statuses import FAILED


@dataclass(frozen=True)
class Leaves:
    """What a command leaves besides run folders."""

    junit: Path | None
    report: bool

    def write_page(self, write: Callable[[], Path], results: list[Result]) -> None:
        """Write a page and say where, if one is wanted.

        Raises SimulationError: nothing that a person wrote is wrong with it. Of runs that have
        failed it is a note.
        """
        if not self.report:
            return
        try:
            page = write()
        except (OSError, InputError) as error:
            where = f"{error.filename}: {error.strerror}" if isinstance(error, OSError) else error
            message = f"cannot write the report: {where}"
            if not any(result.status == "failed" for result in results):
                raise SimulationError(message) from None
            print_notes([message])
        else:
            console.print(f"report: {page}", soft_wrap=True)

    def write_junit(self, runs: list[tuple[str, Result]]) -> None:
        """Write the JUnit file, if one is wanted. Raises OSError."""
        if self.junit is not None:
            write_junit(self.junit, runs)


def exit_with(results: list[Result]) -> None:
    """End with the status of runs. Raises SimulationError, typer.Exit."""
    if any(result.status == "failed" for result in results):
        first = next(result.error for result in results if result.status == "failed")
        raise SimulationError(str(first))
    if any(result.status == "stopped" for result in results):
        raise SimulationError("stopped; the signals recorded so far are on disk")
    if not all(result.passed for result in results):
        raise typer.Exit(FAILED)


def write_junit(path: Path, runs: Iterable[tuple[str, Result]]) -> None:
    """Write a JUnit file of runs by name. Raises OSError.

    A criterion that is not as expected is a failure; a run that did not come to its end, or has
    no criteria, is a test case of its own: an error if it failed, skipped if it was stopped.
    """
    root = ElementTree.Element("testsuites", name="seatrial")
    for name, result in runs:
        _add_suite(root, name, result)
    for key in ("tests", "failures", "errors", "skipped"):
        root.set(key, str(sum(int(suite.get(key, "0")) for suite in root)))
    ElementTree.indent(root)
    text = ElementTree.tostring(root, encoding="unicode", xml_declaration=False)
    write_whole(path, f'<?xml version="1.0" encoding="utf-8"?>\n{text}\n')


def _add_suite(root: ElementTree.Element, name: str, result: Result) -> None:
    time = f"{sum(result.wall.values()):.3f}"
    suite = ElementTree.SubElement(root, "testsuite", name=printable(name), time=time)
    properties = ElementTree.SubElement(suite, "properties")
    for key, value in (("status", result.status), ("run", str(result.folder))):
        ElementTree.SubElement(properties, "property", name=key, value=printable(value))
    counts = {"failures": 0, "errors": 0, "skipped": 0}
    for criterion, check, verdict in result.verdicts:
        case = ElementTree.SubElement(
            suite, "testcase", classname=printable(name), name=printable(criterion)
        )
        if not verdict.as_expected:
            counts["failures"] += 1
            said = verdict.detail if not verdict.passed else f"holds against: {verdict.why}"
            failure = ElementTree.SubElement(case, "failure", message=printable(said))
            failure.text = printable(f"{check}: {said}")
    if not result.verdicts or not (is_whole(result.status) or result.status == "ended"):
        case = ElementTree.SubElement(suite, "testcase", classname=printable(name), name="the run")
        if result.status == "stopped":
            counts["skipped"] += 1
            ElementTree.SubElement(case, "skipped", message="not evaluated: the run was stopped")
        elif not (is_whole(result.status) or result.status == "ended"):
            counts["errors"] += 1
            ElementTree.SubElement(case, "error", message=printable(str(result.error)))
    suite.set("tests", str(len(suite) - 1))
    for key, count in counts.items():
        suite.set(key, str(count))
