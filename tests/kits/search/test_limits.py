"""Limits: boundaries in closed form are found with fewer runs than a grid needs."""

import json
import math
import sys

import numpy as np
import pandas as pd
import pytest
from scipy.interpolate import RegularGridInterpolator

from seatrial.errors import InputError, SimulationError
from seatrial.trial.running.hooks import Hooks
from seatrial_kits.campaigns.results.page import write_table_page
from seatrial_kits.campaigns.sweep import How
from seatrial_kits.search.ask import ask
from seatrial_kits.search.limits import SURE, find_boundary

ELLIPSE = '[ask.vary]\n"form.a" = { uniform = ["0 m", "4 m"] }\n"form.b" = { uniform = ["10 kg", "50 kg"] }\n'


def circle(points):
    return 1.0 - np.hypot(points[:, 0] - 0.45, points[:, 1] - 0.55) / 0.3


def stability(points):
    """Return 1 less the spectral radius of y'' = a y' + b y: Jury's triangle |a| < 1 - b, b > -1."""
    a, b = 6.0 * points[:, 0] - 3.0, 3.0 * points[:, 1] - 1.5
    roots = np.sqrt((a * a + 4.0 * b).astype(complex))
    return 1.0 - np.maximum(np.abs(a + roots), np.abs(a - roots)) / 2.0


def in_triangle(points):
    a, b = 6.0 * points[:, 0] - 3.0, 3.0 * points[:, 1] - 1.5
    return (np.abs(a) < 1.0 - b) & (b > -1.0)


def sphere(points):
    return 1.0 - np.linalg.norm(points - 0.5, axis=1) / 0.35


def jump(points):
    """Return what says nothing of how near the boundary is."""
    return np.where(circle(points) > 0, 1.0, -5.0)


def grid_error(value, passes, runs, dimensions, test):
    """Return the share of points mistaken by linear interpolation on a grid of as many runs."""
    line = np.linspace(0.0, 1.0, round(runs ** (1 / dimensions)))
    nodes = np.stack(np.meshgrid(*[line] * dimensions, indexing="ij"), -1).reshape(-1, dimensions)
    values = value(nodes).reshape([len(line)] * dimensions)
    return ((RegularGridInterpolator([line] * dimensions, values)(test) > 0) != passes).mean()


@pytest.mark.parametrize(
    ("value", "dimensions", "runs", "most", "gain"),
    [
        (circle, 2, 36, 0.001, 10.0),
        (stability, 2, 64, 0.025, 1.5),
        pytest.param(stability, 2, 144, 0.008, 2.5, marks=pytest.mark.interop),
        pytest.param(sphere, 3, 125, 0.001, 20.0, marks=pytest.mark.interop),
        pytest.param(jump, 2, 144, 0.03, 1.5, marks=pytest.mark.interop),
    ],
)
def test_a_known_boundary_is_nearer_than_on_a_grid(value, dimensions, runs, most, gain):
    test = np.random.default_rng(1).random((20_000, dimensions))
    passes = in_triangle(test) if value is stability else value(test) > 0
    assert (passes == (value(test) > 0)).all()
    boundary = find_boundary(value, dimensions, runs)
    assert len(boundary.points) == runs
    mean, sigma = boundary.surrogate.at(test)
    mistaken = (mean > 0) != passes
    assert mistaken.mean() < most
    assert gain * mistaken.mean() < grid_error(value, passes, runs, dimensions, test)
    if value is not jump:  # whose uncertainty is greater
        sure = np.abs(mean) > SURE * sigma
        assert sure.mean() > 0.75
    assert mistaken[np.abs(mean) > SURE * sigma].mean() < 0.01


@pytest.mark.slow
def test_a_trial_s_boundary_is_that_of_its_closed_form(asked, tmp_path):
    of_cases = '[map]\nx = "form.a"\ny = "form.c"\n'  # and not of a question's runs
    text = f"{ELLIPSE}[ask.limits]\nruns = 30\n{of_cases}"
    campaign = asked("ellipse", "form.y < 1 m", text)
    expected = []
    finding, folder = ask(
        campaign, "limits", tmp_path / "out", How("direct", jobs=2), expect=expected.append
    )
    assert finding.runs == 30
    assert expected == [30]
    assert finding.values["passes"] == pytest.approx(math.pi / 16, abs=0.01)
    table = pd.read_parquet(folder / "boundary.parquet")
    distance = np.hypot(table["form.a"] - 2.0, (table["form.b"] - 30.0) / 10.0)
    assert len(table) > 50
    assert distance.to_numpy() == pytest.approx(1.0, abs=0.05)
    assert (np.abs(distance - 1.0) / 4.0 < 2.0 * table["half-width"] + 0.001).mean() > 0.9
    runs = pd.read_parquet(folder / "results.parquet")
    values = np.hypot(runs["form.a"] - 2.0, (runs["form.b"] - 30.0) / 10.0)
    assert runs["robustness of within"].to_numpy() == pytest.approx(1.0 - values, abs=1e-12)
    assert json.loads((folder / "answer.json").read_text())["values"] == finding.values
    assert (folder / "limits.png").read_bytes().startswith(b"\x89PNG")
    page = write_table_page(folder).read_text("utf-8")
    assert "<svg" in page
    assert "Points of the boundary" in page


@pytest.mark.long
@pytest.mark.interop
def test_an_answer_does_not_depend_on_who_runs_it_nor_on_a_stop(asked, tmp_path):
    campaign = asked("ellipse", "form.y < 1 m", f"{ELLIPSE}[ask.limits]\nruns = 30\n")
    for jobs in (1, 3):
        ask(campaign, "limits", tmp_path / f"j{jobs}", How("direct", jobs=jobs))
    ended, stop = [], []
    hooks = Hooks(stop_requested=lambda: len(stop))

    def done(_case, case):
        ended.append(case.number)
        if len(ended) == 20:
            stop.append(True)

    target = tmp_path / "stopped"
    with pytest.raises(SimulationError, match="--resume goes on"):
        ask(campaign, "limits", target, How("direct", jobs=2), hooks, done)
    stop.clear()
    before = len(ended)
    ask(campaign, "limits", target, How("direct", jobs=2, resume=True), hooks, done)
    assert before < 30
    assert ended[before:] == [*range(30)]
    names = ("results.parquet", "boundary.parquet", "answer.json", "limits.svg", "campaign.json")
    for name in names:
        whole = (tmp_path / "j1" / name).read_bytes()
        assert (tmp_path / "j3" / name).read_bytes() == whole
        assert (target / name).read_bytes() == whole
    again, _ = ask(campaign, "limits", target, How("direct", resume=True))
    assert again.runs == 30
    other = asked("ellipse", "form.y < 1 m", f"{ELLIPSE}[ask.limits]\nruns = 40\n")
    with pytest.raises(InputError, match="another campaign"):
        ask(other, "limits", target, How("direct", resume=True))


@pytest.mark.parametrize(
    ("text", "question", "said"),
    [
        ("", "limit", "unknown question 'limit'; did you mean 'limits'"),
        ("", "limits", "ask: nothing varies"),
        (f'{ELLIPSE}[ask.limits]\ncriterion = "witin"\n', "limits", "did you mean 'within'"),
        (f'{ELLIPSE}[ask.limits]\nkeys = ["form.a"]\n', "limits", "two or three keys, and 1 vary"),
        (f'{ELLIPSE}[ask.limits]\nkeys = ["form.A"]\n', "limits", "unknown key 'form.A'"),
        (f"{ELLIPSE}seed = {{ integers = [1, 9] }}\n", "limits", "seed: it has whole numbers"),
        (f'{ELLIPSE}"form.q" = {{ uniform = [0, 1] }}\n', "limits", "unknown port 'q'"),
        (f'[ask]\ntrial = "forms"\n{ELLIPSE}', "limits", "did you mean 'form'"),
        (f'[grid]\n"form.c" = [1, 2]\n{ELLIPSE}', "limits", "grid has 2 values of form.c"),
    ],
)
def test_what_is_wrong_is_said_before_a_folder_is_there(asked, tmp_path, text, question, said):
    campaign = asked("ellipse", "form.y < 1 m", text)
    with pytest.raises(InputError, match=said):
        ask(campaign, question, tmp_path / "out", How("direct", jobs=1))
    assert not (tmp_path / "out").exists()


def test_a_library_that_is_missing_is_named(asked, tmp_path, monkeypatch):
    monkeypatch.setitem(sys.modules, "sklearn", None)
    campaign = asked("ellipse", "form.y < 1 m", ELLIPSE)
    with pytest.raises(InputError, match=r"sklearn: python -m pip install 'seatrial\[search\]'"):
        ask(campaign, "limits", tmp_path / "out", How("direct"))
