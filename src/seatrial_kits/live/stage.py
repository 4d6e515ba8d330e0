"""A run in three dimensions for a report: viser's client and a recording, without a server."""

from __future__ import annotations

import asyncio
import base64
import json
import threading
from concurrent.futures import ThreadPoolExecutor
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
import viser
from viser import infra
from viser._scene_api import SceneApi
from viser._viser import InitialCameraConfig
from viser.infra._async_message_buffer import AsyncMessageBuffer

from seatrial.errors import InputError
from seatrial.trial.records.run_folder import Run
from seatrial.trial.reports.report import Played

from .cameras import BEGIN
from .playback import motion_of
from .scene import Scene

_FRAMES, _FRAMES_OF_WAVES = 240, 150
_CELLS = 12
"""Of the water with waves: each frame has all of its corners."""
_LONGEST_S = 40.0
"""Of a playback; longer runs are played faster."""


class _Recorder(infra._infra.WebsockMessageHandler):
    """Takes what a scene sends, and sends it nowhere."""

    def __init__(self, loop: asyncio.AbstractEventLoop) -> None:
        super().__init__()
        self._broadcast_buffer = AsyncMessageBuffer(loop, persistent_messages=True)

    def get_message_buffer(self) -> AsyncMessageBuffer:
        return self._broadcast_buffer


class _Stage(viser.ViserServer):
    """A server of viser that listens nowhere: what a scene and its recording need of one."""

    def __init__(self, loop: asyncio.AbstractEventLoop) -> None:
        recorder: Any = _Recorder(loop)
        self._websock_server = self._connection = recorder
        self._scene_lifecycle_lock = threading.RLock()
        self._connected_clients = {}
        self._initial_camera = InitialCameraConfig(broadcast=recorder.queue_message)
        self.scene = SceneApi(self, ThreadPoolExecutor(1), loop)
        self.scene.set_up_direction("+z")


def played(run: Run) -> Played | None:
    """Return a recording of a run for its report; None of one without a craft to show."""
    try:
        motion = motion_of(run)
    except InputError:
        return None
    begin, end = motion.span
    loop = asyncio.new_event_loop()
    try:
        stage = _Stage(loop)
        scene = Scene(stage.scene, motion, run.folder, cells=_CELLS)
        scene.draw_tracks()
        stage.initial_camera.position = tuple(BEGIN * scene.size)
        stage.initial_camera.look_at = (0.0, 0.0, 0.0)
        most = _FRAMES_OF_WAVES if scene.has_waves else _FRAMES
        times = np.linspace(begin, end, min(most, max(2, len(run.time))))
        speed = max(1.0, (end - begin) / _LONGEST_S)
        scene.show(motion.at(begin))
        serializer = stage.get_scene_serializer()
        for time in times.tolist()[1:]:
            serializer.insert_sleep((end - begin) / (len(times) - 1) / speed)
            scene.show(motion.at(time))
        data = serializer.serialize()
    finally:
        loop.close()
    return Played(base64.b64encode(data).decode("ascii"), speed, viewer_js())


@cache
def viewer_js() -> str:
    """Return viser's client as JavaScript that keeps it as a text."""
    client = Path(viser.__file__).parent / "client" / "build" / "index.html"
    text = json.dumps(client.read_text("utf-8")).replace("<", "\\u003c")
    return f"window.seatrialViewer = {text};\n"
