"""Uncertainty of figures from the stated errors of the sensors."""

from __future__ import annotations

import math
from collections import defaultdict
from collections.abc import Mapping, Sequence
from dataclasses import replace

import numpy as np

from seatrial.errors import InputError, unknown
from seatrial.model.units import quantity
from seatrial.trial.logs.quantities import QUANTITIES

from .evaluation import Done, figures_of
from .figures.result import Figures
from .log_record import FURTHER

_DRAWS = 100
_FOUND = 0.9
"""Share of the draws that must have a figure for its uncertainty to be known."""
_WITHIN = 1.96
_ROUNDING = 1e-9
"""Share of a figure up to which it does not depend on the errors."""
_MEASURED = ("north", "east", "heading", *FURTHER)


def read_errors(texts: Sequence[str]) -> dict[str, float]:
    """Return standard deviations, SI, by column, from texts ``WHAT=VALUE UNIT`` with commas.

    Raises InputError for another form, an unknown column, and a value that is not above 0.
    """
    errors = {}
    for part in (part.strip() for text in texts for part in text.split(",")):
        what, equals, written = part.partition("=")
        if not equals:
            raise InputError(f"--error: WHAT=VALUE UNIT is needed, found {part!r}")
        if what not in _MEASURED:
            raise InputError(f"--error: {unknown('column', what, _MEASURED)}")
        try:
            errors[what] = quantity(written, QUANTITIES[what].unit)
        except InputError as error:
            raise InputError(f"--error: {what}: {error}") from None
        if not 0.0 < errors[what] < math.inf:
            raise InputError(f"--error: {what}: a value above 0 is needed, found {written!r}")
    return errors


def with_uncertainty(done: Done, found: Figures, errors: Mapping[str, float]) -> Figures:
    """Return figures with half the width of their intervals of 95 %: 1.96 standard deviations.

    Normal errors of standard deviation ``errors``, SI, independent from row to row, are added to
    the columns of the record a hundred times, and the figures found again (propagation of
    distributions, JCGM 101:2008). A figure that does not depend on these errors, or that less than
    nine in ten of the records have, is left as it is. An error that all rows share, as of a
    compass that is misaligned, is not in it.

    Raises InputError for an error of a column that the record does not have.
    """
    columns = done.record.columns()
    for name in errors:
        if name not in columns:
            raise InputError(f"--error: the record has no {name}")
    random, drawn = np.random.default_rng(1), defaultdict(list)
    for _ in range(_DRAWS):
        noisy = {name: columns[name] + error * random.standard_normal(len(columns[name]))
                 for name, error in errors.items()}  # fmt: skip
        try:
            again = figures_of(replace(done, record=replace(done.record, **noisy)))
        except InputError:
            continue
        for name, value in again.items():
            drawn[name].append(value)
    halves = {name: _WITHIN * float(np.std(values, ddof=1))
              for name, values in drawn.items() if len(values) >= _FOUND * _DRAWS}  # fmt: skip
    figures = {
        name: replace(each, uncertainty=halves[name])
        if halves.get(name, 0.0) > _ROUNDING * abs(each.value) else each
        for name, each in found.found.items()
    }  # fmt: skip
    return replace(found, found=figures)
