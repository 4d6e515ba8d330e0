"""Services of a node of rclpy."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any

from ..messages.definitions import service_parts
from ..messages.packing import packed
from ..transport import Call, Handler
from .types import interface

_MOST = 10
"""Calls of one service that are answered at once; more wait."""
_ENCAPSULATION, _HEADER = 4, 16
"""Bytes before a message, and of the header that answers have in DDS alone."""


class RclpyService:
    """A service ``name`` of the type ``kind``; ``handler`` answers each call."""

    def __init__(self, node: Any, name: str, kind: str, handler: Handler) -> None:
        self._type, self._handler = interface(kind), handler
        _, self._answered = service_parts(kind)
        self._service = node.create_service(self._type, name, lambda _, response: response)

    def serve(self) -> None:
        """Answer the calls that have come."""
        handle = self._service.handle
        for _ in range(_MOST):
            with handle:
                request, header = handle.service_take_request(self._type.Request)
            if header is None:
                return
            self._handler(Call(request, self._answering(header)))

    def _answering(self, header: Any) -> Callable[[Mapping[str, Any]], None]:
        from rclpy.serialization import deserialize_message

        def answer(fields: Mapping[str, Any]) -> None:
            data = packed(self._answered, fields)
            plain = data[:_ENCAPSULATION] + data[_ENCAPSULATION + _HEADER :]
            response = deserialize_message(plain, self._type.Response)
            self._service.send_response(response, header)

        return answer
