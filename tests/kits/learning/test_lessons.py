"""Lessons against runs with a hidden term that is known, and against another tool's networks."""

from __future__ import annotations

import io
import lzma
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from scipy.optimize import approx_fprime

from seatrial.errors import InputError
from seatrial.trial.records.run_folder import Run
from seatrial_kits.learning import command
from seatrial_kits.learning.fit import _cost, answers, fitted
from seatrial_kits.learning.lesson import Lesson
from tests.command import seatrial

from .policies import started

HERE = Path(__file__).parents[2] / "reference" / "drone"
TAUGHT, HELD_OUT = (1, 2, 3, 5, 6, 7), (4, 8)
POLICY = """network = "lacking.npz"
[inputs]
velocity = { unit = "m/s", axes = ["north", "east", "down"], frame = "n" }
height = "m"
thrust = "N"
[outputs]
acceleration = { unit = "m/s2", axes = ["north", "east", "down"], frame = "n" }
"""
LESSON = """policy = "lacking.toml"
every = "100 ms"
[inputs]
velocity = { north = "log.v_north", east = "log.v_east", down = "log.v_down" }
height = "log.height"
thrust = "log.thrust"
[outputs.acceleration]
north = "log.a_north + log.thrust / 10 kg * sin(log.theta) * cos(log.phi)"
east = "log.a_east - log.thrust / 10 kg * sin(log.phi)"
down = "log.a_down - 9.81 m/s2 + log.thrust / 10 kg * cos(log.theta) * cos(log.phi)"
"""
COLUMNS = {
    "v_north": "m/s",
    "v_east": "m/s",
    "v_down": "m/s",
    "height": "m",
    "thrust": "N",
    "phi": "rad",
    "theta": "rad",
    "a_north": "m/s2",
    "a_east": "m/s2",
    "a_down": "m/s2",
}
MASS, HOVER, K_T = 10.0, 555.644, 7.94358e-5
"""kg, rad/s, N s2: those of the runs' drone."""


@cache
def flight(number: int) -> Any:
    """Return the rows of a run: t, v (3), height, thrust, phi, theta, acceleration (3)."""
    text = lzma.decompress((HERE / f"residual-train-{number}.csv.xz").read_bytes())
    return np.genfromtxt(io.BytesIO(text), delimiter=",", skip_header=1)


def run(rows: Any, name: str = "log") -> Run:
    columns = zip(COLUMNS, rows.T[1:], strict=True)
    signals = {f"log.{column}": values for column, values in columns}
    units = {f"log.{column}": measure for column, measure in COLUMNS.items()}
    return Run(Path(name), rows[:, 0], signals, units, {}, [], {}, False, ())


def turned(phi: Any, theta: Any) -> Any:
    """Return R from body axes to {n} without yaw, (rows, 3, 3)."""
    c, s, n = np.cos, np.sin, np.zeros_like(phi)
    rows = (
        (c(theta), s(theta) * s(phi), s(theta) * c(phi)),
        (n, c(phi), -s(phi)),
        (-s(theta), c(theta) * s(phi), c(theta) * c(phi)),
    )
    return np.moveaxis(np.array(rows), 2, 0)


def hidden(v: Any, height: Any, thrust: Any, phi: Any, theta: Any) -> Any:
    """Return the acceleration that the runs hide from thrust and gravity, m/s2, {n}.

    Drag -1/2 rho CdA |v| v, and c_r (O / O_hover) v in the plane of the rotors, in body axes;
    thrust 0.6 exp(-4 (h + 0.30 m) / 0.4 m) more near the deck.
    """
    own = turned(phi, theta)
    air = np.einsum("nji,nj->ni", own, v)
    speed = np.linalg.norm(air, axis=1)[:, None]
    force = -0.5 * 1.225 * np.array([0.12, 0.12, 0.25]) * speed * air
    share = np.sqrt(thrust / 4 / K_T) / HOVER
    force[:, :2] -= 0.30 * share[:, None] * air[:, :2]
    force[:, 2] -= thrust * 0.6 * np.exp(-4 * (height + 0.30) / 0.4)
    return np.einsum("nij,nj->ni", own, force) / MASS


def hidden_of(rows: Any) -> Any:
    return hidden(rows[:, 1:4], *rows[:, 4:8].T)


def nominal(thrust: Any, phi: Any, theta: Any) -> Any:
    return np.array([0.0, 0.0, 9.81]) - thrust[:, None] / MASS * turned(phi, theta)[:, :, 2]


def rms(values: Any) -> float:
    return float(np.sqrt(np.mean(np.square(values))))


def written(folder: Path, lesson: str = LESSON, policy: str = POLICY) -> Path:
    (folder / "lacking.toml").write_text(policy, "utf-8")
    (folder / "lesson.toml").write_text(lesson, "utf-8")
    return folder / "lesson.toml"


@pytest.fixture(scope="module")
def learned(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Return the folder of a policy that learned six runs."""
    folder = tmp_path_factory.mktemp("lesson")
    lesson = Lesson(written(folder))
    arrays = lesson.learned([lesson.rows(run(flight(number))) for number in TAUGHT])
    np.savez(folder / "lacking.npz", **arrays)
    return folder


def network_of(folder: Path) -> dict[str, Any]:
    with np.load(folder / "lacking.npz") as file:
        return {name: file[name] for name in file.files}


@pytest.mark.parametrize("number", HELD_OUT)
def test_the_runs_hide_what_is_known(number: int) -> None:
    rows = flight(number)
    error = rows[:, 8:] - nominal(*rows[:, 5:8].T) - hidden_of(rows)
    assert rms(error) == pytest.approx(0.05, rel=0.03)  # the noise of their accelerations


@pytest.mark.parametrize("number", HELD_OUT)
def test_a_fifth_is_left_at_most_of_runs_that_it_did_not_learn(number: int, learned: Path) -> None:
    rows = flight(number)
    found = answers(network_of(learned), rows[:, 1:6])
    assert rms(found - hidden_of(rows)) < 0.2 * rms(hidden_of(rows))


@pytest.mark.parametrize("number", HELD_OUT)
def test_its_velocity_after_2_s_errs_by_a_fifth_at_most(number: int, learned: Path) -> None:
    arrays, rows, step = network_of(learned), flight(number), 0.02
    begins = np.arange(0, len(rows) - 101, 50)

    def errors(helped: bool) -> float:
        """Return the RMS error of velocity, m/s, of windows of 2 s, orders held, by Heun."""
        v, height = rows[begins, 1:4], rows[begins, 4]
        for k in range(100):
            held = rows[begins + k, 5:8]

            def slope(v: Any, height: Any, held: Any = held) -> Any:
                lacking = answers(arrays, np.column_stack([v, height, held[:, 0]]))
                return nominal(*held.T) + helped * lacking

            first = slope(v, height)
            second = slope(v + step * first, height - step * v[:, 2])
            height = height - step * (v[:, 2] + step * (first + second)[:, 2] / 4)
            v = v + step * (first + second) / 2
        return rms(v - rows[begins + 100, 1:4])

    assert errors(helped=True) < 0.2 * errors(helped=False)


def test_the_component_gives_what_scikit_learn_gives_of_its_weights(learned: Path) -> None:
    learners = pytest.importorskip("sklearn.neural_network")
    arrays = network_of(learned)
    x, y = np.zeros((2, 5)), np.zeros((2, 3))
    theirs = learners.MLPRegressor(hidden_layer_sizes=(12,), activation="tanh").partial_fit(x, y)
    theirs.coefs_ = [arrays["W0"].T, arrays["W1"].T]
    theirs.intercepts_ = [arrays["b0"], arrays["b1"]]
    policy = started(learned / "lacking.toml")
    rows = flight(4)[::100, 1:6]
    scaled = theirs.predict((rows - arrays["input_mean"]) / arrays["input_scale"])
    wanted = scaled * arrays["output_scale"] + arrays["output_mean"]
    inside = (arrays["output_low"] < wanted) & (wanted < arrays["output_high"])
    assert inside.all()
    for row, each in zip(rows, wanted, strict=True):
        policy.set("velocity", list(row[:3]))
        policy.set("height", row[3])
        policy.set("thrust", row[4])
        policy.outputs(0.0)
        assert policy.get("acceleration") == pytest.approx(each, abs=1e-9)
        assert policy.get("inside")


def test_beyond_its_lesson_it_says_so_and_stays_within_what_it_learned(learned: Path) -> None:
    arrays, policy = network_of(learned), started(learned / "lacking.toml")
    policy.set("velocity", [40.0, -40.0, 10.0])
    policy.set("height", -0.2)
    policy.set("thrust", 300.0)
    policy.outputs(0.0)
    assert not policy.get("inside")
    assert policy.get("outside") == 5
    found = np.array(policy.get("acceleration"))
    assert np.all(found >= arrays["output_low"] - 1e-12)
    assert np.all(found <= arrays["output_high"] + 1e-12)
    assert np.any(
        np.isclose(found, arrays["output_low"]) | np.isclose(found, arrays["output_high"])
    )


def test_the_gradient_is_that_of_differences() -> None:
    random = np.random.default_rng(2)
    shapes = [(4, 2), (3, 4), (2, 3)]
    w = random.normal(size=sum(a * b + a for a, b in shapes))
    given = (random.normal(size=(6, 2)), random.normal(size=(6, 2)), shapes, 0.3)
    numeric = approx_fprime(w, lambda w: _cost(w, *given)[0], 1e-7)
    assert _cost(w, *given)[1] == pytest.approx(numeric, abs=1e-5)


def test_a_lesson_of_a_constant_is_that_constant() -> None:
    x = np.linspace(-1.0, 1.0, 20)[:, None]
    y = np.column_stack([np.full(20, 3.5), 2.0 * x[:, 0] + 1.0])
    arrays = fitted(x, y, [4], decay=1e-6, iterations=400, seed=0)
    assert answers(arrays, x)[:, 0] == pytest.approx(3.5, abs=1e-12)
    assert answers(arrays, x)[:, 1] == pytest.approx(y[:, 1], abs=0.02)


def test_the_same_lesson_has_the_same_bytes() -> None:
    x = np.linspace(-1.0, 1.0, 50)[:, None]
    twice = [fitted(x, np.sin(3 * x), [5], decay=0.1, iterations=50, seed=3) for _ in range(2)]
    assert all(np.array_equal(twice[0][name], twice[1][name]) for name in twice[0])


def test_rows_are_means_of_whole_times_in_the_air(tmp_path: Path) -> None:
    rows = np.zeros((40, 11))
    rows[:, 0] = 0.02 * np.arange(40)
    rows[:, 4] = np.arange(40)
    text = LESSON.replace("[inputs]", 'where = ["log.height < 33 m"]\n[inputs]', 1)
    found = Lesson(written(tmp_path, text)).rows(run(rows))
    # Rows below 33 m are six whole means, and three rows more that give the range alone.
    assert found.taken[:, 3] == pytest.approx([2.0, 7.0, 12.0, 17.0, 22.0, 27.0])
    assert (found.low[3], found.high[3]) == (0.0, 32.0)
    assert found.given[:, 2] == pytest.approx(-9.81)


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        ('"lacking.toml"', '"none.toml"', r"none\.toml"),
        ('height = "log.height"', "", r"inputs: 'height' of lacking\.toml is not there"),
        ('height = "log.height"', 'hight = "log.height"', r"unknown element 'hight'.*'height'"),
        ('"log.height"', '"log.thrust"', r"inputs\.height: log\.thrust is in N, m is needed"),
        ('"log.height"', '"log.hight"', r"unknown signal 'log\.hight'.*'log\.height'"),
        ('"log.height"', '"log.height <"', r"inputs\.height"),
        ('every = "100 ms"', 'every = "100 m"', r"every: .*'m'"),
        ('every = "100 ms"', 'where = ["log.height"]', r"where\.0: .*a comparison is needed"),
        ('every = "100 ms"', 'where = ["log.height < 1 N"]', r"where\.0: "),
        ('every = "100 ms"', 'where = ["log.height > 1 km"]', r"no row is left"),
        ('every = "100 ms"', "hidden = [0]", r"hidden: layers of 1 to"),
        ('every = "100 ms"', "decay = -1.0", r"decay: .*greater than or equal to 0"),
        ('every = "100 ms"', 'evry = "1 s"', r"unknown key 'evry'; did you mean 'every'"),
        ('"log.height"', '"log.height / (0 * log.height) * 0 m"', r"not finite"),
    ],
)
def test_lessons_with_mistakes(old: str, new: str, message: str, tmp_path: Path) -> None:
    assert old in LESSON
    with pytest.raises(InputError, match=message):
        Lesson(written(tmp_path, LESSON.replace(old, new))).rows(run(flight(4)[:100]))


def test_a_policy_that_is_to_learn_has_no_ranges(tmp_path: Path) -> None:
    policy = POLICY + '[[act]]\nto = "acceleration.north"\nrange = [-1, 1]\n'
    with pytest.raises(InputError, match=r"lacking\.toml: act\.0\.range: ranges follow from"):
        Lesson(written(tmp_path, policy=policy))


def test_the_command_says_what_is_left(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    rows = {"a": flight(1), "b": flight(2), "c": flight(3)}
    noise = flight(3)[:500].copy()
    noise[:, 8:] = np.random.default_rng(0).normal(scale=5.0, size=(500, 3))
    rows["noise"] = noise
    monkeypatch.setattr(command, "load_run", lambda folder: run(rows[folder.name], folder.name))
    written(tmp_path)
    done = seatrial("learn", "lesson.toml", "a", "c", "--check", "b", cwd=tmp_path)
    assert done.returncode == 0, done.stdout
    assert "b (check)" in done.stdout
    assert (tmp_path / "lacking.npz").is_file()
    assert started(tmp_path / "lacking.toml").get("outside") is not None
    again = seatrial("learn", "lesson.toml", "a", cwd=tmp_path)
    assert again.returncode == 2
    assert "exists already" in again.stderr
    worse = seatrial("learn", "lesson.toml", "a", "--check", "noise", "-o", "n.npz", cwd=tmp_path)
    assert worse.returncode == 1
    other = seatrial("learn", "lesson.toml", "a", "-o", "n.onnx", cwd=tmp_path)
    assert other.returncode == 2
    assert "written as .npz" in other.stderr
