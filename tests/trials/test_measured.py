"""Figures of the real vehicles beside the models': the factors of the pages, and what is kept of the runs."""

import importlib.util
import json
from pathlib import Path

import pytest

from seatrial.model.units import split_quantity

DOCS = Path(__file__).parents[2] / "docs"
_SPEC = importlib.util.spec_from_file_location("measured", DOCS / "measured.py")
measured = importlib.util.module_from_spec(_SPEC)
_SPEC.loader.exec_module(measured)
PUBLISHED, KEPT = measured.published(), json.loads(measured.FOUND.read_text("utf-8"))
LIMIT = 1.3
"""Of factors that need no explanation."""


@pytest.mark.parametrize("name", PUBLISHED)
def test_factors_hold_or_are_explained(name):
    explained = 0
    for each in PUBLISHED[name]["figures"]:
        factor = KEPT[name][each["figure"]] / split_quantity(each["real"])[0]
        far = not 1 / LIMIT < factor < LIMIT
        assert far == ("note" in each), (each["figure"], factor)
        explained += far
    assert explained <= 2
    assert {each["use"] for each in PUBLISHED[name]["figures"]} <= {"fitted", "checked"}


@pytest.mark.slow
@pytest.mark.parametrize("name", PUBLISHED)
def test_the_kept_figure_is_that_of_the_model(name):
    first = PUBLISHED[name]["figures"][0]
    assert KEPT[name][first["figure"]] == pytest.approx(
        measured.found(PUBLISHED[name], first), rel=2e-3
    )


@pytest.mark.long
@pytest.mark.parametrize("name", PUBLISHED)
def test_all_kept_figures_are_those_of_the_models(name):
    for each in PUBLISHED[name]["figures"]:
        found = measured.found(PUBLISHED[name], each)
        assert KEPT[name][each["figure"]] == pytest.approx(found, rel=2e-3), each["figure"]
