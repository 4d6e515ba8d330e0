"""Factorial designs: every combination of the levels of some keys, or a two-level fraction."""

from __future__ import annotations

import itertools
import math
import re
from collections.abc import Mapping
from typing import Any

from ...errors import InputError
from .distributions import Distribution, levels_of

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
