"""Drawings of manoeuvres: valid for Plotly, in ship lengths, overshoots where they are."""

import json
import math

import numpy as np
import plotly.graph_objects as go
import pytest

from seatrial_kits.sea_trials.curves import drawings
from seatrial_kits.sea_trials.drawing import heading_and_helm, rows_of, track
from seatrial_kits.sea_trials.evaluation import Done, figures_of
from seatrial_kits.sea_trials.figures.record import Record
from seatrial_kits.sea_trials.figures.result import Figure, Figures
from seatrial_kits.sea_trials.orders import KINDS

from .references import FIGURES, columns, record

TURN, ZIG_ZAG = "kvlcc2_full_turn_m35", "kvlcc2_full_zigzag_20_20"


@pytest.fixture(scope="module")
def turn():
    return Done("turning-circle", record(TURN), length=320.0, beam=58.0)


@pytest.fixture(scope="module")
def zig_zag():
    return Done("zig-zag", record(ZIG_ZAG), heading=math.radians(20.0), length=320.0)


def drawn(figure):
    return go.Figure(json.loads(figure.json()))


def test_every_drawing_is_valid(turn, zig_zag):
    for done in (turn, zig_zag):
        for title, figure in drawings(done, figures_of(done)):
            assert title
            assert drawn(figure).layout.height > 0


def test_the_track_is_in_ship_lengths(turn):
    line, outlines = track([turn]).data
    _, north, east, *_ = columns(TURN)
    assert line["y"].max() == pytest.approx(north.max() / 320.0)
    assert line["x"].min() == pytest.approx(east.min() / 320.0)
    first = np.column_stack((outlines["x"], outlines["y"]))[:6]
    assert np.ptp(first[:, 1]) == pytest.approx(1.0)
    assert np.ptp(first[:, 0]) == pytest.approx(58.0 / 320.0)


def test_every_other_manoeuvre_is_drawn():
    time = np.arange(0.0, 400.0, 1.0)
    turned = 0.02 * np.maximum(time - 60.0, 0.0)
    rec = Record(time, 5.0 * time, 0.1 * time, turned, np.where(time < 60.0, 0.0, 0.3),
                 pitch=0.2 * np.sin(0.1 * time), depth=5.0 + np.sin(0.1 * time),
                 pull=100.0 + time, power=50.0 + time)  # fmt: skip
    found = Figures("any", {"radius_95": Figure(3.0, "m"), "speed_1": Figure(2.0, "m/s"),
                            "power_1": Figure(9.0, "W"), "speed_2": Figure(1.0, "m/s"),
                            "power_2": Figure(1.0, "W")})  # fmt: skip
    orders = (60.0, 120.0, 180.0, 240.0)
    for kind in sorted(KINDS.keys() - {"spiral"}):
        done = Done(kind, rec, orders, length=5.0)
        for title, figure in drawings(done, found):
            assert title
            assert drawn(figure).layout.height > 0


def test_without_a_length_the_track_is_in_metres():
    (line,) = track([Done("turning-circle", record(TURN))]).data
    assert line["y"].max() > 900.0


def test_overshoots_are_marked_at_the_largest_headings(zig_zag):
    figure = drawn(heading_and_helm(zig_zag, figures_of(zig_zag)))
    marked = [trace for trace in figure.data if trace.mode == "markers+text"]
    expected = FIGURES[ZIG_ZAG]["figures"]
    for number, trace in enumerate(marked, 1):
        overshoot = expected[f"overshoot_{number}_deg"]
        assert trace.y[0] == pytest.approx((20.0 + overshoot) * (-1) ** (number + 1), abs=0.01)
        assert trace.text[0] == f"{overshoot:.1f}°"
    assert len(marked) == 4


def test_rows_have_the_unit_and_the_ratio(turn):
    rows = {name: (value, ratio) for name, value, ratio in rows_of(figures_of(turn), 320.0)}
    assert rows["advance"] == ("960.4 m", "3.001 L")
    assert rows["steady rate"][0] == "-0.4934 deg/s"
    assert rows["largest heel"] == ("–", "the record has no roll")
