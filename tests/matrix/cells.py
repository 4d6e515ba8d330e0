"""Cells of the matrix: link kinds from the registries, carriers, events; and a choice of them."""

from __future__ import annotations

from collections.abc import Iterable
from itertools import product
from typing import NamedTuple

from seatrial.fmi.index import component_class, components
from seatrial.links.can.gateway_url import FORMS
from seatrial.links.endpoints.url import TRANSPORTS

from .kinds import Kind

CARRIERS = ("fmu", "direct", "native", "isolated", "live")
EVENTS = ("start", "garbage", "unplug", "port taken", "hang", "term", "kill")


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

    Greedy: of the cells with the most new pairs the first. The same cells give the same choice.
    """
    left = {pair for cell in cells for pair in _pairs(cell)}
    chosen: list[Cell] = []
    while left:
        best = max(cells, key=lambda cell: len(left.intersection(_pairs(cell))))
        chosen.append(best)
        left.difference_update(_pairs(best))
    return sorted(chosen, key=cells.index)


def _pairs(cell: Cell) -> list[tuple[str, str, str]]:
    kind, carrier, event = cell
    return [("carrier", kind, carrier), ("event", kind, event), ("both", carrier, event)]


def runs(cells: Iterable[Cell]) -> dict[tuple[str, str], list[str]]:
    """Return the kinds that one run has, by carrier and event: those that it does not end share."""
    found: dict[tuple[str, str], list[str]] = {}
    for kind, carrier, event in cells:
        alone = f" of {kind}" if event in ("unplug", "port taken") else ""
        found.setdefault((carrier, event + alone), []).append(kind)
    return found
