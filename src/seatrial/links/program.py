"""A program of a user's that runs beside the run, in a folder of its own, and ends with it."""

from __future__ import annotations

import ctypes
import os
import signal
import subprocess
import sys
import tempfile
from collections.abc import Mapping, Sequence
from contextlib import ExitStack
from pathlib import Path

from ..errors import InputError, SimulationError

OUTPUT = "output.txt"
"""What the program prints, in its folder."""
_PR_SET_PDEATHSIG = 1
_SHOWN = 300
"""Characters of the program's last output that a message has."""


def check_program(program: str) -> Path:
    """Return the program's path. Raises InputError if it cannot be run."""
    path = Path(program).expanduser().resolve()
    if not path.is_file():
        raise InputError(f"program: there is no file {path}")
    if not os.access(path, os.X_OK):
        raise InputError(f"program: {path} is not executable")
    return path


class Program:
    """The running program ``whom`` of the component ``name``.

    ``folder`` keeps its settings, logs and output; None: a passing one. ``environment`` has
    variables beside those of this process. Raises SimulationError where it cannot be run.
    """

    def __init__(
        self,
        name: str,
        whom: str,
        command: Sequence[str],
        folder: Path | None,
        environment: Mapping[str, str] | None = None,
    ) -> None:
        self._name, self._whom = name, whom
        self._held = ExitStack()
        try:
            if folder is None:
                folder = Path(self._held.enter_context(tempfile.TemporaryDirectory()))
            folder.mkdir(exist_ok=True)
            self._output = folder / OUTPUT
            output = self._held.enter_context(self._output.open("wb"))
            self._process = subprocess.Popen(
                command,
                cwd=folder,
                env={**os.environ, **(environment or {})},
                stdin=subprocess.DEVNULL,
                stdout=output,
                stderr=subprocess.STDOUT,
                start_new_session=True,
                preexec_fn=_end_with_parent,
            )
        except OSError as error:
            self._held.close()
            raise SimulationError(f"{name}: cannot run {command[0]}: {error.strerror}") from None

    def check(self) -> None:
        """Raise SimulationError, with the end of its output, if it has ended."""
        code = self._process.poll()
        if code is not None:
            how = f"by signal {-code}" if code < 0 else f"with status {code}"
            said = self._output.read_text(errors="replace").strip()[-_SHOWN:]
            raise SimulationError(
                f"{self._name}: {self._whom} ended {how}; {self._output}: {said!r}"
            )

    def close(self) -> None:
        """End it at once: while it waits for the physics it heeds no request."""
        self._process.kill()
        self._process.wait()
        self._held.close()


def _end_with_parent() -> None:
    if sys.platform == "linux":
        ctypes.CDLL(None).prctl(_PR_SET_PDEATHSIG, signal.SIGKILL)
