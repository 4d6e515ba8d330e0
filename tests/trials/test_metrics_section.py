"""Metrics in reports: their values are those of closed forms, in the units of the criteria."""

import numpy as np
import pytest

from seatrial.trial.records.run_folder import load_run
from seatrial.trial.reports.metrics_section import metrics_figure, metrics_of
from seatrial.trial.reports.report import write_report

TIME = np.linspace(0.0, 20.0, 201)
LAG = 1.0 - np.exp(-TIME / 2.0)


@pytest.fixture
def shown(write_run):
    """Return a function that makes a run with criteria of a first-order lag, a.b in rad."""

    def make(*checks):
        folder = write_run(
            "run",
            extra={"a.b": ("rad", LAG)},
            changes={"criteria": [{"name": f"c{i}", "check": c} for i, c in enumerate(checks)]},
        )
        return load_run(folder)

    return make


def test_values_have_the_units_of_the_limits(shown):
    run = shown(
        "rms(a.b from 0 s to 20 s) < 60 deg",
        "overshoot(a.b, 0.5 rad) < 120 %",
        "rise_time(a.b, 1 rad) < 6 s and mean(a.b) < 1 rad",
        "a.b < 2 rad",
        "a.b settles within 15 s",
        "mean(a.missing) < 1 rad",
    )
    found = [(each.criterion, each.text.partition("(")[0], each.value) for each in metrics_of(run)]
    # 1 - e^(-t/2): its mean over 20 s is 0.9, within e^-10; it rises in 2 ln 9 s.
    square = 1.0 - 2 * 0.1 + 0.05
    assert [each[:2] for each in found] == [
        ("c0", "rms"), ("c1", "overshoot"), ("c2", "rise_time"), ("c2", "mean")
    ]  # fmt: skip
    numbers = [each[2].split() for each in found]
    assert [unit for _, unit in numbers] == ["deg", "%", "s", "rad"]
    expected = [np.degrees(np.sqrt(square)), 100.0, 2 * np.log(9.0), 0.9]
    assert [float(value) for value, _ in numbers] == pytest.approx(expected, rel=2e-3)


def test_a_panel_has_the_window_the_target_and_the_band(shown):
    run = shown("settling_time(a.b, 1 rad, 0.05 rad after 4 s) < 5 s")
    [metric] = metrics_of(run)
    # The band is entered at 2 ln 20 = 5.99 s, 1.99 s after the window begins.
    assert float(metric.value.split()[0]) == pytest.approx(2 * np.log(20.0) - 4.0, rel=2e-3)
    [line] = metric.panel.lines
    assert metric.panel.unit == "rad"
    assert np.isnan(line.values[:40]).all()
    assert line.values[40:] == pytest.approx(LAG[40:])
    assert [(m.label, m.value) for m in metric.panel.marks] == [
        ("target", 1.0), ("band", 0.95), ("band", 1.05)
    ]  # fmt: skip


def test_the_report_lists_and_draws_them(shown):
    run = shown("rms(a.b) < 60 deg")
    page = write_report(run.folder).read_text("utf-8")
    assert "<h2>Metrics</h2>" in page
    assert "<code>rms(a.b)</code>" in page
    assert metrics_figure(run, []) is None


def test_a_report_without_metrics_has_no_such_section(shown):
    run = shown("a.b < 2 rad")
    assert metrics_of(run) == []
    assert "<h2>Metrics</h2>" not in write_report(run.folder).read_text("utf-8")
