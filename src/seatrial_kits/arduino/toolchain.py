"""Compilers and libraries that the system has, and what installs those that it has not."""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
from functools import cache
from pathlib import Path

from seatrial.errors import InputError

_ARDUINO = Path("/usr/share/arduino/hardware/arduino/avr")
_SIMAVR = Path("/usr/include/simavr/sim_avr.h")


def arduino_core() -> Path:
    """Return the folder of the Arduino core for AVR boards."""
    return _ARDUINO


@cache
def missing(backend: str) -> tuple[str, ...]:
    """Return the Debian packages that a back end needs and that are not there."""
    lacks = []
    if shutil.which("g++") is None:
        lacks.append("g++")
    if backend == "host for ESP32":
        lacks += [] if _compiles_for_32_bits() else ["g++-multilib"]
    if backend == "simavr":
        lacks += ["gcc-avr"] if shutil.which("avr-g++") is None else []
        lacks += [] if Path("/usr/lib/avr/include").is_dir() else ["avr-libc"]
        lacks += [] if (_ARDUINO / "cores").is_dir() else ["arduino-core-avr"]
        lacks += [] if _SIMAVR.is_file() else ["libsimavr-dev"]
        lacks += [] if Path("/usr/include/libelf.h").is_file() else ["libelf-dev"]
    return tuple(lacks)


def _compiles_for_32_bits() -> bool:
    command = ["g++", "-m32", "-x", "c++", "-include", "vector", "-o", os.devnull, "-"]
    source = "int main() {}"
    try:
        return not subprocess.run(command, input=source, text=True, capture_output=True).returncode
    except OSError:
        return False


def need(backend: str) -> None:
    """Raise InputError, with the command that helps, if a back end's tools are not there."""
    if sys.platform != "linux":
        raise InputError(f"the back end {backend!r} needs Linux")
    if packages := missing(backend):
        raise InputError(
            f"the back end {backend!r} needs tools that are not installed: "
            f"apt-get install {' '.join(packages)}"
        )


@cache
def version(compiler: str) -> str:
    """Return a compiler's version, first line."""
    found = subprocess.run([compiler, "--version"], capture_output=True, text=True, check=True)
    return found.stdout.splitlines()[0]
