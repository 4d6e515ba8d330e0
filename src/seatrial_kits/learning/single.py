"""A task in one copy of its system: an environment of Gymnasium."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
from gymnasium import Env
from gymnasium.vector import AutoresetMode
from numpy.typing import NDArray

from .vector import make_vec

Singles = NDArray[np.float32]


def make(task: str | Path, *, set: Mapping[str, Any] | None = None) -> TaskEnv:
    """Return one copy of a task, shipped or a file, as an environment; see `make_vec`."""
    return TaskEnv(task, set)


class TaskEnv(Env[Singles, Singles]):
    """One copy of a task; see `TaskVectorEnv`."""

    metadata: dict[str, Any] = {"render_modes": []}  # noqa: RUF012  as Gymnasium has it

    def __init__(self, task: str | Path, settings: Mapping[str, Any] | None = None) -> None:
        self._vector = make_vec(task, 1, set=settings, autoreset_mode=AutoresetMode.DISABLED)
        self.observation_space = self._vector.single_observation_space
        self.action_space = self._vector.single_action_space

    def reset(
        self, *, seed: int | None = None, options: dict[str, Any] | None = None
    ) -> tuple[Singles, dict[str, Any]]:
        """Start an episode. Raises InputError."""
        super().reset(seed=seed)
        self._vector.randoms[0] = self.np_random
        seen, infos = self._vector.reset()
        return seen[0], infos

    def step(self, action: Any) -> tuple[Singles, float, bool, bool, dict[str, Any]]:
        """Act until the next decision. Raises InputError for an action of another shape."""
        seen, rewards, terminated, truncated, infos = self._vector.step(np.asarray(action)[None])
        own = {key: value[0] for key, value in infos.items() if not key.startswith("_")}
        return seen[0], float(rewards[0]), bool(terminated[0]), bool(truncated[0]), own

    def close(self) -> None:
        """Release the copy."""
        self._vector.close()
