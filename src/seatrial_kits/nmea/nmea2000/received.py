"""Values received over NMEA 2000: by quantity, with source and time of expiry."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from seatrial.model.component import NS

from .catalogue import DATA
from .codec import Message
from .quantities import READERS, Values

_INTERVALS = 3
"""Intervals of a PGN for which a value is valid at least."""

_FAR_NS = 1 << 62

HELM = ("heading_to_steer", "track", "steering_mode")
"""Quantities that are orders to who steers: the newest one counts, whoever gave it."""


class Received:
    """Values by quantity; ``memory`` is a dict of plain data, the caller's.

    Of several nodes that send the same quantity the first that was received is used, until it
    sends 'not available', or nothing in time; then the next. A value is valid for
    ``timeout_ns``, and for three standard intervals of its PGN at least.

    **The helm.** Of `HELM`, a new order takes the helm from any other node: a command, a node's
    first order, or one that differs from its last. What a node repeats keeps its own order valid
    and takes nothing. A command stands until there is a newer order, of any age.
    """

    def __init__(self, memory: dict[str, Any], timeout_ns: int, rudder_instance: int) -> None:
        self._memory = memory
        self._timeout_ns, self._rudder_instance = timeout_ns, rudder_instance

    def take(self, when_ns: int, message: Message) -> list[str]:
        """Take in a message; return the quantities that it changed."""
        changed = []
        for name, values in self._read(message).items():
            known: dict[str, Any] = self._memory.get(name, {})
            own = known.get("source") == message.source and not known["commanded"]
            new = name in HELM and self._is_new(known, values, message.source)
            if values is None:
                if own:
                    known["until"] = -1
                    changed.append(name)
            elif own or new or not self._valid(known, when_ns):
                self._enter(name, values, self._until(when_ns, message.pgn), message.source)
                changed.append(name)
        return changed

    def command(
        self, when_ns: int, message: Message, wanted: Sequence[str]
    ) -> tuple[list[str], list[str]]:
        """Carry out a command for some quantities of a message.

        Returns those that it changed, and those that it did not because another node sends them;
        the rest has no value that it could have.
        """
        changed, held, found = [], [], self._read(message)
        for name in wanted:
            values, known = found.get(name), self._memory.get(name, {})
            if values is None:
                continue
            if name in HELM:
                until_ns = _FAR_NS
            elif self._valid(known, when_ns) and known["source"] != message.source:
                held.append(name)
                continue
            else:
                until_ns = self._until(when_ns, message.pgn)
            self._enter(name, values, until_ns, message.source, commanded=True)
            changed.append(name)
        return changed, held

    def names(self) -> list[str]:
        """Return the quantities that have been received of."""
        return list(self._memory)

    def get(self, name: str, now_ns: int) -> tuple[list[float] | None, bool]:
        """Return the last values of a quantity, None if there were none, and whether they count."""
        known = self._memory.get(name)
        if known is None:
            return None, False
        return known["values"], self._valid(known, now_ns)

    def expires(self, now_ns: int) -> int:
        """Return when the next valid value expires, ns; far ahead if none does."""
        ends = [known["until"] for known in self._memory.values()]
        return min((until + 1 for until in ends if until >= now_ns), default=_FAR_NS)

    def _read(self, message: Message) -> Values:
        """Return what a message says of quantities that are read here."""
        reader = READERS.get(message.pgn)
        instance = message.fields.get("instance")
        if reader is None or (
            message.pgn == 127245 and instance not in (self._rudder_instance, None)
        ):
            return {}
        return reader(message.fields)

    def _enter(
        self,
        name: str,
        values: tuple[float, ...],
        until_ns: int,
        source: int,
        commanded: bool = False,
    ) -> None:
        entry = self._memory.setdefault(name, {"orders": {}})
        entry |= {"values": list(values), "until": until_ns, "source": source}
        entry["commanded"] = commanded
        if name in HELM and not commanded:
            entry["orders"][str(source)] = list(values)

    @staticmethod
    def _is_new(known: dict[str, Any], values: tuple[float, ...] | None, source: int) -> bool:
        """Return whether a node ordered something else before, or nothing; remember it."""
        key, orders = str(source), known.get("orders", {})
        before = orders.pop(key, None)
        if values is None:
            return False
        orders[key] = list(values)
        return bool(orders[key] != before)

    def _until(self, when_ns: int, pgn: int) -> int:
        interval_ns = round(DATA[pgn].interval_s * NS)
        return when_ns + max(self._timeout_ns, _INTERVALS * interval_ns)

    @staticmethod
    def _valid(known: dict[str, Any], now_ns: int) -> bool:
        return bool(known.get("until", -1) >= now_ns)
