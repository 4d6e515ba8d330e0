"""Bus log of a run: logs and statistics in the run's folder."""

from __future__ import annotations

import json
from pathlib import Path

from seatrial.errors import SimulationError

from .bus_log import BusLog
from .simulated_bus import PS, Broken, Sent, SimulatedBus
from .statistics import Statistics

_PS_PER_NS = 1000


class RunLog:
    """The logs of `BusLog`, and at the end ``NAME.json`` (`Statistics`); nothing without a folder.

    Each attempt to send is entered once: a step that is repeated after a rollback brings the
    same frames again.
    """

    def __init__(self, name: str) -> None:
        self._name = name
        self._folder: Path | None = None
        self._log: BusLog | None = None
        self._statistics = Statistics()
        self._entered = 0

    def open(self, folder: str) -> None:
        """Begin the files in ``folder``, once; an empty text is none."""
        if folder and self._log is None:
            self._folder = Path(folder)
            self._log = BusLog(self._folder, self._name)

    def sent(self, attempt: int, sent: Sent, latency_ps: int) -> None:
        """Enter a frame."""
        if self._log is not None and attempt > self._entered:
            self._entered = attempt
            self._log.frame(-(-sent.end_ps // _PS_PER_NS), sent.frame)
            self._statistics.sent(sent.frame, latency_ps)

    def broken(self, attempt: int, broken: Broken) -> None:
        """Enter an error frame."""
        if self._log is not None and attempt > self._entered:
            self._entered = attempt
            self._log.error(-(-broken.end_ps // _PS_PER_NS), broken.error)
            self._statistics.broken(broken.error.name.lower())

    def close(self, bus: SimulatedBus, begun_ps: int) -> None:
        """Write what is left, and the statistics; a new one may be opened."""
        if self._log is None or self._folder is None:
            return
        log, self._log = self._log, None
        log.close()
        duration = (bus.now_ps - begun_ps) / PS
        found = self._statistics.summary(duration, bus.busy_ps / PS, bus.controllers)
        path = self._folder / f"{self._name}.json"
        try:
            with path.open("x", encoding="utf-8", newline="\n") as file:
                file.write(json.dumps(found, indent=1) + "\n")
        except OSError as error:
            raise SimulationError(f"cannot write {path}: {error.strerror}") from None
