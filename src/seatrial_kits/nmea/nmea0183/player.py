"""Player of recorded sentences, AIS' among them."""

from __future__ import annotations

from collections import Counter
from functools import reduce
from operator import xor
from pathlib import Path
from typing import Any, ClassVar

import numpy as np

from seatrial.errors import InputError
from seatrial.links.clock_jumps import usual_step
from seatrial.links.text import Outbox
from seatrial.model.component import Output, Parameter, terminal
from seatrial_kits.can.playing import Player, Recording

from .log_fields import SENTENCE
from .log_reader import past_midnight, stamp, time_of_day


class Nmea0183Player(Player):
    """Sends recorded sentences at their times; see `Player`.

    ``file`` has one sentence in a line, with or without a time before it (UNIX time in s or ms, ISO
    8601, a time of day, a TAG block). Without, the sentences that follow one with a time of day
    (RMC, GGA, GLL, GNS, ZDA) are spread evenly to the next. Sentences from ``$`` go to ``tx``, as a
    talker's, those from ``!``, AIS', to ``ais``; both with carriage return and line feed.
    ``sentences`` takes those alone whose address begins so, ``GPRMC HE !AI``; ``leave_out`` leaves
    out. Lines without a sentence of good checksum are skipped.
    """

    sentences = Parameter("", "1", "beginnings of what is played, separated by spaces; empty: all")
    leave_out = Parameter("", "1", "beginnings of what is not played")

    tx = Output("1", "sentences of talkers, as text", type=str, role="bytes")
    ais = Output("1", "sentences of AIS, as text", type=str, role="bytes")

    terminals: ClassVar = {"serial": terminal(down="tx")}

    def start(self, t: float) -> None:
        """Read the file."""
        self._tx: dict[str, Any] = {}
        self._ais: dict[str, Any] = {}
        super().start(t)

    def outputs(self, t: float) -> None:
        """Publish what is sent, and the counts."""
        super().outputs(t)
        self.tx, self.ais = Outbox(self._tx).text, Outbox(self._ais).text

    def put(self, time_ns: int, entry: bytes) -> None:
        """Send a sentence."""
        Outbox(self._ais if entry.startswith(b"!") else self._tx).put(time_ns, entry + b"\r\n")

    def flush(self) -> None:
        """Publish what was sent."""
        Outbox(self._tx).flush()
        Outbox(self._ais).flush()

    def recording(self, path: Path) -> Recording:
        """Return the sentences of a file. Raises InputError if none is left."""
        skipped: Counter[str] = Counter()
        sentences, stamps, own = [], [], []
        with path.open(encoding="latin-1") as file:
            for line in file:
                match = SENTENCE.search(line)
                if match is None or not _has_checksum(match[0]):
                    skipped["lines without a sentence of good checksum"] += bool(line.strip())
                    continue
                sentences.append(match[0])
                stamps.append(stamp(line[: match.start()]))
                own.append(time_of_day(match[0]))
        kept = [place for place, text in enumerate(sentences) if self._is_played(text)]
        if sentences and not kept:
            kinds = sorted({text[:6] for text in sentences})
            raise InputError(f"{path}: no sentence is left to be played; it has {', '.join(kinds)}")
        times = _times(stamps, own)
        chosen = None if times is None else [times[place] for place in kept]
        return Recording(chosen, [sentences[place].encode() for place in kept], skipped)

    def _is_played(self, text: str) -> bool:
        wanted, others = self.sentences.split(), self.leave_out.split()
        names = (text, text[1:])
        return (not wanted or any(n.startswith(w) for n in names for w in wanted)) and not any(
            name.startswith(other) for name in names for other in others
        )


def _has_checksum(sentence: str) -> bool:
    body, _, check = sentence[1:].partition("*")
    return f"{reduce(xor, body.encode('latin-1'), 0):02X}" == check.upper()


def _times(stamps: list[float | None], own: list[float | None]) -> list[float] | None:
    """Return the time of each sentence, s; None where nothing says any."""
    if stamps and None not in stamps:
        before: list[float] = past_midnight([each or 0.0 for each in stamps]).tolist()
        return before
    placed = [(place, each) for place, each in enumerate(own) if each is not None]
    if not placed:
        return None
    seconds = past_midnight([each for _, each in placed])
    rising = np.flatnonzero(np.append(True, np.diff(seconds) > 0.0))
    places, epochs = np.array([placed[i][0] for i in rising], float), seconds[rising]
    usual = usual_step(epochs) or 1.0
    # Sentences before the first time are of the epoch before, those after the last of its own.
    count = float(len(own))
    ends = [epochs[-1] + usual * min((count - places[-1]) / max(_per_epoch(places), 1.0), 1.0)]
    first = [epochs[0] - usual * min(places[0] / max(_per_epoch(places), 1.0), 1.0)]
    knots = np.concatenate(([0.0] if places[0] > 0.0 else [], places, [count]))
    at = np.concatenate((first if places[0] > 0.0 else [], epochs, ends))
    found: list[float] = np.interp(np.arange(len(own)), knots, at).tolist()
    return found


def _per_epoch(places: Any) -> float:
    return float(np.median(np.diff(places))) if len(places) > 1 else 1.0
