"""Tuning: known optima over what varies are found, fronts are those of closed forms, trials run."""

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
from seatrial_kits.search.asked_run import asked_run
from seatrial_kits.search.objectives import compromise, front
from seatrial_kits.search.searches import search_front, search_refined

TUNE = '[ask.tune]\ncandidates = 40\ncases = 4\n[ask.tune.keys]\n"form.a" = ["0.5 m", "8 m"]\n'
VARY = '[ask.vary]\n"form.b" = { uniform = ["29 kg", "31 kg"] }\n'


@pytest.mark.slow
def test_a_known_optimum_is_found_and_its_trial_runs(asked, tmp_path):
    # y is the distance from (2 m, 30 kg): whatever b is, a = 2 m is the best.
    campaign = asked("ellipse", "form.y < 3 m", TUNE + VARY)
    finding, folder = ask(campaign, "tune", tmp_path / "out", How("direct", jobs=1))
    [(_, present, tuned)] = finding.tables[0].rows
    assert present == 0.5  # the trial has 0 m, and that is the end of the range
    assert tuned == pytest.approx(2.0, abs=0.05)
    table = pd.read_parquet(folder / "results.parquet")
    assert len(table) == (40 + 2) * 4
    assert table["form.b"].nunique() == 8  # four of all candidates, and four fresh ones
    written = load_trial(str(folder / "tuned.toml"))
    assert (
        tomllib.loads((folder / "tuned.toml").read_text("utf-8"))["set"]["form.a"] == f"{tuned} m"
    )
    result = run_trial(written, tmp_path / "again", engine="direct")
    [(_, _, verdict)] = result.verdicts
    assert verdict.worst == pytest.approx(math.hypot(tuned - 2.0, 3.0), rel=1e-9)  # b is 0 kg
    assert asked_run(campaign, folder, 7).set["form.a"] == table["form.a"].map("{!r} m".format)[6]


@pytest.mark.parametrize("where", ["[set]", "[ask.set]"])
def test_present_values_are_those_of_the_campaign(asked, tmp_path, where):
    text = TUNE.replace("40", "10").replace("cases = 4", "cases = 1")
    campaign = asked("ellipse", "form.y < 3 m", f'{where}\n"form.a" = "300 cm"\n{text}')
    finding, folder = ask(campaign, "tune", tmp_path / "out", How("direct", jobs=1))
    assert finding.tables[0].rows[0][1] == 3.0
    assert pd.read_parquet(folder / "results.parquet")["form.a"][0] == 3.0
    written = tomllib.loads((folder / "tuned.toml").read_text("utf-8"))
    assert written["set"]["form.a"] == finding.values["tuned"]["form.a"] != "300 cm"


@pytest.mark.slow
def test_the_same_seed_tunes_to_the_same_bytes(asked, tmp_path):
    campaign = asked("ellipse", "form.y < 3 m", TUNE.replace("40", "12") + VARY)
    for jobs in (1, 2):
        ask(campaign, "tune", tmp_path / f"{jobs}", How("direct", jobs=jobs))
    for name in ("answer.json", "tuned.toml", "results.parquet", "tune.svg"):
        assert (tmp_path / "1" / name).read_bytes() == (tmp_path / "2" / name).read_bytes()


def test_cases_are_drawn_from_a_scatter_diagram(asked, tmp_path):
    design = (
        '[design]\nkind = "monte-carlo"\ncount = 9\n[design.scatter]\n'
        'rows = { key = "form.b", bins = ["29 kg", "30 kg", "31 kg"] }\n'
        'columns = { key = "form.c", bins = [0, 1, 2] }\noccurrences = [[1, 0], [0, 1]]\n'
    )
    campaign = asked("ellipse", "form.y < 3 m", TUNE.replace("40", "10") + design)
    _, folder = ask(campaign, "tune", tmp_path / "out", How("direct", jobs=1))
    table = pd.read_parquet(folder / "results.parquet")
    assert ((table["form.b"] > 30.0) == (table["form.c"] > 1.0)).all()
    assert 0 < (table["form.c"] > 1.0).sum() < len(table)
    assert asked_run(campaign, folder, 3).set["form.c"] == table["form.c"][2]


def test_several_objectives_have_a_front(asked, tmp_path):
    # y = (a + b) / sqrt(3): one objective wants a low, the other high: all candidates are on it.
    objectives = (
        '[[ask.tune.objectives]]\nminimise = "last form.y"\nover = "mean"\n'
        '[[ask.tune.objectives]]\nmaximise = "greatest form.y"\nover = "quantile 50 %"\n'
    )
    text = 'figures = ["form.y"]\n' + TUNE.replace("40", "12") + objectives
    finding, folder = ask(
        asked("sum", "form.y < 3 m", text), "tune", tmp_path / "out", How("direct")
    )
    [table] = [t for t in finding.tables if t.title == "Pareto front"]
    assert len(table.rows) == len({row[-1] for row in table.rows}) > 6
    for name, low, high, a in table.rows:
        assert float(low) == float(high) == pytest.approx(a / math.sqrt(3.0), rel=1e-3)
        assert (folder / name).is_file()
    middle = finding.tables[0].rows[0][2]
    values = [row[-1] for row in table.rows]
    assert min(values) < middle < max(values)


def test_the_front_of_schaffers_problem_is_approached():
    # Schaffer (1985): f = x^2 and (x - 2)^2 have the front x from 0 to 2, sqrt(f1) + sqrt(f2) = 2.
    def both(shares):
        x = 20.0 * shares[:, 0] - 10.0
        return np.stack([x**2, (x - 2.0) ** 2], axis=1)

    points, costs = search_front(both, np.array([0.9]), 80, seed=1)
    assert (costs == both(points)).all()
    best = costs[front(costs)]
    assert len(best) >= 8
    assert np.sqrt(best).sum(axis=1) == pytest.approx(2.0, abs=0.1)
    assert best[compromise(best)] == pytest.approx([1.0, 1.0], abs=0.6)


def test_few_runs_come_near_the_optimum_of_a_turned_bowl():
    turned = np.linalg.qr(np.random.default_rng(0).normal(size=(4, 4)))[0]

    def value(shares):
        return (((shares - 0.6) @ turned) ** 2 * [1.0, 10.0, 50.0, 100.0]).sum(axis=1)

    found = [search_refined(value, np.full(4, 0.1), 60, seed) for seed in range(3)]
    assert all(len(values) == 60 for _, values in found)
    assert np.median([values.min() for _, values in found]) < 0.3  # 40.25 at the start


@pytest.mark.parametrize("seed", range(3))
def test_a_front_has_all_rows_that_nothing_dominates(seed):
    costs = np.random.default_rng(seed).integers(0, 6, size=(30, 3)).astype(float)
    found = {tuple(costs[row]) for row in front(costs)}
    by_definition = {
        tuple(row)
        for row in costs
        if not any((other <= row).all() and (other < row).any() for other in costs)
    }
    assert found == by_definition
    assert len(front(costs)) == len(found)


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("[ask.tune]\n", "keys: at least one with its ends is needed"),
        (TUNE.replace('["0.5 m", "8 m"]', '["0.5 m"]'), "low and high are needed"),
        (TUNE.replace('["0.5 m", "8 m"]', '["8 m", "0.5 m"]'), "low below high is needed"),
        (TUNE + '[ask.vary]\n"form.a" = { uniform = ["1 m", "2 m"] }\n', "form.a varies too"),
        (TUNE + '[[ask.tune.objectives]]\nmaximise = "worst of withn"\n', "worst of within"),
        (
            TUNE + '[[ask.tune.objectives]]\nminimise = "worst of within"\nover = "median"\n',
            "over: 'worst', 'mean' or a quantile such as 'quantile 90 %' is needed, found 'median'",
        ),
    ],
)  # fmt: skip
def test_mistakes_are_errors_before_a_run(asked, tmp_path, text, said):
    with pytest.raises(InputError, match=said):
        ask(asked("sum", "form.y < 3 m", text), "tune", tmp_path / "out", How("direct"))
    assert not (tmp_path / "out").exists()


def test_an_objective_is_one_of_two(asked):
    with pytest.raises(InputError, match="either maximise"):
        asked("sum", "form.y < 3 m", TUNE + "[[ask.tune.objectives]]\n")
