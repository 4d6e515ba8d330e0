"""A task for Stable-Baselines3, which few have beside the project."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any

from seatrial.errors import InputError

if TYPE_CHECKING:
    from .stable_baselines_env import TaskVecEnv


def stable_baselines(
    task: str | Path, num_envs: int = 1, *, set: Mapping[str, Any] | None = None, threads: int = 1
) -> TaskVecEnv:
    """Return ``num_envs`` copies of a task as Stable-Baselines3 has them; see `make_vec`.

    Raises InputError as that does, and without Stable-Baselines3.
    """
    try:
        from .stable_baselines_env import TaskVecEnv
    except ModuleNotFoundError as error:
        raise InputError(f"{error}: pip install stable-baselines3") from None
    return TaskVecEnv(task, num_envs, set, threads)
