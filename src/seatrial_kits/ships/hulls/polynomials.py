"""Polynomials of manoeuvring derivatives, whose names spell the products that they multiply."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import casadi as ca


def polynomial(terms: Sequence[str], coefficients: Any, factors: Mapping[str, Any]) -> Any:
    """Return the sum of ``coefficients``, a CasADi column, times the products of ``terms``.

    Each letter of a term is one of ``factors``: "vvr" is v v r; "const" is 1.
    """
    return sum(
        coefficient * _product(term, factors)
        for term, coefficient in zip(terms, ca.vertsplit(coefficients), strict=True)
    )


def _product(term: str, factors: Mapping[str, Any]) -> Any:
    product: Any = 1.0
    for factor in term if term != "const" else "":
        product = product * factors[factor]
    return product
