"""JUnit files of runs: a suite for each trial or case, a test case for each criterion."""

from __future__ import annotations

from collections.abc import Iterable
from pathlib import Path
from xml.etree import ElementTree

from ..printable import printable
from ..trial.records.ending import is_whole
from ..trial.running.run import Result
from ..whole_file import write_whole


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
