"""MAVProxy as its user has it: a process that is typed to, and that says what it sees."""

from __future__ import annotations

import os
import re
import subprocess
import sys
import threading
import time
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path

MODULES = (
    *("log", "signing", "wp", "rally", "fence", "ftp", "param", "relay", "tuneopt", "arm", "mode"),
    *("calibration", "rc", "auxopt", "misc", "cmdlong", "battery", "terrain", "output", "layout"),
)
"""All that it loads unless it is told otherwise, but for air traffic, which wants a picture."""

COMPLAINTS = re.compile(
    r"fence breach|checks disabled|\b[Ee]rror(?!s: 0)|Traceback|Exception|link \d+ down|no link"
    r"|FAILED|DENIED|UNSUPPORTED|CANCELLED|[Uu]nknown|[Tt]imed? ?out|BAD_DATA|Failsafe|lost"
)
"""What it says when something is wrong."""

_SHOWS_MESSAGE = re.compile(r"\b\d+: [A-Z0-9_]+ \{.*\}$")

ANSWER_S = 60.0
"""Wall time for what is answered at once on a machine that is not busy."""


class MavProxy:
    """A session. What it prints is read as it comes; `expect` goes on where the last one ended."""

    def __init__(self, process: subprocess.Popen[str]) -> None:
        self._process = process
        self._lines = threading.Condition()
        self.said = ""
        """All that it has printed."""
        self._at = 0
        threading.Thread(target=self._read, daemon=True).start()

    def type(self, line: str) -> None:
        """Type a line."""
        assert self._process.stdin is not None
        self._process.stdin.write(line + "\n")
        self._process.stdin.flush()

    def expect(self, pattern: str, deadline_s: float = ANSWER_S) -> re.Match[str]:
        """Return the next match of ``pattern`` in whole lines, and go on behind it."""
        wanted, end = re.compile(pattern, re.MULTILINE), time.monotonic() + deadline_s
        with self._lines:
            while (found := wanted.search(self.said, self._at, self.said.rfind("\n") + 1)) is None:
                left = end - time.monotonic()
                if left <= 0.0 or self._process.poll() is not None:
                    new = self.said[self._at :]
                    raise AssertionError(f"MAVProxy never said {pattern!r}, but:\n{new}")
                self._lines.wait(min(left, 0.5))
            self._at = found.end()
        return found

    def ask(self, line: str, pattern: str, deadline_s: float = ANSWER_S) -> re.Match[str]:
        """Type a line, and return what it says then."""
        with self._lines:
            self._at = len(self.said)
        self.type(line)
        return self.expect(pattern, deadline_s)

    def insist(self, line: str, pattern: str, each_s: float, tries: int = 8) -> re.Match[str]:
        """Type a line until it says something: of what begins a transfer it repeats nothing."""
        for _ in range(tries - 1):
            with suppress(AssertionError):
                return self.ask(line, pattern, each_s)
        return self.ask(line, pattern, each_s)

    def newest(self, message: str, field: str) -> float:
        """Return a field of the newest message of a kind that it has received of."""
        pattern = rf"\b\d+: {message} .*\b{field} : (\S+?)[,}}]"
        end = time.monotonic() + ANSWER_S
        while True:
            try:
                return float(self.ask(f"status {message}", pattern, 1.0)[1])
            except AssertionError:
                if time.monotonic() > end:
                    raise

    def complaints(self, since: str) -> list[str]:
        """Return the lines after the first ``since`` in which something is wrong.

        Lines that show a message, as ``status`` does, have fields with such names.
        """
        lines = self.said[self.said.index(since) :].splitlines()
        return [
            line for line in lines if COMPLAINTS.search(line) and not _SHOWS_MESSAGE.search(line)
        ]

    def _read(self) -> None:
        assert self._process.stdout is not None
        while text := os.read(self._process.stdout.fileno(), 1 << 16).decode("utf-8", "replace"):
            with self._lines:
                self.said += text.replace("\r", "")
                self._lines.notify_all()


@contextmanager
def mavproxy(folder: Path, master: str, *options: str) -> Iterator[MavProxy]:
    """Start MAVProxy in an empty home, connected to ``master``, and end it in any case.

    An error in the block gets all that it has said as a note.
    """
    folder.mkdir(parents=True, exist_ok=True)
    command = [sys.executable, str(Path(sys.executable).with_name("mavproxy.py"))]
    command += [f"--master={master}", "--nowait", "--force-connected", "--state-basedir=."]
    command += [f"--default-modules={','.join(MODULES)}", *options]
    quiet = {"HOME": str(folder), "MPLBACKEND": "Agg", "TERM": "dumb", "PYTHONUNBUFFERED": "1"}
    process = subprocess.Popen(
        command, cwd=folder, env={**os.environ, **quiet}, text=True,
        stdin=subprocess.PIPE, stdout=subprocess.PIPE, stderr=subprocess.STDOUT,
    )  # fmt: skip
    session = MavProxy(process)
    try:
        yield session
    except BaseException as error:
        error.add_note(f"MAVProxy (status {process.poll()}) said:\n{session.said}")
        raise
    finally:
        process.kill()
        process.wait()
