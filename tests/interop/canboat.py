"""canboat in JavaScript (@canboat/canboatjs): frames to its messages, and its messages to frames."""

from __future__ import annotations

import json
import shutil
import subprocess
from collections.abc import Iterable
from pathlib import Path
from typing import Any

import pytest

from seatrial_kits.can.frame import Frame

NODE = Path(__file__).with_name("node")
needed = pytest.mark.skipif(
    shutil.which("node") is None or not (NODE / "node_modules/@canboat/canboatjs").is_dir(),
    reason="canboatjs is not installed: make tests/interop/node/node_modules/.installed needs npm",
)
_WAIT_S = 120.0


def decoded(frames: Iterable[tuple[int, Frame]]) -> list[dict[str, Any]]:
    """Return canboat's messages of frames, (time in ns, frame) each."""
    return read(_line(when, frame) for when, frame in frames)


def read(lines: Iterable[str]) -> list[dict[str, Any]]:
    """Return canboat's messages of the lines of a log of ``candump -L``."""
    return _run("decode", list(lines))


def encoded(messages: Iterable[dict[str, Any]]) -> list[list[Frame]]:
    """Return canboat's frames of each message: ``pgn``, ``src``, ``dst``, ``prio``, ``fields``."""
    found = _run("encode", [json.dumps(each) for each in messages])
    return [[_frame(line) for line in lines] for lines in found]


def _run(work: str, lines: list[str]) -> list[Any]:
    command = ["node", str(NODE / "canboat.js"), work]
    text = "".join(f"{line}\n" for line in lines)
    done = subprocess.run(
        command, input=text, capture_output=True, text=True, timeout=_WAIT_S, check=True
    )
    return [json.loads(line) for line in done.stdout.splitlines()]


def _line(when_ns: int, frame: Frame) -> str:
    return f"({when_ns / 1e9:.6f}) can0 {frame.identifier:08X}#{frame.data.hex().upper()}"


def _frame(line: str) -> Frame:
    identifier, _, data = line.split()[-1].partition("#")
    return Frame(int(identifier, 16), bytes.fromhex(data), extended=True)
