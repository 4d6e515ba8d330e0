"""Worst cases: known minima are found, failing cases shrink to the known boundary, and stay."""

import math
import tomllib

import numpy as np
import pandas as pd
import pytest

from seatrial.errors import InputError
from seatrial.trial.files.trial import load_trial
from seatrial.trial.running.run import run_trial
from seatrial_kits.campaigns.sweep import How
from seatrial_kits.search.ask import ask
from seatrial_kits.search.searches import search
from seatrial_kits.search.shrinking import Shrinking

SUM = '[ask.vary]\n"form.a" = { uniform = ["-10 m", "10 m"] }\n"form.b" = { uniform = ["-20 kg", "20 kg"] }\n"form.c" = { uniform = [-10, 10] }\n'


def branin(points):
    """Return Branin's function: three minima of 0.397887 (Dixon and Szegö 1978)."""
    x, y = 15.0 * points[:, 0] - 5.0, 15.0 * points[:, 1]
    bent = y - 5.1 / (4.0 * math.pi**2) * x**2 + 5.0 / math.pi * x - 6.0
    return bent**2 + 10.0 * (1.0 - 1.0 / (8.0 * math.pi)) * np.cos(x) + 10.0


def hartmann(points):
    """Return Hartmann's function of six variables: its least value is -3.32237 (ibid.)."""
    a = np.array([1.0, 1.2, 3.0, 3.2])
    A = np.array(
        [
            [10, 3, 17, 3.5, 1.7, 8],
            [0.05, 10, 17, 0.1, 8, 14],
            [3, 3.5, 1.7, 10, 17, 8],
            [17, 8, 0.05, 10, 0.1, 14],
        ]
    )
    P = 1e-4 * np.array(
        [
            [1312, 1696, 5569, 124, 8283, 5886],
            [2329, 4135, 8307, 3736, 1004, 9991],
            [2348, 1451, 3522, 2883, 3047, 6650],
            [4047, 8828, 8732, 5743, 1091, 381],
        ]
    )
    return -(a * np.exp(-(A * (points[:, None, :] - P) ** 2).sum(axis=2))).sum(axis=1)


@pytest.mark.parametrize(
    ("method", "value", "dimensions", "least", "within"),
    [
        ("cma-es", branin, 2, 0.397887, 1e-3),
        pytest.param("cma-es", hartmann, 6, -3.32237, 0.1, marks=pytest.mark.interop),
        pytest.param("bayesian", branin, 2, 0.397887, 0.01, marks=pytest.mark.interop),
        pytest.param("bayesian", hartmann, 6, -3.32237, 0.25, marks=pytest.mark.interop),
        ("cma-es", lambda points: np.abs(points[:, 0] - 0.9), 1, 0.0, 0.02),
    ],
)
def test_known_minima_are_found(method, value, dimensions, least, within):
    found = [search(method, value, np.full(dimensions, 0.5), 300, seed=3) for _ in range(2)]
    points, values = found[0]
    assert len(values) == 300
    assert (points >= 0).all()
    assert (points <= 1).all()
    assert least - 1e-5 < values.min() < least + within
    assert (found[1][0] == points).all()


def plane(points):
    """Fails beyond a plane that is 0.4 from the middle."""
    return 0.4 - (points - 0.5) @ np.array([0.6, 0.8])


def ball(points):
    """Fails within a ball whose surface is 0.3 from the middle."""
    return np.linalg.norm(points - np.array([0.9, 0.8]), axis=1) - 0.2


def strip(points):
    """Fails where the first key is large, whatever the second is; values say nothing of how far."""
    return np.where(points[:, 0] > 0.8, -1.0, 1.0)


@pytest.mark.parametrize(
    ("value", "first", "distance", "changed"),
    [
        (plane, "distance", 0.4, 2),
        (ball, "distance", 0.3, 2),
        (strip, "keys", 0.3, 1),
        (lambda p: 0.3 - (p - 0.5) @ np.array([0.6, 0.8]), "keys", 0.375, 1),
    ],
)
def test_a_failing_point_becomes_the_nearest_that_fails(value, first, distance, changed):
    shrinking = Shrinking(value, np.array([0.5, 0.5]))
    point = shrinking.shrunk(np.array([0.95, 0.9]), first)
    assert value(point[None])[0] <= 0
    assert distance - 1e-9 < shrinking.distance(point) < 1.015 * distance
    assert (point != 0.5).sum() == changed


@pytest.mark.slow
def test_a_trial_of_the_smallest_change_fails_as_it_was_found(asked, tmp_path):
    """The sum of three, over the root of three, is 5 m on a plane."""
    settings = '[ask.worst-case]\nruns = 60\nfirst = "distance"\n'
    campaign = asked("sum", "form.y < 5 m", SUM + settings)
    finding, folder = ask(campaign, "worst-case", tmp_path / "out", How("direct", jobs=2))
    smallest = finding.values["smallest"]
    # The boundary 20 u + 40 v + 20 w = 5 sqrt(3), in shares of the ranges from the middle.
    nearest = 5.0 * math.sqrt(3.0) / math.sqrt(20.0**2 + 40.0**2 + 20.0**2)
    assert nearest <= smallest["distance"] < 1.02 * nearest
    corner = 1.0 - 40.0 / math.sqrt(3.0) / 5.0  # of the ranges: 60 runs come near it
    assert corner < finding.values["worst"]["robustness"] < 0.75 * corner
    assert finding.values["nominal"]["robustness"] == pytest.approx(1.0)
    table = pd.read_parquet(folder / "results.parquet")
    assert len(table) == finding.runs
    trial = load_trial(str(folder / "worst-case.toml"))
    result = run_trial(trial, tmp_path / "again", engine="direct")
    assert not result.passed
    [(name, _, verdict)] = result.verdicts
    assert (name, verdict.robustness) == ("within", smallest["robustness"])


@pytest.mark.interop
def test_few_keys_change_by_default_from_what_the_trial_has(asked, tmp_path):
    nominal = '[ask.worst-case]\nruns = 40\nmethod = "bayesian"\nnominal = { "form.c" = 1 }\n'
    text = f'[set]\n"form.a" = "100 cm"\nseed = 5\n{SUM}seed = {{ integers = [1, 9] }}\n{nominal}'
    finding, folder = ask(
        asked("sum", "form.y < 5 m", text), "worst-case", tmp_path / "out", How("direct")
    )
    written = tomllib.loads((folder / "worst-case.toml").read_text("utf-8"))
    # Of all single keys b alone needs the least: 5 sqrt(3) - 1 - 1 of 40.
    assert finding.values["nominal"]["set"] == {
        "form.a": "0.0 m", "form.b": "0.0 kg", "form.c": 1.0, "seed": 1
    }  # fmt: skip
    assert len(finding.values["smallest"]["changed"]) == 1
    assert written["seed"] == finding.values["smallest"]["set"]["seed"]
    assert written["rig"] == "../form-rig.toml"


@pytest.mark.interop
def test_a_nominal_value_outside_its_range_is_said(asked, tmp_path):
    varied = SUM.replace('["-10 m", "10 m"]', '["1 m", "10 m"]')
    settings = "[ask.worst-case]\nruns = 20\n"
    finding, _ = ask(
        asked("sum", "form.y < 5 m", varied + settings),
        "worst-case",
        tmp_path / "out",
        How("direct"),
    )
    assert "the trial has form.a at 0 m, outside its range: nominal is 1" in finding.lines
    assert finding.values["nominal"]["set"]["form.a"] == "1.0 m"


@pytest.mark.interop
def test_what_never_fails_and_what_fails_already_is_said(asked, tmp_path):
    settings = "[ask.worst-case]\nruns = 20\n"
    for limit, said in (("50 m", "none fails"), ("-1 m", "nominal fails")):
        campaign = asked("sum", f"form.y < {limit}", SUM + settings)
        finding, folder = ask(campaign, "worst-case", tmp_path / limit[:2], How("direct"))
        assert any(said in line for line in finding.lines)
        assert not (folder / "worst-case.toml").exists()


@pytest.mark.parametrize(
    ("settings", "said"),
    [
        ('nominal = { "form.A" = 1 }', "nominal: unknown key 'form.A'"),
        ('nominal = { "form.a" = "1 kg" }', "nominal: form.a"),
        ('nominal = { "form.a" = "11 m" }', "from -10 to 10 is needed, found '11 m'"),
        ('nominal = { "form.a" = "far" }', "a number as in vary is needed, found 'far'"),
    ],
)
def test_bad_nominal_values_are_said(asked, tmp_path, settings, said):
    campaign = asked("sum", "form.y < 5 m", f"{SUM}[ask.worst-case]\n{settings}\n")
    with pytest.raises(InputError, match=said):
        ask(campaign, "worst-case", tmp_path / "out", How("direct"))
    assert not (tmp_path / "out").exists()
