"""Power bonds and settings of the algorithm ecco, in system structures of OSP-IS."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from typing import Any

from lxml import etree

from seatrial.errors import InputError
from seatrial.model.component import NS, seconds
from seatrial.system.rig import EccoEntry
from seatrial.system.system import System

from ..ssp.documents import child, children, tag, where
from .structure import NAMESPACE, End, content_of

_ELEMENTS = {
    "SafetyFactor": "safety_factor",
    "StepSize": "step",
    "MinimumStepSize": "min_step",
    "MaximumStepSize": "max_step",
    "MinimumChangeRate": "min_change",
    "MaximumChangeRate": "max_change",
    "ProportionalGain": "proportional_gain",
    "IntegralGain": "integral_gain",
    "RelativeTolerance": "relative_tolerance",
    "AbsoluteTolerance": "absolute_tolerance",
}
"""Keys of a rig's settings by the elements of EccoConfiguration, which has all of them."""


def read_settings(element: Any) -> dict[str, Any]:
    """Return an EccoConfiguration as a rig's settings. Raises InputError for what is missing."""
    found = {tag(one) for one in children(element)}
    odd = sorted(found - set(_ELEMENTS)) or sorted(set(_ELEMENTS) - found)
    if odd:
        raise InputError(
            f"{where(element)}: EccoConfiguration has {', '.join(_ELEMENTS)}, each once; "
            f"{'not known' if odd[0] in found else 'missing'}: {', '.join(odd)}"
        )
    values = {key: content_of(child(element, name)) for name, key in _ELEMENTS.items()}
    # Lengths are cut to whole nanoseconds, as in libcosim.
    return {k: f"{int(v * NS)} ns" if k.endswith("step") else v for k, v in values.items()}


def write_settings(parent: Any, system: System) -> None:
    """Add an EccoConfiguration with the settings of a rig."""
    entry = system.rig.file.ecco or EccoEntry()
    shortest, first, longest = entry.lengths(system.rig.step_ns, "ecco")
    lengths = {"step": first, "min_step": shortest, "max_step": longest}
    values = {**entry.model_dump(), **{key: seconds(ns) for key, ns in lengths.items()}}
    element = etree.SubElement(parent, f"{{{NAMESPACE}}}EccoConfiguration")
    for name, key in _ELEMENTS.items():
        etree.SubElement(element, f"{{{NAMESPACE}}}{name}").text = repr(values[key])


def bonds_as_written(
    inputs: Mapping[str, Iterable[tuple[list[End], str]]], names: Mapping[str, str]
) -> dict[str, list[str]]:
    """Return a rig's bonds: by name, of each connection of a bond the inputs that it feeds.

    A group connection has a bond for each pair of its variables. Raises InputError for a bond whose
    variables do not go there and back between two simulators.
    """
    bonds: dict[str, list[str]] = {}
    for name, connections in inputs.items():
        of_owner: dict[str, list[str]] = {}
        place = ""
        for ends, line in connections:
            place = place or line
            for end in ends:
                of_owner.setdefault(end.owner, []).append(f"{names[end.owner]}.{end.name}")
        sides = list(of_owner.values())
        if len(sides) != 2 or len(sides[0]) != len(sides[1]):
            fed = ", ".join(one for side in sides for one in side)
            raise InputError(
                f"{place}: the power bond {name!r} is one connection there and one back between "
                f"two simulators; its connections feed {fed or 'nothing'}"
            )
        for number, pair in enumerate(zip(*sides, strict=True)):
            bonds[name if len(sides[0]) == 1 else f"{name}[{number}]"] = list(pair)
    return bonds


def bonds_by_input(system: System, notes: list[str]) -> dict[tuple[str, str], str]:
    """Return the power bonds of a rig, by the inputs of their connections.

    The scalars of a bond between vectors are bonds of their own. Raises InputError for a bond that
    ecco needs and that OSP-IS cannot say; without ecco it is left out, and so are all if there are
    several, which libcosim's reader refuses.
    """
    with_ecco = system.rig.file.algorithm == "ecco"
    plain = {one.target for one in system.connections if not one.scales}
    found: dict[tuple[str, str], str] = {}
    for bond in system.bonds:
        for number, pair in enumerate(bond.pairs):
            if plain.issuperset(pair):
                name = bond.name if len(bond.pairs) == 1 else f"{bond.name}[{number}]"
                found.update(dict.fromkeys(pair, name))
            elif with_ecco:
                raise InputError(
                    f"the power bond {bond.name}: OSP-IS has none on connections with a factor or "
                    "an offset, which conversions of units are too"
                )
    names = list(dict.fromkeys(found.values()))
    if len(names) < 2:
        return found
    left_out = "" if with_ecco else "; they are left out"
    notes.append(
        f"power bonds {', '.join(names)}: libcosim reads no system structure with more than one"
        f"{left_out}"
    )
    return found if with_ecco else {}
