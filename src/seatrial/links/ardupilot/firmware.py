"""A firmware program that runs beside the run, in a folder of its own, and ends with it."""

from __future__ import annotations

import ctypes
import os
import shlex
import signal
import subprocess
import sys
import tempfile
from collections.abc import Sequence
from contextlib import ExitStack
from pathlib import Path

from ...errors import InputError, SimulationError

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


def arguments(
    port: int,
    home: tuple[float, float, float, float],
    step: float,
    speedup: float,
    *,
    defaults: str = "",
    serial0: str = "",
) -> list[str]:
    """Return the firmware's options.

    ``home`` is latitude, longitude and heading in degrees, with the altitude in m before the
    heading; ``step`` the communication step in s; ``defaults`` a parameter file, ``serial0`` the
    device of its first serial port, each empty for its own.
    """
    latitude, longitude, altitude, heading = home
    options = [
        "--model", "JSON:127.0.0.1", "--sim-port-out", str(port),
        "--home", f"{latitude:.9f},{longitude:.9f},{altitude:g},{heading:.3f}",
        "--rate", f"{round(1.0 / step)}", "--speedup", f"{speedup:g}",
    ]  # fmt: skip
    given = {"--defaults": defaults, "--serial0": serial0}
    return [*options, *(word for key, text in given.items() if text for word in (key, text))]


def by_hand(program: str, options: Sequence[str]) -> str:
    """Return the command as a person types it."""
    return shlex.join([program, *options])


class Firmware:
    """The running program. ``folder`` keeps its settings, logs and output; None: a passing one."""

    def __init__(
        self, name: str, program: Path, options: Sequence[str], folder: Path | None
    ) -> None:
        self._name = name
        self._held = ExitStack()
        try:
            if folder is None:
                folder = Path(self._held.enter_context(tempfile.TemporaryDirectory()))
            folder.mkdir(exist_ok=True)
            self._output = folder / OUTPUT
            output = self._held.enter_context(self._output.open("wb"))
            self._process = subprocess.Popen(
                [str(program), *options],
                cwd=folder,
                stdin=subprocess.DEVNULL,
                stdout=output,
                stderr=subprocess.STDOUT,
                start_new_session=True,
                preexec_fn=_end_with_parent,
            )
        except OSError as error:
            self._held.close()
            raise SimulationError(f"{name}: cannot run {program}: {error.strerror}") from None

    def check(self) -> None:
        """Raise SimulationError, with the end of its output, if it has ended."""
        code = self._process.poll()
        if code is not None:
            how = f"by signal {-code}" if code < 0 else f"with status {code}"
            said = self._output.read_text(errors="replace").strip()[-_SHOWN:]
            raise SimulationError(f"{self._name}: ArduPilot ended {how}; {self._output}: {said!r}")

    def close(self) -> None:
        """End it at once: while it waits for the physics it heeds no request."""
        self._process.kill()
        self._process.wait()
        self._held.close()


def _end_with_parent() -> None:
    if sys.platform == "linux":
        ctypes.CDLL(None).prctl(_PR_SET_PDEATHSIG, signal.SIGKILL)
