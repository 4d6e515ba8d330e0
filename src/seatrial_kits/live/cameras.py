"""Each viewer's camera: free about the craft, or one that goes with it."""

from __future__ import annotations

from typing import Any

import numpy as np

from .motion import Frame
from .scene import Scene

FREE, CHASE, DECK, ABOVE = "free, about the craft", "chase", "on deck", "from above"
_CHOICES = (FREE, CHASE, DECK, ABOVE)
BEGIN = np.array([-3.0, -4.2, 2.4])
"""Of the free camera, in sizes of the craft: east, north, up."""


class Cameras:
    """A menu for each viewer; `follow` moves the cameras that go with the craft."""

    def __init__(self, server: Any, scene: Scene) -> None:
        self._server, self._scene = server, scene
        self._chosen: dict[int, str] = {}
        server.initial_camera.position = tuple(BEGIN * scene.size)
        server.initial_camera.look_at = (0.0, 0.0, 0.0)
        server.initial_camera.up = (0.0, 0.0, 1.0)
        server.initial_camera.near = 0.01 * scene.size
        server.initial_camera.far = 2000.0 * scene.size
        server.on_client_connect(self._came)
        server.on_client_disconnect(lambda client: self._chosen.pop(client.client_id, None))

    def _came(self, client: Any) -> None:
        menu = client.gui.add_dropdown("Camera", _CHOICES, order=-10.0)

        def chosen(_: Any) -> None:
            self._chosen[client.client_id] = menu.value
            if menu.value == ABOVE:
                size = self._scene.size
                client.camera.position = (0.0, -0.02 * size, 14.0 * size)
                client.camera.look_at = (0.0, 0.0, 0.0)
            if menu.value == FREE:
                client.camera.position = tuple(BEGIN * self._scene.size)
                client.camera.look_at = (0.0, 0.0, 0.0)

        menu.on_update(chosen)

    def follow(self, frame: Frame) -> None:
        """Put the cameras that go with the craft in their places."""
        for client in self._server.get_clients().values():
            mode = self._chosen.get(client.client_id, FREE)
            if mode not in (CHASE, DECK):
                continue
            size, ahead = self._scene.size, frame.pose(self._scene.anchor).ahead
            up = np.array([0.0, 0.0, 1.0])
            back, high = (4.5, 1.8) if mode == CHASE else (0.35, 0.75)
            client.camera.position = tuple(size * (high * up - back * ahead))
            client.camera.look_at = tuple(size * (2.0 * ahead if mode == CHASE else 4.0 * ahead))
