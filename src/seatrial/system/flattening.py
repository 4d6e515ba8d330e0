"""Rigs inside rigs: their files read, their choices made, each at its place."""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

from ..errors import InputError, unknown
from ..files.vehicle_folders import Place, owner, stem
from .files import Source, find_place, read_place, validated
from .paths import joined
from .references.own_references import with_owner
from .rig import ComponentEntry, Rig, RigFile, Scope, check_rig_file, duration_ns

_DEEPEST = 16
_CHOICE = re.compile(r"\{([A-Za-z_][A-Za-z0-9_]*)\}")
_MUST_BE_KNOWN = ("fmu", "rig", "parameters", "profile")


def load_rig(
    name: str, relative_to: Path | None = None, choices: Mapping[str, str] | None = None
) -> Rig:
    """Read the rig ``name`` (shipped, in ``harness/rigs``, or a path) with all rigs inside it.

    ``choices`` replace the defaults of its file. A rig that says no step has the shortest of
    those inside it. Raises InputError for anything wrong in the files, a choice that nothing uses,
    and a rig that contains itself.
    """
    place = find_place("harness/rigs", name, relative_to)
    reading = _Reading(dict(choices or {}))
    top = reading.scope(place, "", _Around(reading.given), ())
    idle = [name for name in reading.given if name not in reading.used]
    if idle:
        raise InputError(f"{place}: {unknown('choice', idle[0], sorted(reading.used))}")
    if not top.file.step:
        top = replace(top, file=top.file.model_copy(update={"step": _shortest_step(top)}))
    return Rig(top.file, top.read_from, top)


def _shortest_step(top: Scope) -> str | None:
    """Return the shortest communication step that a rig inside says, as written."""
    steps = {duration_ns(s.file.step, f"{s.read_from.where}: step"): s.file.step
             for s in top.all() if s.file.step}  # fmt: skip
    return steps[min(steps)] if steps else None


def rig_of(
    content: Any, read_from: Source, folder: Path, inside: Mapping[str, Any] | None = None
) -> Rig:
    """Return the rig of ``content``; ``inside`` has those of the rigs in it, by path.

    All come from one file. Their components may be connected to by path. ``folder`` is where
    relative paths of their FMUs start. Raises InputError.
    """
    top = _scope_of(content, "", read_from, folder, inside or {})
    return Rig(top.file, read_from, top)


def _scope_of(
    content: Any, place: str, read_from: Source, folder: Path, inside: Mapping[str, Any]
) -> Scope:
    file = validated(RigFile, content, read_from.where)
    check_rig_file(file, read_from.where)
    inner = {
        name: _scope_of(inside[path], path, read_from, folder, inside)
        for name, part in file.components.items()
        if part.rig
        for path in [joined(place, name)]
    }
    return Scope(place, file, read_from, folder, {}, inner, is_open=True)


@dataclass(frozen=True)
class _Around:
    """What the rigs around one give it, and those inside it."""

    choices: Mapping[str, str]
    variant: str | None = None
    home: tuple[str, str, str] | None = None
    step: tuple[str, str] | None = None
    tolerance: float | None = None

    def inside(self, entry: ComponentEntry, choices: Mapping[str, str], where: str) -> _Around:
        """Return what holds inside the rig of ``entry``: its own keys, else those around it."""
        home = (entry.home[0], entry.home[1], entry.home[2]) if entry.home else self.home
        step = self.step if entry.step is None else (entry.step, f"{where}.step")
        return replace(
            self,
            choices={**choices, **entry.choices},
            variant=entry.variant or self.variant,
            home=home,
            step=step,
        )


@dataclass
class _Reading:
    """The choices that were given, and those that a file declares or uses."""

    given: dict[str, str]
    used: set[str] = field(default_factory=set)

    def scope(self, at: Place, path: str, around: _Around, chain: tuple[Place, ...]) -> Scope:
        """Return the rig that stands at ``at`` as ``path``, with what the rigs around it give."""
        if at in chain or len(chain) > _DEEPEST:
            names = " -> ".join(stem(place) for place in (*chain, at))
            raise InputError(f"{chain[-1]}: a rig contains itself: {names}")
        content, read_from = read_place(at)
        choices = {**_declared(content), **around.choices}
        choices = {name: _chosen(text, choices) for name, text in choices.items()}
        self.used |= _declared(content).keys() | _used(content)
        where = read_from.where
        chosen = with_owner(_chosen(content, choices), owner(at.path), where)
        file = validated(RigFile, chosen, where)
        _refuse_unchosen(file, where)
        check_rig_file(file, where)
        tolerance = around.tolerance if file.tolerance is None else file.tolerance
        around = replace(around, tolerance=tolerance)
        inner = {
            name: self._inner(
                part, joined(path, name), around.inside(part, choices, key), key, (*chain, at)
            )
            for name, part in file.components.items()
            for key in [f"{where}: components.{name}"]
            if part.rig
        }
        return Scope(
            path,
            file,
            read_from,
            at.path.parent,
            choices,
            inner,
            around.variant or file.variant,
            around.home,
            step=around.step,
            tolerance=tolerance,
        )

    def _inner(
        self,
        entry: ComponentEntry,
        path: str,
        around: _Around,
        where: str,
        chain: tuple[Place, ...],
    ) -> Scope:
        try:
            at = find_place("harness/rigs", entry.rig, chain[-1].path.parent)
        except InputError as error:
            raise InputError(f"{where}.rig: {error}") from None
        before = set(self.used)
        self.used = set()
        scope = self.scope(at, path, around, chain)
        for name in entry.choices:
            if name not in self.used:
                raise InputError(f"{where}.choices: {unknown('choice', name, sorted(self.used))}")
        self.used = before | (self.used - entry.choices.keys())
        return scope


def _declared(content: Mapping[str, Any]) -> dict[str, str]:
    """Return the choices of a file's content; mistakes in them are found when it is checked."""
    table = content.get("choices", {})
    return {k: v for k, v in table.items() if isinstance(v, str)} if type(table) is dict else {}


def _texts(value: Any) -> Iterator[str]:
    """Yield all texts of a file's content, keys too."""
    if isinstance(value, str):
        yield value
    elif isinstance(value, dict):
        for key, each in value.items():
            yield key
            yield from _texts(each)
    elif isinstance(value, list):
        for each in value:
            yield from _texts(each)


def _used(content: Mapping[str, Any]) -> set[str]:
    return {match[1] for text in _texts(dict(content)) for match in _CHOICE.finditer(text)}


def _chosen(value: Any, choices: Mapping[str, str]) -> Any:
    """Return a file's content with every ``{name}`` of a choice replaced."""
    if isinstance(value, str):
        return _CHOICE.sub(lambda match: choices.get(match[1], match[0]), value)
    if isinstance(value, dict):
        return {_chosen(key, choices): _chosen(each, choices) for key, each in value.items()}
    if isinstance(value, list):
        return [_chosen(each, choices) for each in value]
    return value


def _refuse_unchosen(file: RigFile, where: str) -> None:
    for name, entry in file.components.items():
        for key in _MUST_BE_KNOWN:
            unchosen = _CHOICE.search(getattr(entry, key) or "")
            if unchosen:
                raise InputError(
                    f"{where}: components.{name}.{key}: the choice {unchosen[1]!r} has no value; "
                    f"give it one in [choices], or on the command line: --choose {unchosen[1]}=..."
                )
