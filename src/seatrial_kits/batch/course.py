"""Events and faults of a trial in the copies of its system."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, NamedTuple, Protocol

from seatrial.api.assembling import Assembled
from seatrial.errors import InputError

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray


class Acted(Protocol):
    """Copies that are acted on, as `Batch` is."""

    def set(self, name: str, value: Any, mask: Any) -> None:
        """Set an input or a parameter of the copies of the mask."""

    def override(self, name: str, value: Any, mask: Any) -> None:
        """Replace an output of the copies of the mask."""

    def release(self, name: str, mask: Any) -> None:
        """End that."""


_DRAWN = ("time", "jitter", "every", "grows_over")


class _Act(NamedTuple):
    call: str
    """``set``, ``override`` or ``release``."""
    name: str
    value: Any


class Course:
    """Acts by communication step, in the order in which they happen there.

    Raises InputError for a fault that is not the fixed value of an output at a fixed time.
    """

    def __init__(self, made: Assembled, step_ns: int) -> None:
        self._acts: dict[int, list[_Act]] = {}
        for event in made.events:
            self._add(event.at_ns, step_ns, _Act("set", event.key, event.written))
        entries = made.trial.file.faults if made.trial else []
        for index, (entry, fault) in enumerate(zip(entries, made.faults, strict=True)):
            written = entry.written
            if entry.what != "fixed" or written.keys() & {*_DRAWN}:
                assert made.trial is not None
                raise InputError(
                    f"{made.trial.read_from.path}: faults.{index}: copies in compiled code have "
                    f"faults with what = 'fixed' at a fixed time alone, found {written}"
                )
            for name in [entry.where] if isinstance(entry.where, str) else entry.where:
                self._add(fault.begin_ns, step_ns, _Act("override", name, written["value"]))
                if fault.end_ns is not None:
                    self._add(fault.end_ns, step_ns, _Act("release", name, None))

    def __bool__(self) -> bool:
        return bool(self._acts)

    def ahead(self, steps: NDArray[np.int64], most: int) -> int:
        """Return after how many steps the next act of one of these copies is, ``most`` at most."""
        return min([most, *(int(at - s) for at in self._acts for s in {*steps.tolist()} if at > s)])

    def act(self, batch: Acted, steps: NDArray[np.int64], chosen: NDArray[np.bool_]) -> None:
        """Do what is due in the chosen copies, which stand at these steps."""
        for at, acts in self._acts.items():
            due = chosen & (steps == at)
            if not due.any():
                continue
            for call, name, value in acts:
                if call == "release":
                    batch.release(name, due)
                else:
                    getattr(batch, call)(name, value, due)

    def _add(self, at_ns: int, step_ns: int, act: _Act) -> None:
        self._acts.setdefault(-(-at_ns // step_ns), []).append(act)
