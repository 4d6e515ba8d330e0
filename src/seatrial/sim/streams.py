"""Faults of streams: bytes or frames in text ports, chunk by chunk (`links.text`)."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, NamedTuple

from ..errors import InputError, SimulationError
from ..links import text
from ..model.faults.operators import Draw, Moment, Operator


class _Memory(NamedTuple):
    """What a stream has come to."""

    source: int
    """Number of the last text that came."""
    number: int
    """Number of the last text that went on."""
    shown: str
    came: int
    """Chunks that came since the fault began."""
    last_ns: int
    """When the last one, in order, is due."""
    waiting: tuple[tuple[int, int, bytes], ...]
    """(when due, its place in the order, bytes) of chunks that came and did not go on."""


@dataclass(frozen=True)
class Stream(Operator):
    """Chunk k, sent at t_k while the fault acts, goes on at t_k + s (time + jitter u_k).

    Chunks keep their order. With probability s loss it does not; with s duplicate it comes
    twice; with s reorder it comes ``held_ns`` later, out of order; each of its bits is wrong with
    probability s bit_errors. The u of chunk k are uniform in [0, 1) and drawn for it alone,
    whatever goes wrong. Texts are numbered anew, also when the fault has ended.
    """

    draw: Draw
    loss: float = 0.0
    time_ns: int = 0
    jitter_ns: int = 0
    reorder: float = 0.0
    held_ns: int = 0
    duplicate: float = 0.0
    bit_errors: float = 0.0

    def first(self, x: Any, moment: Moment) -> Any:
        """Return a stream whose text so far has been read, but for chunks of since the begin."""
        number, chunks = _decoded(x)
        if any(sent_ns >= moment.begun_ns for sent_ns, _ in chunks):
            return _Memory(number - 1, number - 1, text.encode(number - 1, []), 0, 0, ())
        return _Memory(number, number, x, 0, 0, ())

    def after(self, memory: Any, x: Any, moment: Moment, h_ns: int) -> Any:
        """Return what the stream has come to."""
        return self._taken(memory, x, moment)

    def value(self, memory: Any, x: Any, moment: Moment) -> Any:
        """Return the text that goes on."""
        return self._taken(memory, x, moment).shown

    @staticmethod
    def restarted(memory: Any, own: str | None) -> Any:
        """Return the memory after the sender has started anew, with the text ``own``.

        None: the reader has.
        """
        if own is None:
            return memory._replace(number=0, shown="")
        return memory._replace(source=_decoded(own)[0])

    def _taken(self, memory: _Memory, x: str, moment: Moment) -> _Memory:
        source, count, last = memory.source, memory.came, memory.last_ns
        waiting = list(memory.waiting)
        number, chunks = _decoded(x)
        if number != source:
            if number != source + 1:
                raise SimulationError(f"a stream's text number {number} came after {source}")
            for sent_ns, data in chunks:
                share = moment.share_at(sent_ns)
                arrivals, last = self._arrivals(sent_ns, data, count, last, share)
                waiting += [(due, count, found) for due, found in arrivals]
                count += 1
        due = sorted((one for one in waiting if one[0] <= moment.t_ns), key=lambda one: one[:2])
        waiting = [one for one in waiting if one[0] > moment.t_ns]
        if not due:
            return memory._replace(source=number, came=count, last_ns=last, waiting=tuple(waiting))
        shown = text.encode(memory.number + 1, [(when, data) for when, _, data in due])
        return _Memory(number, memory.number + 1, shown, count, last, tuple(waiting))

    def _arrivals(
        self, sent_ns: int, data: bytes, count: int, last_ns: int, share: float
    ) -> tuple[list[tuple[int, bytes]], int]:
        """Return (when due, bytes) of a chunk's arrivals, and when the last in order is due."""
        if share == 0.0:
            return [(max(sent_ns, last_ns), data)], max(sent_ns, last_ns)
        generator = self.draw(count)
        lost, late, held, twice = generator.random(4).tolist()
        due = max(sent_ns + round(share * (self.time_ns + late * self.jitter_ns)), last_ns)
        if lost < share * self.loss:
            return [], last_ns
        if self.bit_errors:
            wrong = generator.random(8 * len(data)) < share * self.bit_errors
            flipped = sum(1 << int(bit) for bit in wrong.nonzero()[0])
            data = (int.from_bytes(data, "little") ^ flipped).to_bytes(len(data), "little")
        copies = 2 if twice < share * self.duplicate else 1
        if held < share * self.reorder:
            return [(due + self.held_ns, data)] * copies, last_ns
        return [(due, data)] * copies, due


def is_stream(value: Any) -> bool:
    """Say if a text may be that of a stream; an empty one may."""
    try:
        text.decode(value)
    except InputError:
        return False
    return True


def _decoded(value: str) -> tuple[int, list[text.Chunk]]:
    try:
        return text.decode(value)
    except InputError as error:
        raise SimulationError(f"no stream to disturb: {error}") from None
