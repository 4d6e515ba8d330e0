"""The page's Gymnasium environment, by Gymnasium's own checker."""

from __future__ import annotations

import importlib.util
import re
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from gymnasium.utils.env_checker import check_env

PAGE = Path(__file__).parents[2] / "docs" / "python.md"


@pytest.fixture
def environment(tmp_path: Path):
    match = re.search(r"`hold_station.py`:\n\n```python\n(.*?)```", PAGE.read_text("utf-8"), re.S)
    assert match
    path = tmp_path / "hold_station.py"
    path.write_text(match[1], "utf-8")
    spec = importlib.util.spec_from_file_location("hold_station", path)
    assert spec
    assert spec.loader
    module: Any = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    env = module.HoldStation()
    yield env
    env.close()


@pytest.mark.slow
@pytest.mark.filterwarnings("ignore::UserWarning")  # unbounded observations are meant
def test_the_checker_finds_nothing(environment: Any) -> None:
    check_env(environment)


def test_episodes_follow_from_their_seeds_and_actions(environment: Any) -> None:
    def episode(seed: int, push: float) -> tuple[np.ndarray, float]:
        environment.reset(seed=seed)
        rewards = []
        for _ in range(30):
            observation, reward, *_ = environment.step(np.array([push, push]))
            rewards.append(reward)
        return observation, sum(rewards)

    first, idle = episode(1, 0.0)
    ahead, _ = episode(1, 0.5)
    other, _ = episode(2, 0.0)
    again, idle_again = episode(1, 0.0)
    assert again.tolist() == first.tolist()
    assert idle == idle_again < 0.0
    assert ahead[0] > first[0] + 0.1  # it goes north, the way its bow points
    assert other.tolist() != first.tolist()
