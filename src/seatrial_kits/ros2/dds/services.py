"""Services over DDS, as rmw_cyclonedds has them: two topics, and a header that tells the call."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any

from ..messages.definitions import service_parts
from ..messages.packing import packed
from ..transport import Call, Handler
from .participant import Participant

_MOST = 10
"""Calls of one service that are answered at once; more wait."""


class DdsService:
    """A service ``name`` of the type ``kind``; ``handler`` answers each call."""

    def __init__(self, participant: Participant, name: str, kind: str, handler: Handler) -> None:
        asked, self._answered = service_parts(kind)
        self._reader = participant.reader(f"{name}Request", asked, prefix="rq")
        self._writer = participant.writer(f"{name}Reply", self._answered, prefix="rr")
        self._handler = handler

    def serve(self) -> None:
        """Answer the calls that have come; what is no request is dropped."""
        for request, _ in self._reader.take(_MOST):
            if request is not None:
                self._handler(Call(request, self._answering(request)))

    def _answering(self, request: Any) -> Callable[[Mapping[str, Any]], None]:
        header = {
            "client_guid": request.client_guid,
            "sequence_number": request.sequence_number,
        }

        def answer(fields: Mapping[str, Any]) -> None:
            self._writer.write(packed(self._answered, {**header, **fields}))

        return answer
