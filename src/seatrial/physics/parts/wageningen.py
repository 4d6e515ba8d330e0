"""Open-water characteristics of the Wageningen B series, by polynomials."""

from __future__ import annotations

from functools import cache
from pathlib import Path
from typing import Any

DATA_FILES = ("wageningen_b.csv",)

BLADES = (2.0, 7.0)
PITCH_RATIOS = (0.5, 1.4)
AREA_RATIOS = (0.3, 1.05)
"""Ranges of the series."""

_HIGHEST = 3
"""Power of J."""


def wageningen_b(blades: Any, pitch_ratio: Any, area_ratio: Any) -> tuple[list[Any], list[Any]]:
    """Return the coefficients of 1, J, J^2, J^3 in K_T and K_Q; numbers or expressions.

    K = sum C J^s (P/D)^t (A_E/A_O)^u Z^v at a Reynolds number of 2e6: M. W. C. Oosterveld and
    P. van Oossanen, Further computer-analyzed data of the Wageningen B-screw series, Int.
    Shipbuild. Progress 22 (1975), as Bernitsas, Ray and Kinley (Univ. of Michigan, 1981) print
    them. Valid for 2 to 7 blades, P/D 0.5 to 1.4 and A_E/A_O 0.3 to 1.05, from J = 0 to the J of
    no thrust.
    """
    curves = {name: [0.0] * (_HIGHEST + 1) for name in ("K_T", "K_Q")}
    for name, C, s, t, u, v in _terms():
        curves[name][s] += C * pitch_ratio**t * area_ratio**u * blades**v
    return curves["K_T"], curves["K_Q"]


@cache
def _terms() -> tuple[tuple[str, float, int, int, int, int], ...]:
    _head, *lines = Path(__file__).with_name(*DATA_FILES).read_text("ascii").split()
    rows = (line.split(",") for line in lines)
    return tuple((name, float(C), int(s), int(t), int(u), int(v)) for name, C, s, t, u, v in rows)
