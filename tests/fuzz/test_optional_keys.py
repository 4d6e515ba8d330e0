"""Files of run and campaign folders without each key that may be left out."""

from __future__ import annotations

import copy
import json
import shutil
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest
from pydantic import ValidationError

from seatrial.trial.records.run_schema import CAMPAIGN, CONVERGENCE, MANIFEST, TIMING, VERDICTS

harness = pytest.importorskip("tests.fuzz.fuzz_run_folder")

SCHEMAS = dict(zip(harness.FILES, (MANIFEST, VERDICTS, TIMING, CONVERGENCE, CAMPAIGN), strict=True))

CLOSED = ("verdicts.json", "convergence.json")
"""Files whose keys are all needed."""


def lacking(content: Any, place: tuple[str | int, ...] = ()) -> Iterator[tuple[str | int, ...]]:
    """Yield the place of every key of a document."""
    children = content.items() if isinstance(content, dict) else enumerate(content)
    for key, value in children:
        if isinstance(content, dict):
            yield (*place, key)
        if isinstance(value, (dict, list)):
            yield from lacking(value, (*place, key))


def without(content: Any, place: tuple[str | int, ...]) -> Any:
    content = copy.deepcopy(content)
    table = content
    for key in place[:-1]:
        table = table[key]
    del table[place[-1]]
    return content


@pytest.mark.parametrize("name", harness.FILES)
def test_a_key_that_may_be_left_out_is_missed_by_no_reader(name: str, tmp_path: Path) -> None:
    folder = tmp_path / "campaign"
    shutil.copytree(harness._template(), folder)
    file = folder / name if name == "campaign.json" else folder / "case" / name
    whole = json.loads(file.read_text())
    tried = set()
    for place in lacking(whole):
        content = without(whole, place)
        try:
            SCHEMAS[name].validate_python(content)
        except ValidationError:
            continue
        generic = tuple("" if isinstance(key, int) else key for key in place)[-2:]
        if generic in tried:
            continue
        tried.add(generic)
        file.write_text(json.dumps(content))
        for read in (harness._report, harness._compare, harness._python, harness._campaign):
            with harness.contextlib.suppress(harness.InputError):
                read(folder, folder / "case")
    assert tried or name in CLOSED


@pytest.mark.parametrize("steps", [[0.0, 0.0, 0.0], [0.01, 0.01, 0.005], [0.01, 0.005, -1.0]])
def test_steps_of_a_convergence_fall_and_stay_above_0(steps: list[float]) -> None:
    whole = json.loads((harness._template() / "case" / "convergence.json").read_text())
    with pytest.raises(ValidationError, match="each smaller than the one before"):
        CONVERGENCE.validate_python({**whole, "steps": steps})
