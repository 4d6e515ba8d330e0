"""Characteristics of the Wageningen B series: open water by polynomials, four quadrants."""

from __future__ import annotations

from functools import cache
from pathlib import Path
from typing import Any

DATA_FILES = ("wageningen_b.csv", "wageningen_b4_70.csv")

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
    return tuple(
        (name, float(C), int(s), int(t), int(u), int(v))
        for name, C, s, t, u, v in _rows(DATA_FILES[0])
    )


@cache
def wageningen_b4_70() -> tuple[list[float], list[float]]:
    """Return the series of C_T* and C_Q* of the propeller B4-70 with P/D 1.0, all four quadrants.

    Coefficients a0 ... a20, b1 ... b20 of cos(k beta) and sin(k beta), as `all_quadrants` takes
    them: W. P. A. van Lammeren, J. D. van Manen and M. W. C. Oosterveld, The Wageningen B-screw
    series, Trans. SNAME 77 (1969), as the Marine Systems Simulator's users tabulate them.
    """
    curves: dict[str, tuple[list[float], list[float]]] = {"C_T": ([], []), "C_Q": ([], [])}
    for name, _k, a, b in _rows(DATA_FILES[1]):
        curves[name][0].append(float(a))
        curves[name][1].append(float(b))
    thrust, moment = ([*a, *b[1:]] for a, b in curves.values())
    return thrust, moment


def _rows(name: str) -> list[list[str]]:
    _head, *lines = Path(__file__).with_name(name).read_text("ascii").split()
    return [line.split(",") for line in lines]
