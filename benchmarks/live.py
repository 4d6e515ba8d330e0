"""Cost of a live page for the simulation: ``python -m benchmarks.live``.

The same trial runs as fast as it can, supervised: without a page, with a page that nobody looks at,
and with two viewers, in turn. A viewer is a websocket that takes all that the page sends, as a
browser does; drawing it is the browser's, of whatever machine that is. Given are the medians of the
ratios within a round, of the wall time of the steps and of the processor time of the simulating
process, which other load moves less; and as a control, two runs without a page.
"""

from __future__ import annotations

import argparse
import resource
import statistics
import tempfile
import threading
from collections.abc import Callable
from contextlib import ExitStack
from pathlib import Path

import msgspec
import viser
from websockets.sync.client import ClientConnection, connect

from seatrial.trial.files.trial import load_trial
from seatrial.trial.running.hooks import Hooks
from seatrial.trial.running.supervision import run_supervised
from seatrial_kits.live.session import Session

_CAMERA = {
    "type": "ViewerCameraMessage", "wxyz": [1, 0, 0, 0], "position": [-3, -3, 2], "fov": 1.0,
    "near": 0.01, "far": 1000.0, "image_height": 480, "image_width": 640, "look_at": [0, 0, 0],
    "up_direction": [0, 0, 1],
}  # fmt: skip


class Viewer:
    """Takes what a page sends, and counts it."""

    def __init__(self, address: str) -> None:
        place = address.replace("http://", "ws://").rstrip("/")
        protocol = [f"viser-v{viser.__version__}"]
        self.received = 0
        self._socket: ClientConnection = connect(place, subprotocols=protocol, max_size=None)
        self._socket.send(msgspec.msgpack.encode(_CAMERA))
        threading.Thread(target=self._read, daemon=True).start()

    def _read(self) -> None:
        for message in self._socket:
            self.received += len(message)


def measured(trial_name: str, stop: str, viewers: int | None) -> tuple[float, float, int]:
    """Return wall time of the steps, processor time of the run's process, s, and bytes sent."""
    trial = load_trial(trial_name, changes={"stop": stop}, origin="benchmark")
    watching: list[Viewer] = []
    announce: Callable[[str], None] = lambda address: watching.extend(  # noqa: E731
        Viewer(address) for _ in range(viewers or 0)
    )
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    with ExitStack() as stack:
        folder = Path(stack.enter_context(tempfile.TemporaryDirectory())) / "run"
        hooks = Hooks()
        if viewers is not None:
            session = Session(announce)
            session._pace = None
            session = session.of(trial)
            hooks = Hooks(observer=session.observer)
            stack.enter_context(session)
        result = run_supervised(trial, folder, engine="direct", hooks=hooks)
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    spent = after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime
    return result.wall["run"], spent, sum(viewer.received for viewer in watching)


def main() -> None:
    """Measure and print."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--rounds", type=int, default=7)
    parser.add_argument("--trial", default="hydrone-landing")
    parser.add_argument("--stop", default="200 s")
    options = parser.parse_args()
    ways = (None, None, 0, 2)
    rows = [
        [measured(options.trial, options.stop, way) for way in ways] for _ in range(options.rounds)
    ]
    names = ("control", "page, nobody looks", "page, two viewers")
    for place, name in enumerate(names, 1):
        wall = statistics.median(row[place][0] / row[0][0] for row in rows)
        spent = statistics.median(row[place][1] / row[0][1] for row in rows)
        sent = statistics.median(row[place][2] / row[place][0] for row in rows)
        print(f"{name:20} wall x {wall:.3f}, processor x {spent:.3f}, {sent / 1e3:.0f} kB/s sent")


if __name__ == "__main__":
    main()
