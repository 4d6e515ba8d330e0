"""Access to the page and its websocket, and a viewer's messages on their way to viser.

Whoever runs as somebody else on this machine, or serves a page that a viewer's browser opens, can
send requests to the port. So a request needs the token, in the address once and in a cookie from
then on; the host must be this machine by an address or ``localhost`` (a name that somebody else's
DNS gives to 127.0.0.1 is none), and the origin, where a browser names one, this page's own.
"""

from __future__ import annotations

import asyncio
import http
import logging
import math
import re
import secrets
from collections import Counter
from collections.abc import Awaitable, Callable, Iterator
from typing import Any, get_type_hints
from urllib.parse import unquote

import msgspec
import viser
from viser import _messages as messages
from websockets import Headers
from websockets.http11 import Request, Response

_HOST = re.compile(r"(127\.0\.0\.1|localhost|\[::1\])(:\d{1,5})?")
_MOST_JUNK = 100
"""Messages of a viewer that do not fit, after which the connection is closed."""
_HELP = (
    '<!doctype html><meta charset="utf-8"><title>seatrial</title>'
    "<p>This page needs the whole address that the command has said, token included.</p>"
    '<p>If a link on another page has led here: <a href="/">go on</a>.</p>'
)
ProcessRequest = Callable[[Any, Request], Response | None]


class Gate:
    """Lets requests with the token pass; ``refused`` counts the others, and what does not fit.

    ``find`` returns a widget of a viewer's page by its identifier, or None.
    """

    def __init__(self, token: str, find: Callable[[str], Any]) -> None:
        self._token, self._find = token, find
        self.refused: Counter[str] = Counter()
        self.logger = logging.Logger("seatrial_kits.live", logging.ERROR)
        self.logger.addHandler(_Counting(self.refused))

    def process_request(self, then: ProcessRequest) -> ProcessRequest:
        """Return a hook for requests that asks first, and then calls ``then``."""

        def process(connection: Any, request: Request) -> Response | None:
            response = self._answer(connection.local_address[1], request)
            if response is None:
                try:
                    response = then(connection, request)
                except (OSError, ValueError):  # a name that no file can have
                    response = _response(http.HTTPStatus.NOT_FOUND)
            elif response.status_code >= http.HTTPStatus.BAD_REQUEST:
                self.refused["requests"] += 1
            if response is not None:
                response.headers["Referrer-Policy"] = "no-referrer"
                response.headers["Cache-Control"] = "no-store"
                response.headers["Content-Security-Policy"] = "frame-ancestors 'none'"
            return response

        return process

    def handler(self, then: Callable[[Any], Awaitable[None]]) -> Callable[[Any], Awaitable[None]]:
        """Return a handler of connections that passes on only messages that fit."""

        async def handle(connection: Any) -> None:
            loop = asyncio.get_running_loop()
            loop.set_exception_handler(lambda *_: self.refused.update(["messages"]))
            await then(_Checked(connection, self))

        return handle

    def may_pass(self, raw: Any) -> bool:
        """Say if a message fits; count it if not."""
        if fits(raw, self._find):
            return True
        self.refused["messages"] += 1
        return False

    # ------------------------------------------------------------------ inside

    def _answer(self, port: int, request: Request) -> Response | None:
        """Return the answer to a request that does not get further; None lets it pass."""
        path, query, rest = request.path.partition("?")
        if not unquote(path, errors="replace").isascii():
            return _response(http.HTTPStatus.NOT_FOUND)
        hosts = request.headers.get_all("Host")
        origins = request.headers.get_all("Origin")
        if len(hosts) != 1 or not _HOST.fullmatch(hosts[0]):
            return _response(http.HTTPStatus.FORBIDDEN, "not this host")
        if origins not in ([], [f"http://{hosts[0]}"]):
            return _response(http.HTTPStatus.FORBIDDEN, "not this origin")
        cookie = f"seatrial-{port}"
        if self._is_token(path.removeprefix("/").removesuffix("/")):
            if request.headers.get_all("Upgrade"):  # a program's, which keeps no cookies
                request.path = "/" + query + rest
                return None
            keep = f"{cookie}={self._token}; Path=/; HttpOnly; SameSite=Strict"
            headers = Headers({"Location": "/", "Set-Cookie": keep, "Content-Length": "0"})
            return Response(http.HTTPStatus.SEE_OTHER, "See Other", headers)
        if not any(map(self._is_token, _cookies(request.headers, cookie))):
            return _response(http.HTTPStatus.FORBIDDEN, _HELP, "text/html; charset=utf-8")
        return None

    def _is_token(self, text: str) -> bool:
        return secrets.compare_digest(text.encode("utf-8", "replace"), self._token.encode())


class _Checked:
    """A connection of websockets' whose messages that do not fit are left out."""

    def __init__(self, connection: Any, gate: Gate) -> None:
        self._connection, self._gate, self._junk = connection, gate, 0

    def __getattr__(self, name: str) -> Any:
        return getattr(self._connection, name)

    async def recv(self) -> Any:
        """Return the next message that fits; many others end the connection."""
        while not self._gate.may_pass(raw := await self._connection.recv()):
            self._junk += 1
            if self._junk == _MOST_JUNK:
                await self._connection.close(1008, "too many messages that do not fit")
        return raw


class _Counting(logging.Handler):
    """Counts what websockets would log with a traceback: handshakes and frames that are none."""

    def __init__(self, counts: Counter[str]) -> None:
        super().__init__(logging.ERROR)
        self._counts = counts

    def emit(self, record: logging.LogRecord) -> None:
        self._counts["connections"] += 1


def _cookies(headers: Headers, name: str) -> list[str]:
    pairs = [one.strip().partition("=") for h in headers.get_all("Cookie") for one in h.split(";")]
    return [value for key, _, value in pairs if key == name]


def _response(status: http.HTTPStatus, text: str = "", kind: str = "text/plain") -> Response:
    body = text.encode()
    headers = Headers({"Content-Type": kind, "Content-Length": str(len(body))})
    return Response(status, status.phrase, headers, body)


_LONGEST = 100_000
"""Bytes of a message."""
_LONGEST_TEXT = 10_000
_LARGEST = 1e15
_TYPES = {
    one.__name__: msgspec.defstruct(
        one.__name__,
        [(key, hint) for key, hint in get_type_hints(one).items() if key in one.__annotations__],
    )
    for one in (
        messages.ViewerCameraMessage,
        messages.GuiUpdateMessage,
        messages.CommandTriggerMessage,
    )
}
"""What the widgets and the scene of these pages send; nothing is uploaded, shared or asked for."""
_CAMERA, _UPDATE = _TYPES["ViewerCameraMessage"], _TYPES["GuiUpdateMessage"]


def fits(raw: Any, find: Callable[[str], Any]) -> bool:
    """Say if a message is one of the page's, with values that its widget has.

    ``find`` returns a widget by its identifier, or None: one that has gone just then is no mistake.
    """
    if not isinstance(raw, bytes) or len(raw) > _LONGEST:
        return False
    try:
        content = msgspec.msgpack.decode(raw)
        form = _TYPES[content.pop("type")]
        message: Any = msgspec.convert(content, form)
    except (msgspec.MsgspecError, KeyError, TypeError, AttributeError, RecursionError):
        return False
    if set(content) != set(form.__struct_fields__):
        return False
    if form is _CAMERA:
        return all(abs(number) <= _LARGEST for number in _numbers(content.values()))
    if form is _UPDATE:
        widget = find(message.uuid)
        return list(message.updates) == ["value"] and (
            widget is None or _is_of(widget, message.updates["value"])
        )
    return True


def _numbers(values: Any) -> Iterator[float]:
    """Yield numbers, and those in lists; NaN as infinite."""
    for value in values:
        if isinstance(value, list):
            yield from _numbers(value)
        else:
            yield math.inf if math.isnan(value) else value


def _is_of(widget: Any, value: Any) -> bool:
    """Say if a value is one that a widget can have."""
    match widget:
        case viser.GuiDropdownHandle() | viser.GuiButtonGroupHandle():
            return isinstance(value, str) and value in widget.options
        case viser.GuiSliderHandle():
            slack = 1e-6 * (widget.max - widget.min)
            return _is_number(value) and widget.min - slack <= value <= widget.max + slack
        case viser.GuiNumberHandle():
            return _is_number(value)
        case viser.GuiCheckboxHandle() | viser.GuiButtonHandle():
            return isinstance(value, bool)
        case viser.GuiTextHandle():
            return isinstance(value, str) and len(value) <= _LONGEST_TEXT
    return False


def _is_number(value: Any) -> bool:
    return type(value) in (int, float) and abs(value) <= _LARGEST
