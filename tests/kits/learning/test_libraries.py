"""Tasks in other people's loops: Stable-Baselines3 and TorchRL."""

from __future__ import annotations

import re
import subprocess
import sys
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import seatrial.gym

pytestmark = [
    pytest.mark.interop,
    pytest.mark.skipif(sys.platform != "linux", reason="loads libraries of Linux"),
]

PAGE = Path(__file__).parents[3] / "docs" / "how-to" / "learn.md"


def test_stable_baselines_has_the_episodes_of_the_vector_environment() -> None:
    pytest.importorskip("stable_baselines3", reason="Stable-Baselines3 brings PyTorch: 700 MB")
    env: Any = seatrial.gym.stable_baselines("otter-station", 3)
    ours = seatrial.gym.make_vec("otter-station", 3, autoreset_mode="same_step")
    env.seed(7)
    assert env.reset().tolist() == ours.reset(seed=7)[0].tolist()
    away = np.ones((3, 2), dtype=np.float32)
    for _ in range(300):
        seen, rewards, done, infos = env.step(away)
        wanted, wanted_rewards, terminated, truncated, _ = ours.step(away)
        assert seen.tolist() == wanted.tolist()
        assert rewards.tolist() == wanted_rewards.tolist()
        assert done.tolist() == (terminated | truncated).tolist()
        for copy in np.flatnonzero(done):
            assert infos[copy]["ended_by"] == "lost"
            assert infos[copy]["is_success"] is False
            assert infos[copy]["TimeLimit.truncated"] is False
            assert infos[copy]["terminal_observation"].shape == (7,)
    env.close()
    ours.close()


def test_torchrl_finds_nothing() -> None:
    wrapped = pytest.importorskip("torchrl.envs.libs.gym", reason="TorchRL brings PyTorch: 700 MB")
    utils = pytest.importorskip("torchrl.envs.utils")
    made = seatrial.gym.make_vec("otter-station", 4, autoreset_mode="same_step")
    env = wrapped.GymWrapper(made)
    utils.check_env_specs(env)
    made.close()


@pytest.mark.long
def test_ppo_of_the_page_keeps_the_otter_in_its_place(tmp_path: Path) -> None:
    """In 0.2 m/s of current within 1 m, in the minutes of the page, interrupted on the way."""
    pytest.importorskip("stable_baselines3", reason="Stable-Baselines3 brings PyTorch: 700 MB")
    match = re.search(r"`train.py`:\n\n```python\n(.*?)```", PAGE.read_text("utf-8"), re.S)
    assert match
    (tmp_path / "train.py").write_text(match[1], "utf-8")

    def train(steps: int) -> list[str]:
        command = [sys.executable, "train.py", str(steps)]
        run = subprocess.run(command, cwd=tmp_path, check=True, capture_output=True, text=True)
        return re.findall(r"at most ([0-9.]+) m off", run.stdout)

    first = train(300_000)
    assert float(first[-1]) > 1.0
    farthest = [float(each) for each in train(1_500_000)]
    assert len(farthest) == 18
    assert farthest[-1] < 1.0
