"""Cells of the matrix: link kinds from the registries, carriers, events; and a choice of them."""

from __future__ import annotations

from collections.abc import Iterable
from itertools import product
from typing import NamedTuple

from seatrial.fmi.components.index import component_class, components
from seatrial.links.endpoints.url import TRANSPORTS
from seatrial_kits.can.gateways.url import FORMS

from .kinds import Kind

CARRIERS = ("direct", "fmu", "native", "live", "isolated")
EVENTS = ("start", "garbage", "hang", "term", "kill", "unplug", "port taken")
ENDS_ONE = ("unplug", "port taken")
"""What ends the run for one link: others cannot share that run."""


class Cell(NamedTuple):
    """One combination."""

    kind: str
    carrier: str
    event: str


def kinds() -> list[str]:
    """Return every link kind: each transport, each gateway of a bus, each component with links."""
    found = [f"serial-gateway {scheme}" for scheme in TRANSPORTS.names()]
    found += [f"can-gateway {form}" for form in FORMS]
    for name in components().names():
        reaches = not component_class(name).rolls_back
        if reaches and name not in ("serial-gateway", "can-gateway"):
            found.append(name)
    return found


def excuse(cell: Cell) -> str:
    """Return why a cell cannot apply, empty if it does."""
    kind = Kind.of(cell.kind)
    if kind is None:
        return "nobody has said yet how the other end of this link is played"
    return kind.excuses.get(cell.event, kind.excuses.get("*", ""))


def every() -> list[Cell]:
    """Return all cells, in a fixed order."""
    return [Cell(*each) for each in product(kinds(), CARRIERS, EVENTS)]


def applying(cells: Iterable[Cell]) -> list[Cell]:
    """Return the cells that apply."""
    return [cell for cell in cells if not excuse(cell)]


def pairwise(cells: list[Cell]) -> list[Cell]:
    """Return cells among which is each pair of two dimensions' values that the given ones have.

    Greedy: of the cells with the most new pairs the first, those whose runs are shared before the
    others. The same cells give the same choice.
    """
    found: set[tuple[str, str, str]] = set()
    chosen: list[Cell] = []
    for some in ([cell for cell in cells if cell.event not in ENDS_ONE], cells):
        left = {pair for cell in some for pair in _pairs(cell)} - found
        while left:
            best = max(some, key=lambda cell: len(left.intersection(_pairs(cell))))
            chosen.append(best)
            left.difference_update(_pairs(best))
            found.update(_pairs(best))
    return sorted(chosen, key=cells.index)


def _pairs(cell: Cell) -> list[tuple[str, str, str]]:
    kind, carrier, event = cell
    return [("carrier", kind, carrier), ("event", kind, event), ("both", carrier, event)]


def runs(cells: Iterable[Cell]) -> dict[tuple[str, str], list[str]]:
    """Return the kinds that one run has, by carrier and event: those that it does not end share."""
    found: dict[tuple[str, str], list[str]] = {}
    for kind, carrier, event in cells:
        alone = f" of {kind}" if event in ENDS_ONE else ""
        found.setdefault((carrier, event + alone), []).append(kind)
    return found
