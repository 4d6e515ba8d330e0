"""Components that have a native carrier, and the reasons of the others."""

from __future__ import annotations

import re

from parts import part
from parts.markdown import table
from seatrial.fmi.components.index import component_class, components
from seatrial.model.plant import Plant
from seatrial_kits.native.carriers import why_python


@part("native-components")
def native_components() -> str:
    """Return the carriers of all components."""
    why = {name: why_python(component_class(name)) for name in components().names()}
    native = [name for name, reason in why.items() if not reason]
    plants = [name for name in native if issubclass(component_class(name), Plant)]
    others = [name for name in native if name not in plants]
    reasons: dict[str, list[str]] = {}
    for name, reason in why.items():
        if reason:
            reasons.setdefault(_short(reason), []).append(name)
    rows = [
        [f"native, from equations ({len(plants)})", _listed(plants), ""],
        [f"native, from statements ({len(others)})", _listed(others), ""],
        *(["Python", _listed(names), reason] for reason, names in sorted(reasons.items())),
    ]
    return table(["carrier", "components", "why"], rows)


def _listed(names: list[str]) -> str:
    return ", ".join(f"`{name}`" for name in names)


def _short(reason: str) -> str:
    """Return a reason with the file's name only, and without objects of this process."""
    own = re.sub(r"\S*/([\w.]+):\d+ \(([\w.<>]+)\): ", r"`\2`, \1: ", reason)
    return re.sub(r" at 0x[0-9a-f]+", "", own).replace("|", "\\|")
