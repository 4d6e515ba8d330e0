"""Masks, seeds and numbers of copies, with a row for each: checked arrays of what callers give."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import ArrayLike, NDArray

from seatrial.errors import InputError


def mask_of(mask: ArrayLike | None, count: int) -> NDArray[np.bool_]:
    """Return a mask (count,); all copies of None. Raises InputError."""
    if mask is None:
        return np.ones(count, dtype=bool)
    chosen = np.ascontiguousarray(mask)
    if chosen.dtype != bool or chosen.shape != (count,):
        raise InputError(
            f"mask: found shape {chosen.shape} of {chosen.dtype}; {count} truths are needed"
        )
    return chosen


def seeds_of(seed: int | Sequence[int], count: int) -> NDArray[np.int64]:
    """Return the seeds of copies (count,): of one number that and the next. Raises InputError."""
    given = np.asarray(seed)
    if given.dtype.kind not in "iu" or given.shape not in ((), (count,)):
        raise InputError(
            f"seed: found shape {given.shape} of {given.dtype}; one whole number, or {count}, are "
            "needed"
        )
    return given + np.arange(count) if given.shape == () else given.astype(np.int64)


def sources_of(source: ArrayLike | None, count: int) -> NDArray[np.int64]:
    """Return from which copy's state each goes on (count,); its own of None. Raises InputError."""
    if source is None:
        return np.arange(count)
    numbers = np.asarray(source)
    is_whole = numbers.shape == (count,) and numbers.dtype.kind in "iu"
    if not is_whole or numbers.min() < 0 or numbers.max() >= count:
        raise InputError(
            f"restore: source has shape {numbers.shape} of {numbers.dtype}; {count} numbers of "
            f"copies, 0 to {count - 1}, are needed"
        )
    return numbers.astype(np.int64)
