"""Text of a proposed vehicle file."""

from __future__ import annotations

import json
from collections.abc import Iterator
from typing import Any

from .value import Part, Proposal, Value

_TABLE = "hull"


def vehicle_text(proposal: Proposal) -> str:
    """Return the TOML of a vehicle's folder: body, parts, rig and shape."""
    return "\n".join(_lines(proposal)) + "\n"


def component(proposal: Proposal) -> str:
    """Return the component that the body is for."""
    return "fitted-craft" if proposal.parts else "marine-craft"


def _lines(proposal: Proposal) -> Iterator[str]:
    title = f"{proposal.kind} of {proposal.length:g} m, estimated from its main particulars"
    yield f"title = {_text(title)}"
    yield 'source = "seatrial estimate"'
    outline = {"length": proposal.length, "beam": proposal.beam, "source": "main particulars"}
    yield f"outline = {_value(outline)}"
    for note in proposal.notes:
        yield f"# {note}"
    yield from ("", f"[{_TABLE}]")
    yield from map(_entry, proposal.values)
    for part in proposal.parts:
        yield from _part(part)
    yield from _rig(proposal)
    yield from ("", "[shape]", f"{_TABLE} = [")
    yield from (f"  {_value(drawn)}," for drawn in proposal.shape)
    yield "]"


def _part(part: Part) -> Iterator[str]:
    yield from ("", f"[[{_TABLE}.{part.sort}]]")
    yield f"kind = {_text(part.kind)}"
    yield 'source = "seatrial estimate"'
    yield 'mark = "assumed"'
    yield from map(_entry, part.values)


def _rig(proposal: Proposal) -> Iterator[str]:
    title = f"{proposal.kind}: the body alone"
    yield from ("", "[rig]", f"title = {_text(title)}", 'step = "10 ms"')
    yield from ("", "[rig.components]")
    yield f'{_TABLE} = {{ fmu = "{component(proposal)}", parameters = ".{_TABLE}" }}'
    yield from ("", "[rig.shows]")
    shown = {"motion": "motion", "load": "wrench", "attachment": "attachment"}
    sorts = {part.sort for part in proposal.parts}
    if "propulsors" in sorts:
        shown |= {"propulsor_orders": "propulsor_orders", "propulsor_angles": "propulsor_angles"}
    if "foils" in sorts:
        shown["foil_angles"] = "foil_angles"
    yield from (f'{name} = "{_TABLE}.{terminal}"' for name, terminal in shown.items())


def _entry(value: Value) -> str:
    written: dict[str, Any] = {"value": value.value}
    if not isinstance(value.value, str):
        written["unit"] = value.unit
    written |= {"source": value.source, "mark": value.mark}
    return f"{value.name} = {_value(written)}"


def _value(value: Any) -> str:
    if isinstance(value, dict):
        inside = ", ".join(f"{key} = {_value(each)}" for key, each in value.items())
        return f"{{ {inside} }}"
    if isinstance(value, list | tuple):
        return f"[{', '.join(map(_value, value))}]"
    return _text(value) if isinstance(value, str) else repr(value)


def _text(text: str) -> str:
    return json.dumps(text, ensure_ascii=False)
