"""Batches of different systems under one interface: rows of one, then rows of the next."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from types import TracebackType
from typing import TYPE_CHECKING, Any

from seatrial.errors import InputError

from .batch import Batch

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import ArrayLike, NDArray

    Floats = NDArray[np.float64]


class Batches:
    """Several batches, as of different vehicles, that the caller steps and reads as one.

    Copies are numbered through: those of the first batch come first. Every call is that of `Batch`
    by the same name and goes to all batches, each with its rows; names must be known to all of
    them. A call that one batch refuses has been made in those before it. A batch keeps its own
    ``threads``, and the bytes that it has alone.

    Raises InputError for no batches and for steps that differ: `Batch` takes ``step``.
    """

    def __init__(self, batches: Sequence[Batch]) -> None:
        import numpy as np

        if not batches:
            raise InputError("Batches: at least one batch is needed")
        self.batches = tuple(batches)
        self.step_size = batches[0].step_size
        """Communication step, s."""
        for batch in batches:
            if batch.step_size != self.step_size:
                raise InputError(
                    f"Batches: {batch!r} has a step of {batch.step_size!r} s, and {batches[0]!r} "
                    f"one of {self.step_size!r} s; give Batch the same step"
                )
        self.of = np.repeat(np.arange(len(batches)), [batch.count for batch in batches])
        """Number of each copy's batch, shape (count,)."""
        self.count = len(self.of)
        ends = np.cumsum([batch.count for batch in batches])
        self._rows = [slice(int(e) - b.count, int(e)) for e, b in zip(ends, batches, strict=True)]

    # ------------------------------------------------------------------ time

    @property
    def time(self) -> Floats:
        """Simulated time of each copy, s, shape (count,)."""
        import numpy as np

        return np.concatenate([batch.time for batch in self.batches])

    @property
    def seeds(self) -> NDArray[np.int64]:
        """Seed of each copy."""
        import numpy as np

        return np.concatenate([batch.seeds for batch in self.batches])

    @property
    def failures(self) -> dict[int, str]:
        """By number of each copy that cannot go on: why."""
        each = zip(self.batches, self._rows, strict=True)
        return {rows.start + i: why for batch, rows in each for i, why in batch.failures.items()}

    def step(self, count: int = 1, mask: ArrayLike | None = None) -> None:
        """Let the copies of ``mask`` (count,), or all, take ``count`` communication steps."""
        for batch, chosen in self._masked(mask):
            batch.step(count, chosen)

    def record(self, count: int, *names: str) -> Floats:
        """Take ``count`` steps; return values after each, (copies, count, elements)."""
        self.get(*names)  # names that do not fit are refused before anything steps
        return self._joined(names, lambda batch: batch.record(count, *names))

    # ------------------------------------------------------------------ values

    def get(self, *names: str) -> Floats:
        """Return present values, (count,) of one scalar, else (count, n)."""
        return self._joined(names, lambda batch: batch.get(*names))

    def set(self, name: str, value: ArrayLike | str, mask: ArrayLike | None = None) -> None:
        """Set an input that nothing feeds, or a tunable parameter: one value, or rows."""
        self._give(Batch.set, name, value, mask)

    def override(self, name: str, value: ArrayLike | str, mask: ArrayLike | None = None) -> None:
        """Replace an output for all its readers, until `release` or a start."""
        self._give(Batch.override, name, value, mask)

    def release(self, name: str, mask: ArrayLike | None = None) -> None:
        """End an override."""
        for batch, chosen in self._masked(mask):
            batch.release(name, chosen)

    # ------------------------------------------------------------------ life

    def reset(
        self,
        mask: ArrayLike | None = None,
        *,
        set: Mapping[str, Any] | None = None,
        seed: int | Sequence[int] | None = None,
    ) -> None:
        """Start copies anew, those of ``mask`` or all; copy i has the seed ``seed`` + i."""
        from .per_copy import seeds_of

        seeds = None if seed is None else seeds_of(seed, self.count)
        settings = {key: self._split(value) for key, value in (set or {}).items()}
        for i, (batch, chosen) in enumerate(self._masked(mask)):
            if chosen.any():
                own = None if seeds is None else seeds[self._rows[i]].tolist()
                given = {key: values[i] for key, values in settings.items()}
                batch.reset(chosen, set=given, seed=own)

    def settings(self, copy: int) -> dict[str, Any]:
        """Return what a copy has started with beside its rig's own. Raises InputError."""
        if not 0 <= copy < self.count:
            raise InputError(f"settings: copy is {copy}, allowed 0 to {self.count - 1}")
        number = int(self.of[copy])
        return self.batches[number].settings(copy - self._rows[number].start)

    def close(self) -> None:
        """Release all batches."""
        for batch in self.batches:
            batch.close()

    def __enter__(self) -> Batches:
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        self.close()

    def __len__(self) -> int:
        return self.count

    # ------------------------------------------------------------------ inside

    def _masked(self, mask: ArrayLike | None) -> list[tuple[Batch, NDArray[np.bool_]]]:
        from .per_copy import mask_of

        whole = mask_of(mask, self.count)
        return [(b, whole[rows].copy()) for b, rows in zip(self.batches, self._rows, strict=True)]

    def _split(self, value: Any) -> list[Any]:
        """Return what each batch gets of a value: its rows, or one value for all copies."""
        import numpy as np

        rows = np.asarray(value)
        if rows.dtype.kind in "fiub" and rows.ndim and rows.shape[0] == self.count:
            return [rows[own] for own in self._rows]
        return [value] * len(self.batches)

    def _give(
        self, call: Callable[..., None], name: str, value: Any, mask: ArrayLike | None
    ) -> None:
        for (batch, chosen), own in zip(self._masked(mask), self._split(value), strict=True):
            call(batch, name, own, chosen)

    def _joined(self, names: Sequence[str], read: Callable[[Batch], Floats]) -> Floats:
        import numpy as np

        found = [read(batch) for batch in self.batches]
        sizes = [values.shape[-1] if values.ndim > 1 else 1 for values in found]
        if len(set(sizes)) > 1:
            raise InputError(f"{', '.join(names)}: the batches have {sizes} elements")
        return np.concatenate(found)
