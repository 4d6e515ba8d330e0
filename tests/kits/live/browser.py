"""Debian's Chromium, headless, driven by Playwright; and pages of seatrial to open in it."""

from __future__ import annotations

import http.server
import os
import shutil
import signal
import subprocess
import sys
import threading
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import pytest

CHROMIUM = shutil.which("chromium")
_FLAGS = [
    "--no-sandbox", "--use-angle=swiftshader", "--enable-unsafe-swiftshader",
    "--ignore-gpu-blocklist", "--disable-quic", "--no-first-run",
    "--disable-background-networking", "--disable-component-update", "--disable-sync",
]  # fmt: skip
WAIT_MS = 60_000


@contextmanager
def chromium() -> Iterator[Any]:
    """Yield a browser; skip without one, but not where the toolchain must be whole."""
    if CHROMIUM is None:
        assert "SEATRIAL_NEED_TOOLCHAIN" not in os.environ, (
            "chromium is missing: .ci/run installs it"
        )
        pytest.skip("chromium is not installed: apt install chromium")
    from playwright.sync_api import sync_playwright

    with sync_playwright() as playwright:
        browser = playwright.chromium.launch(executable_path=CHROMIUM, args=_FLAGS)
        yield browser
        browser.close()


class Served:
    """A command of seatrial that serves a page; ``address`` is where."""

    def __init__(self, folder: Path, *arguments: str) -> None:
        command = [str(Path(sys.executable).with_name("seatrial")), *arguments]
        self.process = subprocess.Popen(
            command, cwd=folder, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True
        )
        self.lines: list[str] = []
        self._known = threading.Event()
        threading.Thread(target=self._read, daemon=True).start()
        assert self._known.wait(120), self.lines
        self.address = next(w for w in " ".join(self.lines).split() if w.startswith("http://"))

    def _read(self) -> None:
        assert self.process.stdout is not None
        for line in self.process.stdout:
            self.lines.append(line)
            if "http://" in line:
                self._known.set()
        self._known.set()

    def end(self) -> int:
        """Ask it to stop, and return its status."""
        if self.process.poll() is None:
            self.process.send_signal(signal.SIGINT)
        return self.process.wait(60)


@contextmanager
def served(folder: Path, *arguments: str) -> Iterator[Served]:
    """Yield a command that serves a page, and end it; all that its viewers sent must have fit."""
    of_it = Served(folder, *arguments)
    try:
        yield of_it
    finally:
        of_it.end()
    assert not [line for line in of_it.lines if "refused" in line or "Traceback" in line]


@contextmanager
def other_site() -> Iterator[str]:
    """Yield the address of an empty page of another server of this machine."""

    class Empty(http.server.BaseHTTPRequestHandler):
        def do_GET(self) -> None:
            self.send_response(200)
            self.send_header("Content-Type", "text/html")
            self.end_headers()

        def log_message(self, *_: object) -> None:
            pass

    with http.server.ThreadingHTTPServer(("127.0.0.1", 0), Empty) as server:
        threading.Thread(target=server.serve_forever, daemon=True).start()
        yield f"http://127.0.0.1:{server.server_port}/"
        server.shutdown()


def opened(browser: Any, address: str, awaited: str = "canvas") -> Any:
    """Return a page that has shown what it is opened for; errors of its scripts are kept in ``problems``."""
    page = browser.new_page(viewport={"width": 900, "height": 640})
    page.set_default_timeout(WAIT_MS)
    page.problems = []
    page.on("pageerror", lambda error: page.problems.append(str(error)))
    page.goto(address)
    page.locator(awaited).first.wait_for()
    return page
