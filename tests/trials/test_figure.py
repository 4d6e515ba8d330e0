"""Figures as JSON for Plotly, against Plotly's own Python library."""

from __future__ import annotations

import base64
import json

import numpy as np
import plotly.graph_objects as go
import pytest
from plotly.subplots import make_subplots

from seatrial.trial.reports.figure import Figure
from seatrial.trial.reports.plots import (
    Deck,
    Event,
    Line,
    Mark,
    PadPoint,
    Panel,
    deck_figure,
    time_figure,
)


def decoded(figure: Figure):
    return json.loads(figure.json())


def array(written):
    return np.frombuffer(base64.b64decode(written["bdata"]), written["dtype"])


def figures():
    time = np.linspace(0.0, 1.0, 11)
    panel = Panel("roll", "deg", [Line("a", time), Line("b", 2 * time)], [Mark("limit", 1.0)])
    yield time_figure(time, [[panel, panel], [panel]], events=[Event("1", "1: it fails", 0.5, 0.7)])
    yield deck_figure([Deck("landing", [PadPoint(0.1, 0.2, ["a"], 1, 1)], (2.0, 1.0))] * 2)


@pytest.mark.parametrize("figure", list(figures()))
def test_plotly_knows_every_attribute(figure: Figure) -> None:
    """Its library refuses what its reference does not have."""
    go.Figure(figure.data, figure.layout)


@pytest.mark.parametrize("gap", [None, 0.07])
def test_pairs_of_axes_side_by_side(gap: float | None) -> None:
    ours = Figure(["one", "two", "three"], gap)
    theirs = json.loads(
        make_subplots(
            rows=1, cols=3, subplot_titles=["one", "two", "three"], horizontal_spacing=gap
        ).to_json()
    )["layout"]
    for name in ("xaxis", "yaxis", "xaxis2", "yaxis2", "xaxis3", "yaxis3"):
        assert ours.layout[name]["anchor"] == theirs[name]["anchor"]
        assert ours.layout[name]["domain"] == pytest.approx(theirs[name]["domain"])
    for mine, other in zip(ours.layout["annotations"], theirs["annotations"], strict=True):
        assert mine.pop("x") == pytest.approx(other.pop("x"))
        assert mine == other


def test_arrays_are_singles_where_nobody_sees_it() -> None:
    figure = Figure()
    wave, ripple = np.sin(np.arange(100.0)), 2.0 + 1e-7 * np.sin(np.arange(100.0))
    figure.trace("scatter", x=wave, y=ripple)
    (trace,) = decoded(figure)["data"]
    assert trace["x"]["dtype"] == "f4"
    assert array(trace["x"]) == pytest.approx(wave, abs=1e-6)
    assert trace["y"]["dtype"] == "f8"  # its steps would be drawn
    assert (array(trace["y"]) == ripple).all()


@pytest.mark.parametrize(
    "values", [[], [np.nan, np.nan], [np.inf, 1.0, 2.0], [1e300, 0.0], [0.1, 0.1]]
)
def test_odd_arrays(values: list[float]) -> None:
    figure = Figure()
    figure.trace("scatter", y=np.array(values))
    found = array(decoded(figure)["data"][0]["y"])
    np.testing.assert_allclose(found, values, rtol=1e-6)


def test_markup_stays_inside_the_script() -> None:
    figure = Figure()
    figure.lay_out(title={"text": "</script>"})
    assert "<" not in figure.json()
    assert decoded(figure)["layout"]["title"]["text"] == "</script>"
