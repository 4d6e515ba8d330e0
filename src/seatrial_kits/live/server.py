"""The page's server: viser on loopback, behind a token, without a way to other hosts."""

from __future__ import annotations

import errno
import functools
import secrets
import socket
import threading
from collections.abc import Callable
from typing import Any, ClassVar
from unittest import mock

import rich
import viser
import websockets.asyncio.server

from seatrial.errors import InputError

from .gate import Gate

LOOPBACK = "127.0.0.1"


class PageServer(viser.ViserServer):
    """viser's server at ``http://127.0.0.1:PORT/TOKEN/``, which gives a cookie and leads to ``/``.

    viser 1.1 knows no tokens. It serves its page and its websocket through one call of
    ``websockets.asyncio.server.serve``, whose hooks are wrapped here while the server starts: a
    `Gate` lets in who has the token, and of what a viewer sends what fits.
    """

    _starting: ClassVar = threading.Lock()

    def __init__(self, port: int = 0, token: str | None = None) -> None:
        """Listen at a port, 0 for any that is free. Raises InputError, as `check_port`."""
        check_port(port)
        self.token = token or secrets.token_urlsafe(16)
        rich.get_console().quiet = True  # viser says where it is, without the token
        self.gate = Gate(self.token, self._widget)
        serve = websockets.asyncio.server.serve
        behind = functools.partial(_serve, serve, self.gate)
        with self._starting, mock.patch.object(websockets.asyncio.server, "serve", behind):
            super().__init__(host=LOOPBACK, port=port, verbose=False)
        if port and self.get_port() != port:  # taken since it was checked: viser takes another one
            self.stop()
            check_port(port)
            raise InputError(f"--port: port {port} of {LOOPBACK} was taken while the page started")

    @property
    def address(self) -> str:
        """Address of the page, with the token."""
        return f"http://{LOOPBACK}:{self.get_port()}/{self.token}/"

    def _widget(self, uuid: str) -> Any:
        """Return a widget of all viewers or of one, None if there is none."""
        pages: list[Any] = [self, *self.get_clients().values()]
        for page in pages:
            gui = getattr(page, "gui", None)  # a page that is starting has none
            if gui is not None and (widget := gui._gui_input_handle_from_uuid.get(uuid)):
                return widget
        return None

    def request_share_url(self, verbose: bool = True) -> str | None:
        """Refuse to: viser would let others in by a server of its makers."""
        return None


def check_port(port: int) -> None:
    """Raise InputError for a port that cannot be listened at now; 0 is any that is free."""
    try:
        socket.create_server((LOOPBACK, port)).close()
    except OSError as error:
        taken = error.errno == errno.EADDRINUSE
        why = "is taken" if taken else f"cannot be had ({error.strerror})"
        raise InputError(
            f"--port: port {port} of {LOOPBACK} {why}; 0 is any that is free"
        ) from None


def look(gui: Any, *, dark: bool = False) -> None:
    """Lay a page out: the panel at the right, without ways to other hosts."""
    gui.configure_theme(
        show_logo=False, show_share_button=False, control_width="large", dark_mode=dark
    )
    gui.main_panel.dock_right()


def _serve(serve: Callable[..., Any], gate: Gate, handler: Any, *places: Any, **how: Any) -> Any:
    """Call websockets' ``serve`` with hooks that ask the gate first."""
    then = gate.process_request(how.pop("process_request"))
    return serve(gate.handler(handler), *places, process_request=then, logger=gate.logger, **how)
