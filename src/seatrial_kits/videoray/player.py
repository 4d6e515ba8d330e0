"""Player of a recorded stream into a simulation."""

from __future__ import annotations

from pathlib import Path
from typing import Any, ClassVar

from seatrial.links.text import Outbox
from seatrial.model.component import NS, Component, Output, Parameter, terminal

from .stream_file import FROM_DEVICE, TO_DEVICE, read_stream


class StreamPlayer(Component):
    """Sends what was recorded one way, at the recorded times.

    ``file`` is a stream (`stream_file`); ``direction`` is
    to-device, to stand for the topside, or from-device, to stand for the vehicle. In the step
    from t to t + h it puts on ``tx`` what began from t to before t + h, as the recorded one did:
    with the same rig around it and the same step, the run is the same.

    Raises InputError at the start for a file that is none.
    """

    discrete = True
    transient = Component.transient | {"_pieces"}

    file = Parameter("", "1", "recorded stream; empty: nothing is played", role="file")
    direction = Parameter(
        "to-device", "1", "which way is played", choices=("to-device", "from-device")
    )

    tx = Output("1", "bytes sent", type=str, role="bytes")
    played = Output("1", "pieces played", type=int)

    terminals: ClassVar = {"serial": terminal(down="tx")}

    def start(self, t: float) -> None:
        """Read the file."""
        wanted = TO_DEVICE if self.direction == "to-device" else FROM_DEVICE
        pieces = read_stream(Path(self.file)) if self.file else ()
        self._pieces = [p for p in pieces if p.direction == wanted and p.time_ns >= self.now_ns]
        self._played = 0
        self._tx: dict[str, Any] = {}

    def step(self, t: float, h: float) -> None:
        """Send what is due."""
        end = self.now_ns + round(h * NS)
        box = Outbox(self._tx)
        while self._played < len(self._pieces) and self._pieces[self._played].time_ns < end:
            piece = self._pieces[self._played]
            box.put(piece.time_ns, piece.data)
            self._played += 1
        box.flush()

    def outputs(self, t: float) -> None:
        """Publish what is sent."""
        self.tx, self.played = Outbox(self._tx).text, self._played
