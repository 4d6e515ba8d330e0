"""Sensitivity: indices in closed form of Ishigami's function, and of a sum."""

import math

import numpy as np
import pandas as pd
import pytest

from seatrial.errors import InputError
from seatrial_kits.campaigns.sweep import How
from seatrial_kits.search.ask import ask
from seatrial_kits.search.indices import morris, sobol

A, B = 7.0, 0.1
VARIANCE = A**2 / 8.0 + B * math.pi**4 / 5.0 + B**2 * math.pi**8 / 18.0 + 0.5
FIRST = np.array([0.5 * (1.0 + B * math.pi**4 / 5.0) ** 2, A**2 / 8.0, 0.0]) / VARIANCE
TOTAL = FIRST + np.array([1.0, 0.0, 1.0]) * (8.0 * B**2 * math.pi**8 / 225.0) / VARIANCE
"""Ishigami and Homma (1990): 0.314, 0.442, 0 and 0.558, 0.442, 0.244."""
ANGLES = '[ask.vary]\n"form.a" = { uniform = ["-3.141592653589793 m", "3.141592653589793 m"] }\n"form.b" = { uniform = ["-3.141592653589793 kg", "3.141592653589793 kg"] }\n"form.c" = { uniform = [-3.141592653589793, 3.141592653589793] }\n'


def ishigami(points):
    a, b, c = (2.0 * math.pi * points - math.pi).T
    return (np.sin(a) + A * np.sin(b) ** 2 + B * c**4 * np.sin(a))[:, None]


def test_the_closed_form_is_that_of_the_books():
    assert pytest.approx([0.3139, 0.4424, 0.0], abs=5e-5) == FIRST
    assert pytest.approx([0.5576, 0.4424, 0.2437], abs=5e-5) == TOTAL


def test_sobol_indices_of_ishigami_s_function():
    [found] = sobol(ishigami, 3, 2048, seed=0)
    assert found.first == pytest.approx(FIRST, abs=0.02)
    assert found.total == pytest.approx(TOTAL, abs=0.02)
    assert (found.first_half < 0.1).all()
    again, other = sobol(ishigami, 3, 2048, seed=0)[0], sobol(ishigami, 3, 2048, seed=1)[0]
    assert (again.first == found.first).all()
    assert (again.first_half == found.first_half).all()
    assert (other.first != found.first).any()


@pytest.mark.interop
def test_intervals_have_the_true_indices_as_often_as_they_say():
    inside = []
    for seed in range(40):
        [found] = sobol(ishigami, 3, 256, seed)
        inside += list(np.abs(found.first - FIRST) < found.first_half)
        inside += list(np.abs(found.total - TOTAL) < found.total_half)
    assert np.mean(inside) > 0.9


def test_morris_effects_of_what_is_linear_and_what_is_not():
    def value(points):
        x, y, z = points.T
        return np.stack([3.0 * x - 2.0 * y, x * z], axis=1)

    linear, product = morris(value, 3, 50, seed=0)
    assert linear.mu_star == pytest.approx([3.0, 2.0, 0.0], abs=1e-9)
    assert linear.sigma == pytest.approx([0.0, 0.0, 0.0], abs=1e-9)
    assert product.mu_star[[0, 2]] == pytest.approx([0.5, 0.5], abs=0.15)  # the mean of the other
    assert product.mu_star[1] == pytest.approx(0.0, abs=1e-9)
    assert (product.sigma[[0, 2]] > 0.2).all()


def test_an_output_that_does_not_vary_has_no_indices():
    [found] = sobol(lambda points: np.ones((len(points), 1)), 2, 8, seed=0)
    assert np.isnan(found.total).all()


@pytest.mark.slow
def test_a_trial_s_indices_are_those_of_its_closed_form(asked, tmp_path):
    """Of a sum of normal keys each has its share of the variance: 1, 4 and 1 of 6."""
    varied = '[ask.vary]\n"form.a" = { normal = ["3 m", "1 m"] }\n"form.b" = { normal = ["1 kg", "2 kg"] }\n"form.c" = { normal = [0, 1] }\n'
    text = f'figures = ["form.y"]\n{varied}[ask.sensitivity]\nsamples = 32\ntrajectories = 4\n'
    finding, folder = ask(
        asked("sum", "form.y < 5 m", text), "sensitivity", tmp_path / "out", How("direct")
    )
    assert finding.runs == 32 * 5 + 4 * 4
    names = ["within", "least form.y", "greatest form.y", "last form.y"]
    assert [shown.title for shown in finding.tables] == names
    table = pd.read_parquet(folder / "indices.parquet")
    table = table[table["of"] == "last form.y"].set_index("key")
    assert table["total"].to_numpy() == pytest.approx([1 / 6, 4 / 6, 1 / 6], abs=0.1)
    ranges = np.array([6.0, 12.0, 6.0])  # three standard deviations each way
    assert table["mu*"].to_numpy() == pytest.approx(ranges / math.sqrt(3.0), rel=1e-4)
    assert table["sigma"].to_numpy() == pytest.approx(0.0, abs=1e-9)
    assert (folder / "sensitivity.svg").is_file()


@pytest.mark.long
@pytest.mark.interop
def test_ishigami_s_function_through_a_trial(asked, tmp_path):
    text = f'figures = ["form.y"]\n{ANGLES}[ask.sensitivity]\nof = ["last form.y"]\nsamples = 256\ntrajectories = 0\n'
    campaign = asked("ishigami", "form.y < 50 m", text)
    for jobs in (1, 2):
        finding, _ = ask(campaign, "sensitivity", tmp_path / f"j{jobs}", How("direct", jobs))
    for name in ("results.parquet", "indices.parquet", "answer.json", "sensitivity.png"):
        assert (tmp_path / "j1" / name).read_bytes() == (tmp_path / "j2" / name).read_bytes()
    found = list(finding.values["last form.y"].values())
    for part, expected in (("first", FIRST), ("total", TOTAL)):
        for each, true in zip(found, expected, strict=True):
            assert each[part] == pytest.approx(true, abs=0.1)
            assert abs(each[part] - true) < 2.0 * each[f"± {part}"]


CORRELATED = '[design]\nkind = "sobol"\ncount = 8\n[design.vary]\n"form.a" = { normal = ["0 m", "1 m"] }\n"form.b" = { normal = ["0 kg", "1 kg"] }\n[[design.correlation]]\nbetween = ["form.a", "form.b"]\ncoefficient = 0.5\n'


@pytest.mark.parametrize(
    ("text", "said"),
    [
        (CORRELATED, "keys are correlated"),
        (f"{ANGLES}[ask.sensitivity]\nsamples = 100\n", "power of 2 is needed, found 100"),
        (f'{ANGLES}[ask.sensitivity]\nof = ["withn"]\n', "criterion or figure 'withn'; did you"),
        (f"{ANGLES}[ask.sensitivity]\nsamples = 0\ntrajectories = 0\n", "nothing to do"),
    ],
)
def test_what_is_wrong_is_said(asked, tmp_path, text, said):
    campaign = asked("sum", "form.y < 5 m", text)
    with pytest.raises(InputError, match=said):
        ask(campaign, "sensitivity", tmp_path / "out", How("direct"))
    assert not (tmp_path / "out").exists()
