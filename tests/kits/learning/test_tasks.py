"""Tasks: Gymnasium's checker, episodes by seed, and the numbers of single runs."""

from __future__ import annotations

import sys
import warnings
from pathlib import Path
from typing import Any

import gymnasium
import numpy as np
import pytest
from gymnasium.utils.env_checker import check_env

import seatrial.gym
from seatrial import InputError, Simulation

pytestmark = [
    pytest.mark.slow,  # the compiler takes seconds
    pytest.mark.skipif(sys.platform != "linux", reason="loads libraries of Linux"),
]

CORK = Path(__file__).parents[1] / "batch" / "parts.py"
RIG = f"""
step = "10 ms"
[components]
cork  = {{ fmu = "{CORK}:Cork" }}
pilot = {{ fmu = "{CORK}:Pilot" }}
[connections]
"cork.x"      = "pilot.place"
"pilot.force" = "cork.push"
"""
TASK = """
rig = "cork.toml"
decision = "50 ms"
episode = "500 ms"
[set]
"cork.drag" = "0 N.s/m"
[vary]
"cork.mass" = { uniform = ["1 kg", "4 kg"] }
"cork.x_start" = { levels = ["10 cm", 0.2] }
[[observe]]
value = "cork.x"
range = ["-50 cm", 0.5]
[[observe]]
value = "cork.v * 1 s + cork.x"
range = ["-1 m", "3 m"]
[[act]]
to = "pilot.force"
range = ["-2 N", "4 N"]
[[reward]]
name = "near"
value = "-abs(cork.x) / 1 m"
weight = 2
[[reward]]
name = "slow"
margin = "abs(cork.v) < 2 m/s"
between = [-1, 0.5]
[[reward]]
name = "never beyond"
margin = "always cork.x < 40 cm"
weight = 10
[[ends]]
name = "there"
when = "once[50 ms, 100 ms] cork.x > 30 cm"
outcome = "success"
reward = 5
"""


@pytest.fixture(scope="module")
def task(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("task")
    (folder / "cork.toml").write_text(RIG, "utf-8")
    path = folder / "push.toml"
    path.write_text(TASK, "utf-8")
    return path


@pytest.mark.parametrize("name", seatrial.gym.tasks())
def test_the_checker_finds_nothing(name: str) -> None:
    env = gymnasium.make(f"seatrial/{name}-v0")
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        check_env(env.unwrapped)
    env.close()
    many = gymnasium.make_vec(f"seatrial/{name}-v0", 3, vectorization_mode="vector_entry_point")
    seen, _ = many.reset(seed=2)
    assert many.observation_space.contains(seen)
    seen, rewards, *_ = many.step(many.action_space.sample())
    assert many.observation_space.contains(seen)
    assert np.isfinite(rewards).all()
    many.close()


def test_observations_and_rewards_are_those_of_a_single_run(task: Path) -> None:
    env = seatrial.gym.make_vec(task, 3)
    seen, _ = env.reset(seed=[5, 6, 5])
    masses, starts = env.batch.get("cork.mass"), env.batch.get("cork.x")
    assert masses[0] == masses[2] != masses[1]
    assert {*starts.tolist()} <= {0.1, 0.2}
    actions = np.array([[0.5], [-1.0], [0.2]])
    courses: list[Any] = [[], [], []]
    sums = np.zeros(3)
    for _ in range(6):
        seen, rewards, terminated, truncated, _ = env.step(actions)
        sums += rewards
        for i in range(3):
            courses[i].append((seen[i].tolist(), bool(terminated[i])))
        if terminated.any() or truncated.any():
            break
    for i in range(3):
        given = {"cork.mass": masses[i], "cork.x_start": starts[i], "cork.drag": 0.0}
        with Simulation(task.with_name("cork.toml"), engine="native", set=given) as one:
            one.override("pilot.force", -2.0 + 6.0 * (actions[i, 0] + 1) / 2)
            total, xs = 0.0, [one.get("cork.x")]
            for seen_then, terminated_then in courses[i]:
                one.step(5)
                x, v = one.get("cork.x"), one.get("cork.v")
                xs.append(x)
                wanted = np.float32([x / 0.5, (v + x + 1.0) / 2.0 - 1.0])
                assert seen_then == pytest.approx(np.clip(wanted, -1, 1), abs=1e-6)
                met = any(before > 0.3 for before in xs[-3:-1])
                assert terminated_then == met
                total += -2.0 * abs(x) + np.clip(1.0 - abs(v) / 2.0, -1, 0.5) + 5.0 * met
                if met:
                    total += 10.0 * np.clip(1.0 - max(xs) / 0.4, -1, 1)
            assert sums[i] == pytest.approx(total, abs=1e-5)
    env.close()


def rolled(env: Any, steps: int, seed: int) -> list[Any]:
    """Return what an environment says when every copy acts alike."""
    said = [env.reset(seed=seed)[0].tolist()]
    for step in range(steps):
        seen, rewards, terminated, truncated, _ = env.step(
            np.full((env.num_envs, 1), np.sin(step), dtype=np.float32)
        )
        said += [seen.tolist(), rewards.tolist(), terminated.tolist(), truncated.tolist()]
    return said


def test_a_copy_follows_from_its_seed_alone(task: Path) -> None:
    env = seatrial.gym.make_vec(task, 4, threads=2)
    first = rolled(env, 25, 3)
    assert rolled(env, 25, 3) == first
    assert rolled(env, 25, 4) != first
    env.close()
    alone = seatrial.gym.make_vec(task, 1)
    of_third = [values[2:3] for values in first]
    assert rolled(alone, 25, 5) == of_third
    alone.close()


def test_each_autoreset_mode_does_as_gymnasium_says(task: Path) -> None:
    """Episodes of 10 decisions: the same numbers, where the modes have them."""
    still = np.full((2, 1), -1.0 / 3.0, dtype=np.float32)  # no force
    said = {}
    for mode in ("next_step", "same_step", "disabled"):
        env = seatrial.gym.make_vec(task, 2, autoreset_mode=mode)
        seen, _ = env.reset(seed=7)
        said[mode] = [seen]
        for _ in range(10):
            seen, _, terminated, truncated, infos = env.step(still)
        assert truncated.all()
        assert not terminated.any()
        of_end = infos["final_info"] if mode == "same_step" else infos
        assert of_end["ended_by"].tolist() == ["time", "time"]
        assert of_end["is_success"].tolist() == [False, False]
        if mode == "next_step":
            said[mode].append(seen)
            seen, rewards, terminated, truncated, _ = env.step(still)
            assert rewards.tolist() == [0.0, 0.0]
            assert not (terminated | truncated).any()
        elif mode == "same_step":
            said[mode].append(np.stack(infos["final_obs"].tolist()))
        else:
            said[mode].append(seen)
            with pytest.raises(InputError, match=r"copies \[0, 1\] have ended: reset them"):
                env.step(still)
            seen, _ = env.reset(options={"reset_mask": np.array([True, True])})
        said[mode].append(seen)
        assert env.batch.time.tolist() == [0.0, 0.0]
        env.close()
    for other in ("same_step", "disabled"):
        for a, b in zip(said["next_step"], said[other], strict=True):
            assert a.tolist() == b.tolist()


def test_a_copy_that_cannot_go_on_ends_its_episode_alone(task: Path) -> None:
    text = task.read_text("utf-8").replace('"pilot.force"', '"pilot.wanted"')
    text = text.replace('["-2 N", "4 N"]', '["-2 m", "4 m"]')
    path = task.with_name("far.toml")
    path.write_text(text.replace("[set]", '[set]\n"pilot.reach" = "3 m"'), "utf-8")
    env = seatrial.gym.make_vec(path, 2)
    env.reset(seed=1)
    seen, rewards, terminated, _, infos = env.step(np.array([[0.0], [1.0]]))
    assert terminated.tolist() == [False, True]
    assert "pilot: output force is inf" in infos["ended_by"][1]
    assert np.isfinite(seen).all()
    assert np.isfinite(rewards).all()
    _, _, terminated, _, _ = env.step(np.array([[0.0], [0.0]]))
    assert not terminated.any()
    env.close()


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        ('"50 ms"', '"55 ms"', r"push.*: episode: '500 ms' is not a whole number of decisions"),
        ('"50 ms"', '"5 ms"', r"decision: '5 ms' is not a whole number of communication steps"),
        ('value = "cork.x"', 'value = "cork.y"', r"unknown signal 'cork.y'"),
        ('value = "cork.x"', 'value = "cork.x <"', r"observe.0.value: column"),
        ('value = "cork.x"', 'value = "rms(cork.x)"', r"it needs a whole record"),
        ('["-50 cm", 0.5]', '["-50 kg", 0.5]', r"observe.0.range: .*kg"),
        ('["-50 cm", 0.5]', '["60 cm", 0.5]', r"observe.0.range: low below high"),
        ('"pilot.force"', '"pilot.force.x"', r"act.0.to: unknown signal 'pilot.force.x'"),
        ('"pilot.force"', '"cork.push"', r"act.0.to: cork.push cannot be set: it is fed by pilot"),
        (
            '"pilot.force"',
            '"cork.mass"',
            r"act.0.range: .*kg",
        ),
        ('"-abs(cork.x) / 1 m"', '"-abs(cork.x)"', r"reward.0 \(near\): .* this one is in 'm'"),
        ("[-1, 0.5]", "[0.5, -1]", r"reward.1 \(slow\): between: low below high"),
        ('margin = "abs(cork.v) < 2 m/s"', "", "Exactly one of value and margin"),
        ("cork.x > 30 cm", "cork.x > 30 kg", r"ends.0 \(there\): .*kg"),
        ("once[50 ms, 100 ms]", "eventually", r"ends.0 \(there\): .* looks ahead"),
        ("once[50 ms, 100 ms]", "once[0 s, 75 ms]", r"0.075 s is not a whole number of decisions"),
        ('["10 cm", 0.2]', '["fast", 0.2]', r"vary: cork.x_start: levels: quantities .* 'fast'"),
        ('"cork.x_start"', '"cork.x_strt"', r"x_strt"),
        ('["1 kg", "4 kg"]', '["1 m", "4 m"]', r"m"),
        ("decision", "decisions", r"decisions"),
        ('"cork.toml"', '"corc.toml"', r"corc.toml"),
    ],
)
def test_a_mistake_in_a_task_is_named(old: str, new: str, message: str, task: Path) -> None:
    path = task.with_name("push_mistaken.toml")
    assert old in TASK
    path.write_text(TASK.replace(old, new, 1), "utf-8")
    with pytest.raises(InputError, match=message):
        seatrial.gym.make_vec(path, 2).reset(seed=1)


def test_mistakes_of_a_caller_are_named(task: Path) -> None:
    with pytest.raises(InputError, match="unknown mode 'nextstep'"):
        seatrial.gym.make_vec(task, 2, autoreset_mode="nextstep")
    env = seatrial.gym.make_vec(task, 2)
    env.reset(seed=1)
    for wrong in (np.zeros((3, 1)), np.zeros(2), np.array([[np.nan], [0.0]])):
        with pytest.raises(InputError, match=r"finite numbers of shape \(2, 1\)"):
            env.step(wrong)
    with pytest.raises(InputError, match="2 are needed, found 3"):
        env.reset(seed=[1, 2, 3])
    with pytest.raises(InputError, match="2 truths are needed"):
        env.reset(options={"reset_mask": np.array([1, 0])})
    env.close()
    with pytest.raises(InputError, match="closed"):
        env.reset()
