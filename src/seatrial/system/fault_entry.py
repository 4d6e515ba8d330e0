"""Faults as a person writes them: in a trial, on the command line, in Python."""

from __future__ import annotations

from typing import Any

from pydantic import Field

from ..errors import InputError, unknown
from ..model.faults.catalogue import kinds
from .files import FileModel


class FaultEntry(FileModel):
    """Something that goes wrong: what, where, when, how long, how it grows; and its settings."""

    what: str
    where: str | list[str]
    at: str | None = None
    for_: str | None = Field(default=None, alias="for")
    grows_over: str | None = None
    of: str | None = None
    value: Any = None
    rate: Any = None
    factor: Any = None
    low: Any = None
    high: Any = None
    coefficients: Any = None
    probability: Any = None
    time: Any = None
    jitter: Any = None
    every: Any = None
    wraps: Any = None

    @property
    def places(self) -> list[str]:
        """Where it acts."""
        return [self.where] if isinstance(self.where, str) else self.where

    @property
    def settings(self) -> dict[str, Any]:
        """What is written of the settings that kinds of faults take."""
        written = self.model_dump(exclude_none=True)
        return {key: value for key, value in written.items() if key not in _COMMON}

    @property
    def written(self) -> dict[str, Any]:
        """What is written, as in a file."""
        return self.model_dump(exclude_none=True, by_alias=True)


_COMMON = ("what", "where", "at", "for_", "grows_over")


def check_entry(entry: FaultEntry, where: str) -> None:
    """Raise InputError for a fault that there is not, and for settings that it does not take."""
    kind = kinds().get(entry.what)
    if kind is None:
        raise InputError(f"{where}.what: {unknown('fault', entry.what, kinds())}")
    taken = [*kind.settings, *(["of"] if "measurement" in kind.on else [])]
    for key in entry.settings:
        if key not in taken:
            takes = f"takes {', '.join(taken)}" if taken else "takes no settings"
            raise InputError(f"{where}.{key}: {entry.what} {takes}")
    if entry.grows_over is not None and not kind.grows:
        growing = ", ".join(name for name, each in kinds().items() if each.grows)
        raise InputError(
            f"{where}.grows_over: {entry.what} acts at once; those that grow: {growing}"
        )
    if not entry.places:
        raise InputError(f"{where}.where: at least one place is needed, found []")


def read_fault(text: str, where: str) -> dict[str, Any]:
    """Return ``PLACE=FAULT, KEY=VALUE, ...`` as it would stand in a file.

    Several places are separated by ``+``. Values are numbers, lists, or texts without quotes.
    Raises InputError.
    """
    from ..files.reading import toml_content

    first, *rest = _split(text)
    place, equals, what = (part.strip() for part in first.partition("="))
    if not (equals and place and what):
        raise InputError(f"{where}: PLACE=FAULT, KEY=VALUE, ... is needed, found {text!r}")
    places = [each.strip() for each in place.split("+")]
    found: dict[str, Any] = {"what": what, "where": places if len(places) > 1 else place}
    for part in rest:
        key, equals, value = (each.strip() for each in part.partition("="))
        if not (equals and key and value):
            raise InputError(f"{where}: KEY=VALUE is needed after a comma, found {part.strip()!r}")
        try:
            found[key] = toml_content(f"x = {value}".encode(), where)["x"]
        except (InputError, UnicodeEncodeError):
            found[key] = value
    return found


def _split(text: str) -> list[str]:
    """Return what stands between commas that are in no bracket."""
    parts, depth = [""], 0
    for character in text:
        depth += (character in "[{") - (character in "]}")
        if character == "," and not depth:
            parts.append("")
        else:
            parts[-1] += character
    return parts
