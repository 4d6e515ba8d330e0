"""Designs of campaigns: cases drawn from distributions, repeatable by a seed, or factorial."""

from __future__ import annotations

import itertools
import math
import re
from collections.abc import Mapping, Sequence
from typing import Any, Literal

import numpy as np
from pydantic import Field

from seatrial.errors import InputError
from seatrial.system.files import FileModel

from .distributions import Distribution, Law, levels_of, read_distribution
from .scatter import Scatter, ScatterEntry, read_scatter

MOST_CASES = 1_000_000
_TINY = 2.0**-40
"""How near to 0 and 1 a probability comes: a normal distribution has no value there."""


class Correlation(FileModel):
    """How two keys of a design go together."""

    between: list[str] = Field(min_length=2, max_length=2)
    coefficient: float = Field(gt=-1.0, lt=1.0)


class Design(FileModel):
    """The cases that a campaign draws: each is one value of every key of ``vary``."""

    kind: Literal[
        "latin-hypercube", "sobol", "monte-carlo", "full-factorial", "fractional-factorial"
    ]
    count: int | None = Field(default=None, gt=0, le=MOST_CASES)
    seed: int = Field(default=0, ge=0)
    vary: dict[str, Distribution] = Field(default_factory=dict)
    correlation: list[Correlation] = Field(default_factory=list)
    scatter: ScatterEntry | None = None
    """Two more keys, drawn together."""
    resolution: int | None = Field(default=None, ge=3)
    generators: str | None = None

    @property
    def keys(self) -> list[str]:
        """All keys that it draws: of ``vary``, then rows and columns of ``scatter``."""
        scatter = self.scatter
        return [*self.vary, *([scatter.rows.key, scatter.columns.key] if scatter else [])]


def drawn(design: Design, origin: str) -> list[dict[str, Any]]:
    """Return the settings of each case of a design, by key.

    Points are of the unit cube (independent; a Latin hypercube with one point in each of ``count``
    strata of every key; Sobol's sequence, scrambled after Owen), and go through the inverse of each
    distribution's cumulative one. Correlation is that of the normal scores (a Gaussian copula):
    between normal keys it is Pearson's. The keys of a scatter diagram are independent of others.
    Factorial designs have every combination of the levels, or a fraction of them
    (`factorial_rows`). Raises InputError.
    """
    if not design.keys:
        raise InputError(f"{origin}: nothing varies: vary needs a key, or scatter two")
    if design.kind.endswith("-factorial"):
        _refuse(design, ("count", "seed", "correlation", "scatter"), origin)
        fraction = design.resolution, design.generators
        if design.kind == "full-factorial":
            _refuse(design, ("resolution", "generators"), origin)
            return factorial_rows(design.vary, None, MOST_CASES, origin)
        return factorial_rows(design.vary, fraction, MOST_CASES, origin)
    _refuse(design, ("resolution", "generators"), origin)
    if design.count is None:
        raise InputError(f"{origin}: count: {design.kind} needs it")
    laws, scatter = laws_of(design, origin)
    lower = lower_factor(design, origin)
    points = np.clip(_points(design, design.count, origin), _TINY, 1.0 - _TINY)
    if design.correlation:
        from scipy import special  # dear to import, and no other command needs it

        points = special.ndtr(special.ndtri(points) @ lower.T)
    numbers = joint_quantiles(list(laws.values()), scatter, points)
    columns = [law.settings(column) for law, column in zip(laws.values(), numbers, strict=True)]
    return [dict(zip(laws, row, strict=True)) for row in zip(*columns, strict=True)]


def laws_of(design: Design, origin: str) -> tuple[dict[str, Law], Scatter | None]:
    """Return the distribution of each key by itself, and the scatter diagram. Raises InputError."""
    laws = {
        key: read_distribution(entry, f"{origin}: vary: {key}")
        for key, entry in design.vary.items()
    }
    if design.scatter is None:
        return laws, None
    scatter = read_scatter(design.scatter, f"{origin}: scatter")
    if twice := laws.keys() & scatter.laws.keys():
        raise InputError(f"{origin}: scatter: {min(twice)} is a key of vary too")
    return laws | scatter.laws, scatter


def joint_quantiles(
    laws: Sequence[Law], scatter: Scatter | None, probabilities: np.ndarray
) -> list[np.ndarray]:
    """Return each key's numbers at probabilities, a column each; those of a diagram are last."""
    alone = laws if scatter is None else laws[:-2]
    numbers = [law.quantiles(probabilities[:, i]) for i, law in enumerate(alone)]
    return numbers if scatter is None else [*numbers, *scatter.numbers(probabilities[:, -2:]).T]


def _refuse(design: Design, keys: Sequence[str], origin: str) -> None:
    """Raise InputError if one of ``keys`` is given, which this kind of design does not take."""
    for key in keys:
        if key in design.model_fields_set:
            raise InputError(f"{origin}: {key}: not of {design.kind}")


def _points(design: Design, count: int, origin: str) -> np.ndarray:
    """Return points of the unit cube, a row for each case."""
    dimensions, random = len(design.keys), np.random.default_rng(design.seed)
    if design.kind == "monte-carlo":
        return random.random((count, dimensions))
    from scipy.stats import qmc  # half a second, of every command if it stood above

    if design.kind == "latin-hypercube":
        return np.asarray(qmc.LatinHypercube(dimensions, seed=random).random(count))
    if count & (count - 1):
        below = 1 << (count.bit_length() - 1)
        raise InputError(
            f"{origin}: count: Sobol's sequence needs a power of 2, such as {below} or "
            f"{2 * below}, found {count}"
        )
    return np.asarray(qmc.Sobol(dimensions, seed=random).random(count))


def lower_factor(design: Design, origin: str) -> np.ndarray:
    """Return Cholesky's factor of the correlation matrix."""
    keys, matrix = list(design.vary), np.eye(len(design.keys))
    if design.correlation and design.kind == "latin-hypercube":
        raise InputError(
            f"{origin}: correlation: it would break the strata of a latin-hypercube; "
            "take sobol or monte-carlo"
        )
    seen = set[frozenset[str]]()
    for entry in design.correlation:
        pair = frozenset(entry.between)
        if len(pair) < 2 or not pair <= set(keys) or pair in seen:
            raise InputError(
                f"{origin}: correlation: between: two different keys of vary ({', '.join(keys)}), "
                f"each pair once, found {entry.between}"
            )
        seen.add(pair)
        i, j = (keys.index(key) for key in entry.between)
        matrix[i, j] = matrix[j, i] = entry.coefficient
    try:
        return np.linalg.cholesky(matrix)
    except np.linalg.LinAlgError:
        least = np.linalg.eigvalsh(matrix)[0]
        raise InputError(
            f"{origin}: correlation: the matrix is not positive definite, its least eigenvalue "
            f"is {least:.3g}: these coefficients contradict each other"
        ) from None


Fraction = tuple[int | None, str | None]
"""Least resolution, or generators."""


def factorial_rows(
    vary: Mapping[str, Distribution], fraction: Fraction | None, most: int, origin: str
) -> list[dict[str, Any]]:
    """Return the settings of each case, by key; the last key changes fastest.

    Without ``fraction``, every combination. With it, a regular two-level fraction 2^(k-p): a word
    for each key, one letter for a key of its own and several for the product of those, as in
    ``a b c abc`` (Box, Hunter and Hunter); or the smallest that has at least a resolution, the
    length of the shortest word of its defining relation. Raises InputError.
    """
    levels = {key: levels_of(entry, f"{origin}: vary: {key}") for key, entry in vary.items()}
    if fraction is None:
        count = math.prod(len(each) for each in levels.values())
        if count > most:
            raise InputError(f"{origin}: vary: {count} combinations; at most {most}")
        return [dict(zip(levels, row, strict=True)) for row in itertools.product(*levels.values())]
    for key, each in levels.items():
        if len(each) != 2:
            raise InputError(
                f"{origin}: vary: {key}: a fractional-factorial needs two levels, found {len(each)}"
            )
    return [
        {key: each[sign > 0.0] for (key, each), sign in zip(levels.items(), row, strict=True)}
        for row in _signs(len(levels), fraction, origin)
    ]


def _signs(keys: int, fraction: Fraction, origin: str) -> list[list[float]]:
    """Return -1 or 1 for each case and key."""
    import pydoe  # dear to import, and no other command needs it

    resolution, generators = fraction
    if (resolution is None) == (generators is None):
        raise InputError(f"{origin}: a fractional-factorial needs resolution or generators")
    if resolution is not None:
        try:
            found = pydoe.fracfact_by_res(keys, resolution)
        except ValueError as error:
            raise InputError(f"{origin}: resolution: {error}") from None
    else:
        assert generators is not None
        found = pydoe.fracfact(_words(keys, generators, f"{origin}: generators"))
    return [[float(sign) for sign in row] for row in found]


def _words(keys: int, generators: str, where: str) -> str:
    """Return generators as checked: letters of their own from a on, products of those."""
    words = generators.split()
    if len(words) != keys:
        raise InputError(f"{where}: a word for each of {keys} keys of vary, found {generators!r}")
    own = [word.lstrip("+-") for word in words if len(word.lstrip("+-")) == 1]
    letters = "".join(sorted(own))
    if letters != "abcdefghijklmnopqrstuvwxyz"[: len(own)]:
        raise InputError(f"{where}: letters of their own are a, b, c, ..., found {generators!r}")
    for word in words:
        said = re.fullmatch(r"[+-]?([a-z]+)", word)
        if not said or len(set(said[1])) < len(said[1]) or not set(said[1]) <= set(letters):
            raise InputError(f"{where}: {word!r} is no product of {', '.join(letters)}")
    return " ".join(words)
