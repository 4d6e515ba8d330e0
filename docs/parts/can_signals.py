"""Messages that DBC files describe: ports of the component, and the shipped files."""

from __future__ import annotations

from functools import partial

import cantools

from parts import part
from parts.can import ports
from parts.markdown import table
from seatrial.shipped import provided_folders
from seatrial_kits.can.signals.component import CanSignals

part("can-signals-ports")(partial(ports, CanSignals))


@part("can-signals-messages")
def messages() -> str:
    """Messages of the shipped DBC files."""
    rows = []
    for path in sorted(
        path for folder in provided_folders("hil_profiles") for path in folder.glob("*.dbc")
    ):
        for message in cantools.database.load_file(path).messages:
            signals = ", ".join(
                f"`{s.name}` {s.minimum:g} to {s.maximum:g} {s.unit} by {s.scale:g}"
                for s in message.signals
            )
            rows.append(
                (
                    f"`{path.name}`",
                    f"`{message.name}`",
                    f"0x{message.frame_id:03X}",
                    ", ".join(message.senders),
                    f"{message.cycle_time}",
                    signals,
                )
            )
    return table(("file", "message", "identifier", "sender", "cycle, ms", "signals"), rows)
