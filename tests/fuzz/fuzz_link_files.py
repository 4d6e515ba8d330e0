"""Files that links read: plans, parameters, recorded streams, what a vehicle keeps."""

from __future__ import annotations

import contextlib
import math
import tempfile
from pathlib import Path

from seatrial.errors import InputError
from seatrial_kits.mavlink.missions.plan import read_items, write_items
from seatrial_kits.mavlink.parameters.file import ParameterFile
from seatrial_kits.mavlink.signing import Signing
from seatrial_kits.mavlink.state_file import StateFile
from seatrial_kits.videoray.command_decode import describe_stream
from seatrial_kits.videoray.stream_file import read_stream


def one(data: bytes) -> None:
    """Let every reader have the file."""
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder, "x")
        path.write_bytes(data)
        for read in (_plan, _parameters, _stream, _state):
            with contextlib.suppress(InputError):
                read(path)


def _plan(path: Path) -> None:
    items = read_items(path)
    again = path.with_name("again")
    write_items(again, items)
    assert repr(read_items(again)) == repr(items)


def _parameters(path: Path) -> None:
    values = ParameterFile(path).read(lambda _name, value: value)
    assert all(map(math.isfinite, values.values()))


def _stream(path: Path) -> None:
    for line in describe_stream(read_stream(path)):
        assert line.isprintable()


def _state(path: Path) -> None:
    Signing(bytes(32), StateFile(path), lambda: 1.7e9)
