"""The user's end of a live page: it serves the page as long as the run goes on."""

from __future__ import annotations

import os
import threading
from collections import Counter
from collections.abc import Callable
from multiprocessing import Pipe
from pathlib import Path
from typing import Any

import numpy as np

from seatrial.errors import InputError
from seatrial.trial.files.trial import Trial

from .by_hand import ByHand
from .live_page import LivePage
from .server import PageServer, check_port
from .tap import Tap

_POLL_S = 0.02
_NICE = 10
"""Of the page's threads: where processors are short, the simulation comes first."""


class Session:
    """Serves the page of one run after the other, at one address.

    Give `observer` of a run to its hooks, and run it inside a ``with`` block; the server is there
    from the first step to the end of the block. ``announce`` is called with the address, once.
    ``restart_seed`` is the seed that the page wants the trial to begin anew with, or None.

    Raises InputError for a port that is taken: before the run begins, or, where somebody takes the
    port meanwhile, at the end of the block; the run is stopped then.
    """

    def __init__(
        self, announce: Callable[[str], None], port: int = 0, *, may_command: bool = True
    ) -> None:
        check_port(port)
        self._announce, self._port, self._token = announce, port, ""
        self._may_command = may_command
        self._pace: float | None = 1.0
        self.restart_seed: int | None = None
        self.refused: Counter[str] = Counter()
        """What was sent to the pages and refused, by kind."""

    def of(self, trial: Trial) -> Session:
        """Prepare for a run of a trial: the page's, not the run's, side of it."""
        self.restart_seed = None
        self._done = ByHand(trial)
        ours, theirs = Pipe()
        self._pipe = ours
        self.observer = Tap(theirs, self._may_command, self._pace)
        return self

    def __enter__(self) -> Session:
        self._over = threading.Event()
        self._failure: InputError | None = None
        self._folder: Path | None = None
        self._thread = threading.Thread(target=self._serve, daemon=True)
        self._thread.start()
        return self

    def __exit__(self, _kind: object, error: BaseException | None, _trace: object) -> None:
        self._over.set()
        self._thread.join()
        self._pipe.close()
        self.observer.pipe.close()
        if self._done and self._folder is not None and self._folder.is_dir():
            (self._folder / "by-hand.toml").write_text(self._done.text(), "utf-8")
        if self._failure is not None and error is None:
            raise self._failure

    # ------------------------------------------------------------------ inside

    def _serve(self) -> None:
        """Wait for the run's first step, serve its page, and end with it."""
        if hasattr(os, "setpriority"):  # threads that this one starts have its priority, on Linux
            os.setpriority(os.PRIO_PROCESS, threading.get_native_id(), _NICE)
        while not self._over.is_set():
            if self._pipe.poll(_POLL_S):
                what, described = self._pipe.recv()
                assert what == "begin"
                self._folder = Path(described["folder"])
                break
        else:
            return
        try:
            server = PageServer(self._port, self._token or None)
        except InputError as failure:
            self._failure = failure
            self._command("stop")
            return
        if not self._token:
            self._announce(server.address)
        self._port, self._token = server.get_port(), server.token
        self._viewers = 0
        page = LivePage(server, described, self._command, self._done, self._may_command)
        try:
            while not self._over.is_set():
                self._poll(server, page)
        finally:
            server.stop()
            self.refused += server.gate.refused

    def _poll(self, server: PageServer, page: LivePage) -> None:
        """Show what has come, and say that it was taken; say how many look."""
        viewers = len(server.get_clients())
        if viewers != self._viewers:
            self._viewers = viewers
            page.watched_by(viewers)
            self._command("viewers", viewers)
        if not self._pipe.poll(_POLL_S):
            return
        try:
            what, *content = self._pipe.recv()
        except (EOFError, OSError):
            self._over.wait(_POLL_S)
            return
        if what == "frame":
            time, values = content
            page.show(time, np.frombuffer(values))
            self._command("taken")
        elif what == "done":
            self._done.add(*content)
            page.log(*content)
        elif what == "links":
            page.lost(*content)
        elif what == "refused":
            page.refused(content[0])

    def _command(self, *message: Any) -> None:
        """Send the run a command; what begins it anew is noted here."""
        if message[0] == "restart":
            self.restart_seed = message[1]
            message = ("stop",)
        if message[0] == "speed":
            self._pace = message[1]
        try:
            self._pipe.send(message)
        except OSError:  # the run has ended
            return
