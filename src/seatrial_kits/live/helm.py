"""The helm: one of several viewers has it, and he alone commands."""

from __future__ import annotations

from typing import Any

_TAKE, _LET_GO = "Take the helm", "Let go of the helm"


class Helm:
    """The first who commands has the helm, until he lets go of it or leaves."""

    def __init__(self, server: Any, may_command: bool) -> None:
        self._server = server
        self._holder: int | None = None
        self._label = server.gui.add_html("")
        self._buttons: dict[int, Any] = {}
        if not may_command:
            self._label.content = _shown("this page only watches")
            return
        self._say()
        server.on_client_connect(self._came)
        server.on_client_disconnect(self._left)

    def may(self, event: Any) -> bool:
        """Say if whoever caused an event commands; tell him if somebody else does."""
        client = event.client
        if client is None:
            return False
        if self._holder is None:
            self._give(client.client_id)
        if self._holder == client.client_id:
            return True
        client.add_notification(
            "not yours", f"viewer {self._holder} has the helm", auto_close_seconds=5.0
        )
        return False

    def _came(self, client: Any) -> None:
        button = client.gui.add_button(_TAKE, order=-20.0)
        self._buttons[client.client_id] = button

        def clicked(event: Any) -> None:
            if self._holder == client.client_id:
                self._give(None)
            else:
                self.may(event)

        button.on_click(clicked)
        self._say()

    def _left(self, client: Any) -> None:
        self._buttons.pop(client.client_id, None)
        if self._holder == client.client_id:
            self._give(None)

    def _give(self, holder: int | None) -> None:
        self._holder = holder
        for number, button in list(self._buttons.items()):
            button.label = _LET_GO if number == holder else _TAKE
        self._say()

    def _say(self) -> None:
        viewers = len(self._buttons)
        said = (
            "nobody has the helm" if self._holder is None else f"viewer {self._holder} has the helm"
        )
        self._label.content = _shown(f"{viewers} viewer{'s' * (viewers != 1)}, {said}")


def _shown(text: str) -> str:
    return f'<div class="helm" style="padding:0 .8em;font-size:.85em;opacity:.75">{text}</div>'
