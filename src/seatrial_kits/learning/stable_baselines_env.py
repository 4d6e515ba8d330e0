"""A task for Stable-Baselines3, whose vector environments are its own."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np
from gymnasium.vector import AutoresetMode
from stable_baselines3.common.vec_env import VecEnv

from seatrial.errors import InputError

from .vector import make_vec


class TaskVecEnv(VecEnv):  # type: ignore[misc,unused-ignore]
    """Copies of a task; an episode that has ended begins anew in the same step."""

    def __init__(
        self, task: str | Path, num_envs: int, settings: Mapping[str, Any] | None, threads: int
    ) -> None:
        mode = AutoresetMode.SAME_STEP
        self._vector = make_vec(task, num_envs, set=settings, threads=threads, autoreset_mode=mode)
        vector = self._vector
        super().__init__(num_envs, vector.single_observation_space, vector.single_action_space)
        self._actions = np.zeros(vector.action_space.shape or ())

    def reset(self) -> Any:
        """Start all episodes anew, with the seeds of `seed` if they have not been used yet."""
        seeds = None if None in self._seeds else [int(str(seed)) for seed in self._seeds]
        seen, _ = self._vector.reset(seed=seeds)
        self._reset_seeds()
        self._reset_options()
        self.reset_infos: list[dict[str, Any]] = [{} for _ in range(self.num_envs)]
        return seen

    def step_async(self, actions: np.ndarray) -> None:
        """Keep the actions for `step_wait`."""
        self._actions = actions

    def step_wait(self) -> Any:
        """Act until the next decision."""
        seen, rewards, terminated, truncated, found = self._vector.step(self._actions)
        done = terminated | truncated
        infos: list[dict[str, Any]] = [{} for _ in range(self.num_envs)]
        for copy in np.flatnonzero(done).tolist():
            of_all = found["final_info"]
            infos[copy] = {
                "terminal_observation": found["final_obs"][copy],
                "TimeLimit.truncated": bool(truncated[copy]),
                "is_success": bool(of_all["is_success"][copy]),
                "ended_by": str(of_all["ended_by"][copy]),
            }
        return seen, rewards, done, infos

    def close(self) -> None:
        """Release the copies."""
        self._vector.close()

    def get_attr(self, attr_name: str, indices: Any = None) -> list[Any]:
        """Return an attribute of the vector environment, once for each copy."""
        return [getattr(self._vector, attr_name, None) for _ in self._chosen(indices)]

    def set_attr(self, attr_name: str, value: Any, indices: Any = None) -> None:
        """Refuse: copies have no attributes of their own."""
        raise InputError(f"set_attr: copies of a task have no attribute {attr_name!r} of their own")

    def env_method(self, method_name: str, *_: Any, **__: Any) -> list[Any]:
        """Refuse: copies have no methods of their own."""
        raise InputError(
            f"env_method: copies of a task have no method {method_name!r} of their own"
        )

    def env_is_wrapped(self, wrapper_class: type, indices: Any = None) -> list[bool]:
        """Return False for each copy."""
        return [False for _ in self._chosen(indices)]

    def _chosen(self, indices: Any) -> Sequence[int]:
        return list(self._get_indices(indices))
