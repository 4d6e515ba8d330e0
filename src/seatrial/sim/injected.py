"""Faults that act on one scalar, one after the other, and what they remember."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any

from ..model.faults.operators import Moment, Operator
from .streams import Stream


@dataclass
class Acting:
    """A fault that acts on one scalar since ``begun_ns``, growing for ``grows_ns``."""

    key: str
    """Of the fault: what ends it."""
    operator: Operator
    begun_ns: int
    grows_ns: int = 0
    memory: Any = None
    seen: tuple[int, Any] | None = None
    """Time and value of the last look; what came of earlier ones is in ``memory``."""
    ended_ns: int | None = None
    """Of a stream: nothing that is sent from then on goes wrong; its texts are numbered anew."""

    def value(self, t_ns: int, x: Any) -> Any:
        """Return what becomes of ``x`` at ``t_ns``; a second look at a time replaces the first."""
        if self.seen is None:
            self.memory = self.operator.first(x, self._moment(t_ns))
        elif t_ns > self.seen[0]:
            then, before = self.seen
            self.memory = self.operator.after(self.memory, before, self._moment(then), t_ns - then)
        self.seen = (t_ns, x)
        return self.operator.value(self.memory, x, self._moment(t_ns))

    def _moment(self, t_ns: int) -> Moment:
        return Moment(t_ns, self.begun_ns, self.grows_ns, self.ended_ns)


@dataclass
class Injected:
    """All faults of one scalar, in the order in which they began."""

    acting: list[Acting] = field(default_factory=list)

    def value(self, t_ns: int, x: Any) -> Any:
        """Return what its readers get for its own value ``x``, of the same type."""
        kind = type(x)
        for one in self.acting:
            x = one.value(t_ns, x)
        if kind is int and isinstance(x, float):
            return round(x)
        return x if type(x) is kind else kind(x)

    def end(self, key: str, t_ns: int) -> None:
        """End the fault ``key``; a stream stays: its numbers go on."""
        kept = []
        for one in self.acting:
            if one.key == key and one.ended_ns is None:
                one.ended_ns = t_ns
            if one.ended_ns is None or isinstance(one.operator, Stream):
                kept.append(one)
        self.acting = kept

    def restarted(self, own: Any) -> None:
        """Let streams go on whose sender starts anew with the text ``own``; or their reader.

        ``own`` is None for the reader.
        """
        for one in self.acting:
            if isinstance(one.operator, Stream) and one.seen is not None:
                t_ns, x = one.seen
                one.memory = one.operator.restarted(one.memory, own)
                one.seen = (t_ns, x if own is None else own)

    def save(self) -> Any:
        """Return all that changes, for `restore`."""
        return [(one, one.memory, one.seen, one.ended_ns) for one in self.acting]

    def restore(self, state: Any) -> None:
        """Restore what `save` returned."""
        self.acting = [one for one, *_ in state]
        for one, memory, seen, ended_ns in state:
            one.memory, one.seen, one.ended_ns = memory, seen, ended_ns
