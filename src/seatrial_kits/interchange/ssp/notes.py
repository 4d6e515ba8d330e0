"""Notes of a reader of packages: what it met and does not use."""

from __future__ import annotations

from dataclasses import dataclass, field

from seatrial.errors import InputError


@dataclass
class Notes:
    """What a reader met and does not use, once each; ``strict`` refuses what it does not know."""

    strict: bool = False
    _texts: dict[str, list[str]] = field(default_factory=dict)
    """Places, by what is said of them."""

    def add(self, text: str) -> None:
        """Keep what the user should know."""
        self._texts.setdefault(text, [])

    def pass_over(self, place: str, text: str) -> None:
        """Keep what is not used and cannot change the result; InputError if ``strict``."""
        if self.strict:
            raise InputError(f"{place}: {text}")
        self._texts.setdefault(text, []).append(place)

    @property
    def texts(self) -> tuple[str, ...]:
        """All that was kept, in the order in which it was met."""
        return tuple(_said(text, places) for text, places in self._texts.items())


def _said(text: str, places: list[str]) -> str:
    more = f" (and at {len(places) - 1} more places)" if len(places) > 1 else ""
    return f"{places[0]}{more}: {text}" if places else text
