"""Policies of tasks: they see and do what the agent saw and did in training."""

from __future__ import annotations

import sys
from pathlib import Path

import numpy as np
import pytest

import seatrial.gym
from seatrial.errors import InputError

from .policies import network, started

LINUX = pytest.mark.skipif(sys.platform != "linux", reason="loads libraries of Linux")


@LINUX
@pytest.mark.slow
@pytest.mark.parametrize("task", ["otter-station", "otter-path"])
def test_it_sees_and_does_what_the_agent_did(task: str, tmp_path: Path) -> None:
    env = seatrial.gym.make_vec(task, 1)
    sizes = (env.single_observation_space.shape[0], 8, 2)
    arrays = network(sizes, ["tanh", "identity"], 4)
    np.savez(tmp_path / "net.npz", **arrays)
    text = seatrial.gym.write_policy(
        task, tmp_path / "net.npz", tmp_path / "policy.toml"
    ).read_text()
    assert 'network = "net.npz"' in text
    policy = started(tmp_path / "policy.toml")
    signals = {
        line.partition(" = ")[0]: line.rpartition("# ")[2]
        for line in text.splitlines()
        if "  # " in line
    }
    seen, _ = env.reset(seed=3)
    random = np.random.default_rng(1)
    for _ in range(20):
        for name, port in type(policy).ports.items():
            if port.kind == "input":
                given = env.batch.get(signals[name])[0]
                policy.set(name, given.tolist())
        hidden = np.tanh(arrays["W0"] @ seen[0] + arrays["b0"])
        action = np.clip(arrays["W1"] @ hidden + arrays["b1"], -1.0, 1.0)
        pulses = 1.5e-3 + 0.4e-3 * action
        outputs = [name for name, port in type(policy).ports.items() if "pulse" in name]
        assert [policy.get(name) for name in outputs] == pytest.approx(pulses, abs=1e-9)
        seen, *_ = env.step(random.uniform(-1.0, 1.0, (1, 2)))
    env.close()


def test_nothing_is_overwritten(tmp_path: Path) -> None:
    (tmp_path / "policy.toml").write_text("mine", "utf-8")
    with pytest.raises(InputError, match=r"policy\.toml: is there already"):
        seatrial.gym.write_policy("otter-station", "net.npz", tmp_path / "policy.toml")


def test_signals_that_are_not_there(tmp_path: Path) -> None:
    task = """title = "t"\nrig = "vehicles/otter"\ndecision = "1 s"\nepisode = "1 s"
[[observe]]\nvalue = "gnss.positon_n.north"\nrange = [0, 1]
[[act]]\nto = "port_esc.pulse"\nrange = ["1 ms", "2 ms"]
[[reward]]\nname = "r"\nvalue = "1"\n"""
    (tmp_path / "task.toml").write_text(task, "utf-8")
    with pytest.raises(
        InputError, match=r"task\.toml: unknown signal 'gnss\.positon_n\.north'; did you mean"
    ):
        seatrial.gym.write_policy(tmp_path / "task.toml", "net.npz", tmp_path / "policy.toml")
