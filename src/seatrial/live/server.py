"""The page's server: viser on loopback, behind a token, without a way to other hosts."""

from __future__ import annotations

import functools
import http
import secrets
import threading
from collections.abc import Callable
from typing import Any, ClassVar
from unittest import mock

import rich
import viser
import websockets.asyncio.server
from websockets import Headers
from websockets.http11 import Request, Response

from ..errors import InputError

LOOPBACK = "127.0.0.1"


class PageServer(viser.ViserServer):
    """viser's server at ``http://127.0.0.1:PORT/TOKEN/``; requests without the token are refused.

    viser 1.1 knows no tokens. It serves its page and its websocket through one call of
    ``websockets.asyncio.server.serve``, whose hook for requests is wrapped here while the server
    starts; the client opens its socket below the path of its page, and so sends the token too. A
    token keeps out other users of the machine and pages of other sites alike.
    """

    _starting: ClassVar = threading.Lock()

    def __init__(self, port: int = 0, token: str | None = None) -> None:
        """Listen at a port, 0 for any that is free. Raises InputError if it is taken."""
        self.token = token or secrets.token_urlsafe(16)
        rich.get_console().quiet = True  # viser says where it is, without the token
        serve = websockets.asyncio.server.serve
        behind = functools.partial(_serve, serve, self.token)
        with self._starting, mock.patch.object(websockets.asyncio.server, "serve", behind):
            super().__init__(host=LOOPBACK, port=port, verbose=False)
        if port and self.get_port() != port:
            self.stop()
            raise InputError(f"--port: port {port} of {LOOPBACK} is taken")

    @property
    def address(self) -> str:
        """Address of the page, with the token."""
        return f"http://{LOOPBACK}:{self.get_port()}/{self.token}/"

    def request_share_url(self, verbose: bool = True) -> str | None:
        """Refuse to: viser would let others in by a server of its makers."""
        return None


def look(gui: Any, *, dark: bool = False) -> None:
    """Lay a page out: the panel at the right, without ways to other hosts."""
    gui.configure_theme(
        show_logo=False, show_share_button=False, control_width="large", dark_mode=dark
    )
    gui.main_panel.dock_right()


def _serve(serve: Callable[..., Any], token: str, handler: Any, *places: Any, **how: Any) -> Any:
    """Call websockets' ``serve`` with a hook that asks for the token first."""
    then = how.pop("process_request")
    prefix = f"/{token}"

    def process_request(connection: Any, request: Request) -> Response | None:
        path = request.path
        if not secrets.compare_digest(path[: len(prefix)].encode(), prefix.encode()):
            return Response(http.HTTPStatus.FORBIDDEN, "FORBIDDEN", Headers(), b"no token\n")
        rest = path[len(prefix) :]
        if rest and not rest.startswith(("/", "?")):
            return Response(http.HTTPStatus.FORBIDDEN, "FORBIDDEN", Headers(), b"no token\n")
        request.path = rest if rest.startswith("/") else f"/{rest}"
        found: Response | None = then(connection, request)
        if found is not None:
            found.headers["Referrer-Policy"] = "no-referrer"
            found.headers["Cache-Control"] = "no-store"
        return found

    return serve(handler, *places, process_request=process_request, **how)
