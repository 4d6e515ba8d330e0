"""Values received over NMEA: by quantity, with source, priority and time of expiry."""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence
from typing import Any

from seatrial.errors import InputError, unknown

_FAR_NS = 1 << 62
_INTERVALS = 3
"""Intervals of a sender for which a value is valid at least."""
_SLOWEST_NS = 5_000_000_000
"""Senders with longer intervals have the standard's."""

_MOST_KINDS = 200
"""Kinds of messages that are counted by themselves."""

HELM = ("heading_to_steer", "track", "steering_mode")
"""Quantities that are orders to who steers: the newest one counts, whoever gave it."""

Values = dict[str, tuple[float, ...] | None]
"""By quantity; None for one that is not available."""


class Received:
    """Values by quantity; ``memory`` is a dict of plain data, the caller's.

    Each quantity has a source, an age and a validity of its own. Of several sources that send the
    same quantity the first that was received is used, until it sends 'not available', or nothing in
    time; then the next. ``preferred`` has the sources, the best first, of quantities where another
    order holds: a better source takes over at its first value. A value is valid for ``timeout_ns``,
    and for three intervals of its sender at least, standard or as they were received.

    **The helm.** Of `HELM`, a new order takes the helm from any other node: a command, a node's
    first order, or one that differs from its last. What a node repeats keeps its own order valid
    and takes nothing. A command stands until there is a newer order, of any age.
    """

    def __init__(
        self,
        memory: dict[str, Any],
        timeout_ns: int,
        preferred: Mapping[str, Sequence[str]] | None = None,
    ) -> None:
        self._memory, self._timeout_ns = memory, timeout_ns
        self._preferred = preferred or {}

    def take(
        self,
        when_ns: int,
        source: str,
        kind: str,
        read: Values,
        least_ns: int = 0,
        late: Collection[str] = (),
    ) -> list[str]:
        """Take in the values of one message of a ``kind``; return the quantities that changed.

        ``least_ns`` is the shortest validity of its kind. Quantities in ``late`` are used only
        where no message that is about them is valid.
        """
        changed = []
        for name, values in read.items():
            known: dict[str, Any] = self._memory.get(name, {})
            rank = [self._rank(name, source), int(name in late)]
            own = known.get("source") == source and not known["commanded"]
            new = name in HELM and self._is_new(known, values, source)
            if values is None:
                if own and known["kind"] == kind and known["until"] >= when_ns:
                    known["until"] = -1
                    changed.append(name)
            elif (
                new
                or (own and (name in HELM or rank <= known["rank"]))
                or not self._valid(known, when_ns)
                or (name not in HELM and rank < known["rank"])
            ):
                gap_ns = when_ns - known["when"] if known.get("source") == source else 0
                lasts_ns = max(self._timeout_ns, least_ns, self._rhythm(known, gap_ns))
                entry = self._enter(name, values, when_ns, source, kind)
                entry |= {"until": when_ns + lasts_ns, "rank": rank, "gap": gap_ns}
                if name in HELM:
                    entry["orders"][source] = list(values)
                changed.append(name)
        return changed

    def command(
        self,
        when_ns: int,
        source: str,
        kind: str,
        read: Values,
        wanted: Sequence[str],
        least_ns: int = 0,
    ) -> tuple[list[str], list[str]]:
        """Carry out a command for some quantities of a message.

        Returns those that it changed, and those that it did not because another node sends them;
        the rest has no value that it could have.
        """
        changed, held = [], []
        for name in wanted:
            values, known = read.get(name), self._memory.get(name, {})
            if values is None:
                continue
            if name not in HELM and self._valid(known, when_ns) and known["source"] != source:
                held.append(name)
                continue
            until_ns = _FAR_NS if name in HELM else when_ns + max(self._timeout_ns, least_ns)
            entry = self._enter(name, values, when_ns, source, kind)
            entry |= {"until": until_ns, "rank": [self._rank(name, source), 0], "commanded": True}
            changed.append(name)
        return changed, held

    def names(self) -> list[str]:
        """Return the quantities that have been received of."""
        return list(self._memory)

    def get(self, name: str, now_ns: int) -> tuple[list[float] | None, bool]:
        """Return the last values of a quantity, None without any, and whether they are valid."""
        known = self._memory.get(name)
        if known is None:
            return None, False
        return known["values"], self._valid(known, now_ns)

    def valid(self, name: str, now_ns: int) -> list[float] | None:
        """Return the values of a quantity, None if they are not valid."""
        values, valid = self.get(name, now_ns)
        return values if valid else None

    def origin(self, name: str) -> tuple[str, str]:
        """Return source and kind of message of a quantity that has been received."""
        known = self._memory[name]
        return known["source"], known["kind"]

    def since(self, name: str) -> int:
        """Return when a quantity was received last, ns."""
        when: int = self._memory[name]["when"]
        return when

    def rank(self, name: str) -> list[int]:
        """Return the priority of a quantity's source: the lower the better."""
        rank: list[int] = self._memory[name]["rank"]
        return rank

    def expires(self, now_ns: int) -> int:
        """Return when the next valid value expires, ns; far ahead if none does."""
        ends = [known["until"] for known in self._memory.values()]
        return min((until + 1 for until in ends if until >= now_ns), default=_FAR_NS)

    def sources(self, now_ns: int) -> str:
        """Return ``QUANTITY SOURCE; ...`` of what is valid, in order of the names."""
        valid = (name for name, known in self._memory.items() if self._valid(known, now_ns))
        return "; ".join(f"{name} {self._memory[name]['source']}" for name in sorted(valid))

    def _rank(self, name: str, source: str) -> int:
        order = self._preferred.get(name.removeprefix("magnetic_").split(" ")[0], ())
        return order.index(source) if source in order else len(order)

    @staticmethod
    def _rhythm(known: dict[str, Any], gap_ns: int) -> int:
        """Return how long a value of a sender is valid by its last two intervals, ns."""
        shortest = min(gap_ns, known.get("gap", 0))
        return 0 if shortest > _SLOWEST_NS else _INTERVALS * shortest

    def _enter(
        self, name: str, values: tuple[float, ...], when_ns: int, source: str, kind: str
    ) -> dict[str, Any]:
        entry: dict[str, Any] = self._memory.setdefault(name, {"orders": {}})
        entry |= {"values": list(values), "when": when_ns, "source": source, "kind": kind}
        entry |= {"commanded": False, "gap": 0}
        return entry

    @staticmethod
    def _is_new(known: dict[str, Any], values: tuple[float, ...] | None, source: str) -> bool:
        """Return whether a node ordered something else before, or nothing; remember it."""
        orders = known.get("orders", {})
        before = orders.pop(source, None)
        if values is None:
            return False
        orders[source] = list(values)
        return bool(orders[source] != before)

    @staticmethod
    def _valid(known: dict[str, Any], now_ns: int) -> bool:
        return bool(known.get("until", -1) >= now_ns)


def count(counts: dict[str, int], kind: str) -> None:
    """Count a message of a kind that is not read; noise has many kinds, the rest are one."""
    key = kind if kind in counts or len(counts) < _MOST_KINDS else "rest"
    counts[key] = counts.get(key, 0) + 1


def preferred_sources(text: str, quantities: Collection[str]) -> dict[str, list[str]]:
    """Return the sources of ``QUANTITY SOURCE SOURCE; ...``, the best first, by quantity.

    Raises InputError for a quantity that is not known (near misses) or named twice, and for one
    without a source.
    """
    found: dict[str, list[str]] = {}
    for part in filter(None, map(str.strip, text.split(";"))):
        name, *sources = part.split()
        if name not in quantities:
            raise InputError(f"prefer: {unknown('quantity', name, quantities)}")
        if name in found:
            raise InputError(f"prefer: {name} is there twice")
        if not sources:
            raise InputError(f"prefer: {name} has no source; QUANTITY SOURCE, the best first")
        found[name] = sources
    return found
