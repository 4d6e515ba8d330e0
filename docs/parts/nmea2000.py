"""NMEA 2000: messages, fields and ports of the node."""

from __future__ import annotations

from nmea2000.backend import DATABASE
from nmea2000.native_units import NATIVE_UNITS

from parts import part
from parts.can import ports
from parts.markdown import shown_number, table
from seatrial_kits.nmea.nmea2000.catalogue import DATA, READABLE, RECEIVED, Pgn
from seatrial_kits.nmea.nmea2000.codec import is_fast
from seatrial_kits.nmea.nmea2000.component import Nmea2000
from seatrial_kits.nmea.nmea2000.ports import NOT_CONNECTED


def _field(pgn: Pgn, name: str) -> tuple[str, str]:
    """Return resolution and unit of a field on the bus."""
    native = NATIVE_UNITS.get((pgn.id, name))
    if native is not None:
        return shown_number(native[1] or 1.0), native[0]
    known = next(f for f in DATABASE.pgn_variants(pgn.number)[0].fields if f.id == name)
    if known.field_type != "NUMBER" and known.field_type != "TIME":
        return "", ""
    return shown_number(known.resolution), known.unit or ""


@part("nmea2000-messages")
def messages() -> str:
    """Return the messages: number, name, interval, priority, kind of packet, who sends it."""
    rows = [
        (
            str(pgn.number),
            pgn.title,
            f"{shown_number(pgn.interval_s)} s" if pgn.interval_s else "when it is received",
            str(pgn.priority),
            "fast packet" if is_fast(pgn.number) else "one frame",
            " and ".join(
                way for way, known in (("sent", DATA), ("read", RECEIVED)) if pgn.number in known
            ),
        )
        for pgn in READABLE.values()
    ]
    return table(("PGN", "message", "interval", "priority", "goes as", "a node has it"), rows)


@part("nmea2000-fields")
def fields() -> str:
    """Return the fields: where they come from and go to, resolution, unit, sense."""
    rows = []
    for pgn in READABLE.values():
        for each in pgn.fields:
            if each.name == "sid":
                continue
            resolution, unit = _field(pgn, each.name)
            sent = f"`{each.sent}`" if each.sent else ""
            received = f"`{each.received}`" if each.received else ""
            name = f"`{each.name}`"
            rows.append((str(pgn.number), name, sent, received, resolution, unit, each.sense))
    return table(("PGN", "field", "from", "to", "resolution", "unit", "sense"), rows)


@part("nmea2000-ports")
def node_ports() -> str:
    """Return the node's ports."""
    return ports(Nmea2000).replace(f"{NOT_CONNECTED:g}", "not connected")
