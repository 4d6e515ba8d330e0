"""Comparing runs."""

from __future__ import annotations

import io

import numpy as np
import pytest
from rich.console import Console

from seatrial.trial.records.compare import compare


def both(write_run, one, other):
    return compare(write_run("a", **one), write_run("b", **other))


def text(comparison):
    file = io.StringIO()
    Console(file=file, width=140, color_system=None).print(comparison.table(), comparison.summary)
    return file.getvalue()


def test_identical_runs(write_run):
    found = both(write_run, {}, {})
    assert (found.identical, found.worst) == (True, 0.0)
    assert found.rows == (201, 201, 201)
    assert found.changes == ()
    assert found.within(0.0)
    assert "identical bytes (201 common times of 201 and 201)" in text(found)


def test_greatest_difference_and_its_time(write_run):
    ramp = np.linspace(0, 40, 201)
    bent = ramp.copy()
    bent[50] += 0.04
    found = both(write_run, {"extra": {"a.b": ("m", ramp)}}, {"extra": {"a.b": ("m", bent)}})
    [row] = [d for d in found.differences if d.signal == "a.b"]
    assert row.absolute == pytest.approx(0.04)
    assert row.relative == pytest.approx(0.001)
    assert row.time == 5.0
    assert found.summary.startswith("equal within 0.001 of each signal's greatest value (201")
    assert found.within(0.0011)
    assert not found.within(0.0009)
    assert text(found).index("a.b") < text(found).index("hull.position.x")


def test_directions_are_compared_the_shorter_way_round(write_run):
    almost = np.full(201, np.pi - 0.01)
    turned = np.full(201, 4 * np.pi)
    found = both(
        write_run,
        {"extra": {"a.b": ("rad", almost), "a.c": ("rad", turned), "a.d": ("m", almost)}},
        {"extra": {"a.b": ("rad", -almost), "a.c": ("rad", 0 * turned), "a.d": ("m", -almost)}},
    )
    gaps = {d.signal: d.absolute for d in found.differences if d.signal.startswith("a.")}
    expected = {"a.b": 0.02, "a.c": 4 * np.pi, "a.d": 2 * np.pi - 0.02}
    assert gaps == pytest.approx(expected)


def test_signals_of_one_run_only_and_other_units(write_run):
    ones = np.ones(201)
    found = both(
        write_run,
        {"extra": {"a.b": ("m", ones), "a.c": ("m", ones)}},
        {"extra": {"a.b": ("cm", ones), "a.d": ("m", ones)}},
    )
    notes = {d.signal: d.note for d in found.differences if d.note}
    assert notes == {"a.b": "b has it in cm", "a.c": "not in b", "a.d": "not in a"}
    assert "; 3 signals not compared (201" in found.summary
    assert not found.within(1.0)
    assert "not in b" in text(found)


def test_text_and_what_is_not_a_number(write_run):
    gap = np.ones(201)
    gap[7] = np.nan
    words = ["same"] * 201
    other = [*words[:-2], "else", "else"]
    found = both(
        write_run,
        {"extra": {"a.gap": ("m", gap), "a.same": ("m", gap), "a.word": ("1", words)}},
        {"extra": {"a.gap": ("m", np.ones(201)), "a.same": ("m", gap), "a.word": ("1", other)}},
    )
    rows = {d.signal: d for d in found.differences}
    assert (rows["a.gap"].absolute, rows["a.gap"].time) == (np.inf, pytest.approx(0.7))
    assert found.summary.startswith("not equal: only one run has a number somewhere")
    assert rows["a.same"].absolute == 0.0
    assert rows["a.word"].absolute is None
    assert rows["a.word"].relative == pytest.approx(2 / 201)
    assert rows["a.word"].time == pytest.approx(19.9)


def test_only_common_times_count(write_run):
    folder = write_run("b")
    lines = (folder / "signals.csv").read_text().splitlines(keepends=True)
    (folder / "signals.csv").write_text("".join([lines[0], *lines[1::10]]))
    found = compare(write_run("a"), folder)
    assert found.rows == (21, 201, 21)
    assert (found.identical, found.worst) == (False, 0.0)
    (folder / "signals.csv").write_text(lines[0])
    found = compare(write_run("c"), folder)
    assert found.summary == "nothing in common to compare (0 common times of 201 and 0)"


def test_what_was_set_differently(write_run):
    found = both(write_run, {}, {"scenario": "diagonal_fore", "changes": {"engine": "fmu"}})
    assert [(c.name, c.a, c.b) for c in found.changes] == [
        ("engine", "direct", "fmu"),
        ("downwash.pad.x", 0.0, 0.319),
    ]
    assert "downwash.pad.x" in text(found)


def test_names_are_not_taken_for_markup(write_run):
    found = compare(write_run("[red]a"), write_run("b", changes={"variant": "[bold]x"}))
    assert "[red]a" in text(found)
    assert "[bold]x" in text(found)


def test_a_signal_that_is_zero_in_both(write_run):
    zeros = np.zeros(201)
    found = both(write_run, {"extra": {"a.b": ("m", zeros)}}, {"extra": {"a.b": ("m", zeros)}})
    assert found.differences[-1].relative == 0.0
