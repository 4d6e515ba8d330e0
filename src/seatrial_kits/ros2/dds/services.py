"""Services over DDS, as rmw_cyclonedds has them: two topics, and a header that tells the call."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any

from .definitions import service_parts
from .packing import packed
from .participant import Participant, Writer

_MOST = 10
"""Calls of one service that are answered at once; more wait."""


@dataclass(frozen=True)
class Call:
    """One call of a service, to be answered once, now or later."""

    request: Any
    answer: Callable[[Mapping[str, Any]], None]


Handler = Callable[[Call], None]


class Service:
    """A service ``name`` of the type ``kind``; ``handler`` answers each call."""

    def __init__(self, participant: Participant, name: str, kind: str, handler: Handler) -> None:
        asked, self._answered = service_parts(kind)
        self._reader = participant.reader(f"{name}Request", asked, prefix="rq")
        self._writer = Writer(participant, f"{name}Reply", self._answered, prefix="rr")
        self._handler = handler

    def serve(self) -> None:
        """Answer the calls that have come; what is no request is dropped."""
        for sample in self._reader.take(_MOST):
            if sample.sample_info.valid_data and sample.message is not None:
                self._handler(Call(sample.message, self._answering(sample.message)))

    def _answering(self, request: Any) -> Callable[[Mapping[str, Any]], None]:
        header = {
            "client_guid": request.client_guid,
            "sequence_number": request.sequence_number,
        }

        def answer(fields: Mapping[str, Any]) -> None:
            self._writer.write(packed(self._answered, {**header, **fields}))

        return answer
