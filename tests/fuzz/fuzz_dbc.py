"""DBC files, and nodes whose messages they describe."""

from __future__ import annotations

import contextlib
import math
import tempfile
from pathlib import Path

from seatrial.errors import InputError
from seatrial_kits.can.frame import Frame
from seatrial_kits.can.node import CanNode
from seatrial_kits.can.signals.component import SIGNALS, CanSignals
from seatrial_kits.can.signals.database import database_of

VALUES = (0.0, 1.0, -1e300, 1e300)


def one(data: bytes) -> None:
    """Read a DBC; each of its first messages is sent, and received from zeros and ones."""
    try:
        database = database_of(data, "x")
    except InputError:
        return
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder, "x.dbc")
        path.write_bytes(data)
        for message in database.messages[:3]:
            names = [f"{message.name}.{signal.name}" for signal in message.signals[:SIGNALS]]
            for way in ("sends", "receives"):
                with contextlib.suppress(InputError):
                    _run(path, way, "; ".join(names), message)


def _run(path: Path, way: str, names: str, message: object) -> None:
    node = CanSignals("node")
    for name, value in (("database", str(path)), (way, names), ("cycle_time", 0.01)):
        node.set(name, value)
    node.initialise()
    node.begin()
    peer: dict = {}
    for k, value in enumerate(VALUES):
        node.set("send", [value] * SIGNALS)
        if way == "receives" and message.length <= 8:  # type: ignore[attr-defined]
            content = (b"\0", b"\xff", b"\x01", b"\x80")[k] * message.length  # type: ignore[attr-defined]
            frame = Frame(message.frame_id, content, message.is_extended_frame)  # type: ignore[attr-defined]
            bus = CanNode(peer)
            bus.send(k * 10_000_000, frame)
            node.set("rx", bus.flush())
        node.advance(0.01 * k, 0.01)
        assert not any(math.isinf(v) for v in node.get("received")[: names.count(";") + 1])
        assert node.get("frames_sent") <= 1000
