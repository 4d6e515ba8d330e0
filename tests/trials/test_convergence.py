"""Step halving on coupled bodies whose motion is known, and what it leaves on disk."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest
from scipy.linalg import expm

from seatrial.errors import InputError, SimulationError
from seatrial.trial.files.trial import Trial, load_trial
from seatrial.trial.records.run_folder import load_run
from seatrial.trial.reports.report import write_report
from seatrial.trial.running.convergence import Convergence, load_convergence, run_convergence
from seatrial.trial.running.run import Hooks

from ..cosim.bodies import TEXT as BODIES
from .conftest import figures_of

RIG = """
step = "{step}"
algorithm = "{algorithm}"
[components]
hull      = {{ fmu = "bodies.py:Body", set = {{ max_step = "1 ms" }} }}
appendage = {{ fmu = "bodies.py:Appendage", set = {{ max_step = "1 ms" }} }}
{more}
[connections]
"hull.x" = "appendage.x_hull"
"hull.v" = "appendage.v_hull"
"appendage.force" = "hull.force"
"""
TRIAL = 'rig = "rig.toml"\nstop = "2 s"\n'
EXTRAS = '''
"""A clock of steps, noise, and a switch."""
from seatrial.model.component import Component, Noise, Output
from seatrial.model.sampled import Sampled


class Extras(Component):
    """Counts its steps; reports when it has taken ten; forgets nothing."""

    count = Output("1", "steps taken", type=int)
    late = Output("1", "after ten steps", type=bool)
    label = Output("1", "as text", type=str)
    same = Output("1", "always three", type=int)
    wrong = Output("m", "depends on the step in no orderly way")

    def start(self, t):
        self.taken = 0

    def step(self, t, h):
        self.taken += 1

    def outputs(self, t):
        self.count, self.late, self.same = self.taken, self.taken >= 10, 3
        self.label = f"{self.taken} steps"
        self.wrong = (self.taken * 0.618) % 1.0


class Gauge(Noise, Sampled):
    """White noise at its own instants."""

    y = Output("m", "noise")

    def sample(self, t, k):
        self.y = self.generator(k).standard_normal()
'''
GAUGE = 'gauge = { fmu = "extras.py:Gauge" }'


@pytest.fixture
def bench(write):
    def bench(
        algorithm: str = "jacobi", step: str = "10 ms", more: str = "", trial: str = TRIAL
    ) -> Trial:
        write("bodies.py", BODIES)
        write("extras.py", EXTRAS)
        write("rig.toml", RIG.format(algorithm=algorithm, step=step, more=more))
        return load_trial(str(write("trial.toml", trial)))

    return bench


def halve(trial: Trial, out: Path, halvings: int = 2) -> Convergence:
    return run_convergence(trial, out, halvings=halvings, engine="direct")[1]


def true_motion(times: np.ndarray) -> np.ndarray:
    """Position and velocity of the hull, then of the appendage, by the matrix exponential."""
    M, m, k, c, d = 100.0, 8.0, 400.0, 12.0, 30.0
    matrix = np.array(
        [
            [0, 1, 0, 0],
            [-k / M, -(c + d) / M, k / M, c / M],
            [0, 0, 0, 1],
            [k / m, c / m, -k / m, -c / m],
        ]
    )
    return np.array([expm(matrix * t) @ [1.0, 0.0, 0.0, 0.0] for t in times])


@pytest.mark.parametrize(
    ("algorithm", "order", "halvings"),
    [
        ("jacobi", 1, 2),
        ("jacobi", 1, 3),
        ("extrapolated", 2, 2),
        pytest.param("plain-jacobi", 1, 3, marks=pytest.mark.interop),
        pytest.param("gauss-seidel", 1, 3, marks=pytest.mark.interop),
        pytest.param("extrapolated", 2, 3, marks=pytest.mark.interop),
        pytest.param("iterated", 2, 3, marks=pytest.mark.interop),
    ],
)
def test_order_and_error_are_those_of_the_exact_solution(
    algorithm: str, order: int, halvings: int, bench, tmp_path: Path
) -> None:
    found = halve(bench(algorithm), tmp_path / "run", halvings)
    assert found.converges
    run = load_run(tmp_path / "run")
    names = ("hull.x", "hull.v", "appendage.y", "appendage.w")
    truth = dict(zip(names, true_motion(run.time).T, strict=True))
    for output in found.outputs:
        assert output.orders == pytest.approx([order] * (halvings - 1), abs=0.1)
        if output.signal in truth:
            for folder, estimated in zip(found.folders, output.errors, strict=True):
                values = load_run(tmp_path / "run" / folder).signals[output.signal]
                error = np.max(np.abs(values - truth[output.signal]))
                assert estimated == pytest.approx(error, rel=0.1)


def test_what_is_left_is_a_run_folder_with_the_others_below(bench, tmp_path: Path) -> None:
    found = halve(bench(trial=TRIAL + '[record]\nevery = "300 ms"\n'), tmp_path / "run")
    assert (found.steps, found.folders) == ([0.01, 0.005, 0.0025], [".", "step-5ms", "step-2.5ms"])
    instants = [0.0, 0.3, 0.6, 0.9, 1.2, 1.5, 1.8, 2.0]
    for folder, step in zip(found.folders, found.steps, strict=True):
        run = load_run(tmp_path / "run" / folder)
        assert (run.time.tolist(), run.manifest["step"]) == (instants, step)
    assert load_convergence(tmp_path / "run") == found
    assert load_convergence(tmp_path / "run" / "step-5ms") is None


def test_components_with_a_longer_step_halve_it_too(bench, tmp_path: Path) -> None:
    slow = 'extra = { fmu = "extras.py:Extras", step = "40 ms" }'
    halve(bench(more=slow), tmp_path / "run")
    for folder, step in ((".", 0.04), ("step-5ms", 0.02), ("step-2.5ms", 0.01)):
        manifest = load_run(tmp_path / "run" / folder).manifest
        assert manifest["components"]["extra"]["step"] == step


def test_noise_is_the_same_at_every_step(bench, tmp_path: Path) -> None:
    found = halve(bench(more=GAUGE), tmp_path / "run")
    noise = next(output for output in found.outputs if output.signal == "gauge.y")
    assert (noise.behaviour, noise.differences) == ("exact", [0.0, 0.0])
    assert noise.range > 1.0


def test_what_does_not_converge_and_what_differs_is_listed(bench, tmp_path: Path) -> None:
    found = halve(bench(more='extra = { fmu = "extras.py:Extras" }'), tmp_path / "run")
    assert not found.converges
    assert found.outputs[0].signal == "extra.wrong"
    assert {one.signal: one.differs_at for one in found.discrete} == {
        "extra.count": [0.01, 0.01],
        "extra.late": [0.05, 0.03],
        "extra.label": [0.01, 0.01],
    }


def test_events_keep_their_instants(bench, tmp_path: Path) -> None:
    push = '[[faults]]\nat = "1 s"\nwhat = "fixed"\nwhere = "appendage.force"\nvalue = "100 N"\n'
    found = halve(bench(trial=TRIAL + push), tmp_path / "run")
    force = next(output for output in found.outputs if output.signal == "appendage.force")
    assert force.behaviour == "converges"
    for folder in found.folders:
        run = load_run(tmp_path / "run" / folder)
        assert (run.signals["appendage.force"] == 100.0).tolist() == (run.time >= 1.0).tolist()


def test_the_report_has_the_errors_and_can_be_made_again(bench, tmp_path: Path) -> None:
    found = halve(bench(more='extra = { fmu = "extras.py:Extras" }'), tmp_path / "run")
    page = write_report(tmp_path / "run").read_text("utf-8")
    assert "Accuracy of the coupling" in page
    worst = next(output for output in found.outputs if output.behaviour == "converges")
    assert f"<code>{worst.signal}</code>" in page
    for shown in ("1 outputs do not converge", "does not converge", "extra.label"):
        assert shown in page
    assert "slope 2" in json.dumps(figures_of(page))
    assert write_report(tmp_path / "run").read_text("utf-8") == page
    assert "Accuracy of the coupling" not in write_report(tmp_path / "run/step-5ms").read_text()


def test_real_time_is_not_kept(bench, tmp_path: Path) -> None:
    found = halve(bench(trial=TRIAL + "real_time = { factor = 1e-6 }\n"), tmp_path / "run")
    assert found.converges
    assert "pacing" not in json.loads((tmp_path / "run" / "timing.json").read_text())


@pytest.mark.parametrize(
    ("halvings", "step", "message"),
    [
        (1, "8 ns", "--halvings: at least 2 are needed"),
        (3, "4 ns", "step: 4 ns is not a whole number of nanoseconds times 8"),
    ],
)
def test_mistakes_leave_nothing(halvings, step, message, bench, tmp_path: Path) -> None:
    trial = bench(step=step, trial=TRIAL.replace("2 s", "4 us"))
    with pytest.raises(InputError, match=message):
        halve(trial, tmp_path / "run", halvings)
    assert not (tmp_path / "run").exists()


def test_a_run_that_is_stopped_ends_it(bench, tmp_path: Path) -> None:
    shown: list[float] = []
    hooks = Hooks(
        progress=lambda passed, whole: shown.append(passed / whole),
        stop_requested=lambda: shown.count(1.0),  # the first run is over
    )
    with pytest.raises(SimulationError, match=r"stopped"):
        run_convergence(bench(), tmp_path / "run", engine="direct", hooks=hooks)
    assert load_run(tmp_path / "run").manifest["status"] == "complete"
    assert load_convergence(tmp_path / "run") is None


def test_a_file_of_another_shape_is_refused(bench, tmp_path: Path) -> None:
    halve(bench(), tmp_path / "run")
    (tmp_path / "run" / "convergence.json").write_text('{"outputs": [{"name": "x"}]}')
    with pytest.raises(InputError, match=r"convergence.json: trial: this key is missing"):
        load_convergence(tmp_path / "run")


def test_ecco_is_not_halved(tmp_path: Path) -> None:
    (tmp_path / "rig.toml").write_text('step = "1 s"\nalgorithm = "ecco"\n[components]\n', "utf-8")
    (tmp_path / "t.toml").write_text('rig = "rig.toml"\nstop = "1 s"\n', "utf-8")
    trial = load_trial(str(tmp_path / "t.toml"))
    with pytest.raises(InputError, match=r"rig\.toml: ecco chooses its steps"):
        run_convergence(trial, tmp_path / "out")
