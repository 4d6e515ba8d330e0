"""Components that have a native carrier, and the reasons of the others."""

from __future__ import annotations

import re

from parts import part
from parts.markdown import table
from seatrial.fmi.components.index import component_class, components
from seatrial.model.plant import Plant
from seatrial.shipped import available
from seatrial.trial.files.trial import load_trial
from seatrial.trial.running.hooks import Hooks
from seatrial.trial.running.preparation import prepare
from seatrial_kits.native.carriers import why_python
from seatrial_kits.native.engine import in_python


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


@part("native-carried")
def native_trials() -> str:
    """Return the shipped trials that are wholly in C, and what keeps the others from it."""
    whole: list[str] = []
    kept: dict[tuple[str, str], list[str]] = {}
    for name in sorted(available("harness/trials")):
        system = prepare(load_trial(name), "direct", Hooks()).system
        reasons = in_python(system)
        if not reasons:
            whole.append(name)
        for reason, parts in reasons.items():
            for kind in {system.parts[each].fmu for each in parts}:
                kept.setdefault((kind, _short(reason)), []).append(name)
        system.discard()
    rows = [[f"wholly in C ({len(whole)})", "", _listed(whole)]]
    rows += [[f"`{kind}`", why, _listed(names)] for (kind, why), names in sorted(kept.items())]
    return table(["in Python", "why", "trials"], rows)


def _listed(names: list[str]) -> str:
    return ", ".join(f"`{name}`" for name in names)


def _short(reason: str) -> str:
    """Return a reason with the file's name only, and without objects of this process."""
    own = re.sub(r"\S*/([\w.]+):\d+ \(([\w.<>]+)\): ", r"`\2`, \1: ", reason)
    return re.sub(r" at 0x[0-9a-f]+", "", own).replace("|", "\\|")
