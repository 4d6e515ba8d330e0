"""A task in copies of its system: a vector environment of Gymnasium."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np
from gymnasium.spaces import Box
from gymnasium.vector import AutoresetMode, VectorEnv
from gymnasium.vector.utils import batch_space
from numpy.typing import NDArray

from seatrial.errors import InputError, unknown
from seatrial_kits.batch.batch import Batch

from .copies import Copies
from .task import Task

Floats = NDArray[np.float64]
Singles = NDArray[np.float32]
Mask = NDArray[np.bool_]

MODES = {mode.name.lower(): mode for mode in AutoresetMode}


def make_vec(
    task: str | Path,
    num_envs: int = 1,
    *,
    set: Mapping[str, Any] | None = None,
    threads: int = 1,
    autoreset_mode: str | AutoresetMode = AutoresetMode.NEXT_STEP,
) -> TaskVectorEnv:
    """Return ``num_envs`` copies of a task, shipped or a file, as one vector environment.

    ``set`` changes what the task sets of its system, as for `seatrial.Batch`; ``threads`` share the
    copies; ``autoreset_mode`` is Gymnasium's: "next_step", "same_step" or "disabled". Raises
    InputError for bad input, a system with components that have no C, and without a compiler.
    """
    mode = MODES.get(str(autoreset_mode).lower()) if isinstance(autoreset_mode, str) else None
    if mode is None and not isinstance(autoreset_mode, AutoresetMode):
        raise InputError(f"autoreset_mode: {unknown('mode', str(autoreset_mode), MODES)}")
    return TaskVectorEnv(Task(task), num_envs, set or {}, threads, mode or autoreset_mode)  # type: ignore[arg-type]


class TaskVectorEnv(VectorEnv[Singles, Singles, NDArray[Any]]):
    """Copies of a task; observations and actions of each are in [-1, 1].

    ``reset(seed=)`` is the first copy's seed, the next has the next one, or a sequence with a seed
    for each: what an episode draws, noise and weather follow from it alone. Infos have
    ``is_success`` and ``ended_by`` of each copy that has ended.
    """

    metadata: dict[str, Any] = {"render_modes": []}  # noqa: RUF012  as Gymnasium has it

    def __init__(
        self,
        task: Task,
        num_envs: int,
        settings: Mapping[str, Any],
        threads: int,
        mode: AutoresetMode,
    ) -> None:
        file = task.file
        self.task, self.num_envs = task, num_envs
        self.metadata = {**self.metadata, "autoreset_mode": mode}
        self.batch = Batch(
            task.rig,
            num_envs,
            set={**file.set, **settings},
            variant=file.variant,
            choices=file.choices or None,
            threads=threads,
        )
        try:
            self._copies = Copies(task, self.batch)
        except BaseException:
            self.batch.close()
            raise
        self.single_observation_space = Box(-1.0, 1.0, (len(task.values),), np.float32)
        self.single_action_space = Box(-1.0, 1.0, (len(file.act),), np.float32)
        self.observation_space = batch_space(self.single_observation_space, num_envs)
        self.action_space = batch_space(self.single_action_space, num_envs)
        self.autoreset_mode = mode
        """Gymnasium's, under the name that its own vector environments have."""
        self.randoms = [np.random.default_rng() for _ in range(num_envs)]
        """What each copy's episodes are drawn from."""
        self._ended: Mask = np.ones(num_envs, dtype=bool)
        """Copies whose episode is over."""

    # ------------------------------------------------------------------ Gymnasium

    def reset(
        self,
        *,
        seed: int | Sequence[int | None] | None = None,
        options: dict[str, Any] | None = None,
    ) -> tuple[Singles, dict[str, Any]]:
        """Start all episodes anew, or those of ``options["reset_mask"]``. Raises InputError."""
        mask = (options or {}).get("reset_mask", np.ones(self.num_envs, dtype=bool))
        mask = np.asarray(mask)
        if mask.dtype != bool or mask.shape != (self.num_envs,):
            raise InputError(
                f"reset_mask: {self.num_envs} truths are needed, found {mask.dtype} of {mask.shape}"
            )
        seeds = [None] * self.num_envs if seed is None else seed
        if isinstance(seeds, (int, np.integer)):
            seeds = [int(seeds) + i for i in range(self.num_envs)]
        if len(seeds) != self.num_envs:
            raise InputError(f"seed: {self.num_envs} are needed, found {len(seeds)}")
        for i, own in enumerate(seeds):
            if own is not None and mask[i]:
                self.randoms[i] = np.random.default_rng(own)
        self._begin(mask)
        return self._copies.observation(), {}

    def step(
        self, actions: Any
    ) -> tuple[Singles, NDArray[Any], NDArray[Any], NDArray[Any], dict[str, Any]]:
        """Act in each copy until the next decision.

        Returns observations, rewards, terminated, truncated and infos as Gymnasium says them for
        the autoreset mode. Raises InputError for actions of another shape, or none at all, and
        for copies to be reset whose episode is over.
        """
        acting = np.asarray(actions, dtype=np.float64)
        if acting.shape != self.action_space.shape or not np.isfinite(acting).all():
            raise InputError(
                f"actions: finite numbers of shape {self.action_space.shape} are needed, found "
                f"shape {acting.shape}"
            )
        resting = self._ended.copy()
        if resting.any() and self.autoreset_mode is not AutoresetMode.NEXT_STEP:
            raise InputError(f"copies {np.flatnonzero(resting).tolist()} have ended: reset them")
        made = self._copies.act(np.clip(acting, -1.0, 1.0), ~resting)
        terminated, truncated = made.terminated & ~resting, made.truncated & ~resting
        rewards = np.where(resting, 0.0, made.rewards).astype(np.float32)
        self._ended = terminated | truncated
        infos = self._infos(made.ended_by, made.is_success)
        if resting.any():
            self._begin(resting)
        seen = self._copies.observation()
        if self.autoreset_mode is AutoresetMode.SAME_STEP and self._ended.any():
            ended = self._ended
            infos["final_obs"] = np.array([None] * self.num_envs, dtype=object)
            for i in np.flatnonzero(ended).tolist():
                infos["final_obs"][i] = seen[i]
            infos["_final_obs"] = ended
            infos["final_info"] = {key: infos.pop(key) for key in list(infos) if "final" not in key}
            infos["_final_info"] = ended.copy()
            self._begin(ended)
            seen = self._copies.observation()
        return seen, rewards, terminated, truncated, infos

    def close_extras(self, **_: Any) -> None:
        """Release the copies."""
        self.batch.close()

    # ------------------------------------------------------------------ inside

    def _begin(self, mask: Mask) -> None:
        self._copies.begin(mask, self.randoms)
        self._ended = self._ended & ~mask

    def _infos(self, ended_by: Any, is_success: Mask) -> dict[str, Any]:
        if not self._ended.any():
            return {}
        return {
            "is_success": is_success & self._ended,
            "_is_success": self._ended.copy(),
            "ended_by": np.where(self._ended, ended_by, ""),
            "_ended_by": self._ended.copy(),
        }
