"""Markdown tables, numbers and units as the pages write them."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import Any


def table(head: Sequence[str], rows: Iterable[Sequence[str]]) -> str:
    """Return a table."""
    lines = [head, ["---"] * len(head), *rows]
    return "".join(f"| {' | '.join(line)} |\n" for line in lines)


def shown_number(value: float | int | str) -> str:
    """Return a number as short as it is exact to six digits."""
    return value if isinstance(value, str) else f"{value:g}"


def shown_value(value: Any) -> str:
    """Return a value of a parameter file."""
    if isinstance(value, list):
        return f"({', '.join(shown_number(v) for v in value)})"
    return shown_number(value)


def fixed(value: float, decimals: int) -> str:
    """Return a number with so many decimals, a true minus and no minus zero."""
    text = f"{value:.{decimals}f}"
    return text.replace("-", "−") if float(text) else text.lstrip("-")


def shown_unit(text: str | Sequence[str]) -> str:
    """Return a unit, or one for each axis."""
    if not isinstance(text, str):
        return f"({', '.join(text)})"
    return "" if text == "1" else text
