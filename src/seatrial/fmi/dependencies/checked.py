"""Findings about a component and its mistakes, remembered by the hash of its code."""

from __future__ import annotations

import hashlib
import json
from dataclasses import dataclass
from functools import cache
from pathlib import Path

from ... import __version__
from ...model.component import Component
from ..cache import cache_folder, write_named
from ..components.source import ComponentSource
from .found import Through, feedthrough_of, found
from .names import refuse_mistyped
from .perturbation import refuse_dependent


@dataclass(frozen=True)
class Checked:
    """What a component's outputs depend on."""

    through: Through
    undecided: str
    """Why that of undeclared outputs is unknown, if so: they depend on all inputs."""


def refuse_mistakes(cls: type[Component]) -> None:
    """Raise InputError for outputs that nothing sets, and declarations that are wrong."""
    refuse_mistyped(cls)
    refuse_dependent(cls)


def checked(source: ComponentSource, code: str) -> Checked:
    """Return what the outputs of a component depend on, from the user's cache if it is there.

    ``code`` is the name of its bundle, which carries the hash of its code. Raises InputError as
    `refuse_mistakes` does.
    """
    path = cache_folder("feedthrough") / f"{code}-{_tag()}.json"
    try:
        content = json.loads(path.read_bytes())
        through = {name: tuple(inputs) for name, inputs in content["through"].items()}
        return Checked(through, content["undecided"])
    except (OSError, ValueError, KeyError, TypeError, AttributeError):
        pass
    made = check(source.component_class())
    content = {"through": made.through, "undecided": made.undecided}
    write_named(path, json.dumps(content).encode())
    return made


def check(cls: type[Component]) -> Checked:
    """Return what the outputs of a class depend on. Raises InputError as `refuse_mistakes` does."""
    refuse_mistakes(cls)
    through = feedthrough_of(cls)
    is_known = all(name in cls.feedthrough for name in through)
    return Checked(through, "" if is_known else found(cls).undecided)


@cache
def _tag() -> str:
    """Return a tag of what besides the component's code decides what is found."""
    digest = hashlib.sha256(__version__.encode())
    for module in sorted(Path(__file__).parent.glob("*.py")):
        digest.update(module.read_bytes())
    return digest.hexdigest()[:8]
