"""Tasks for agents that learn, as environments of Gymnasium: ``docs/how-to/learn.md``.

A task is a file that says what an agent observes, does and is rewarded for in a rig or a trial.
Those that are shipped are registered as ``seatrial/NAME-v0``, too.
"""

from __future__ import annotations

from typing import Any

from .plugins import service
from .shipped import available

__all__ = ["make", "make_vec", "stable_baselines", "tasks", "write_policy"]


make: Any
make_vec: Any
stable_baselines: Any
write_policy: Any


def __getattr__(name: str) -> Any:
    if name in __all__:
        return service(f"learning.{name}")
    raise AttributeError(f"module {__name__!r} has no attribute {name!r}")


def tasks() -> list[str]:
    """Return the names of the tasks that there are: shipped, of kits, of the folder ``harness``."""
    return sorted(available("harness/tasks"))


def _register() -> None:
    import gymnasium

    for name in tasks():
        gymnasium.register(
            f"seatrial/{name}-v0",
            entry_point="seatrial.gym:make",
            vector_entry_point="seatrial.gym:make_vec",
            kwargs={"task": name},
        )


_register()
