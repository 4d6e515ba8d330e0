"""Files of trained networks, by their kind."""

from __future__ import annotations

from pathlib import Path

from seatrial.errors import InputError

from .network import LARGEST, Steps
from .network_npz import read_npz
from .network_onnx import read_onnx


def read_network(path: Path, output: str | None) -> Steps:
    """Return the network of an ``.npz`` or ``.onnx`` file.

    ``output`` names the one that is meant, of an ONNX graph with several. Raises InputError naming
    the file, and key or node, for what cannot be read or has no steps here.
    """
    if path.suffix not in (".npz", ".onnx"):
        raise InputError(f"{path}: a network is an .npz or .onnx file")
    try:
        size = path.stat().st_size
    except OSError as error:
        raise InputError(f"{path}: {error.strerror}") from None
    if size > LARGEST:
        raise InputError(f"{path}: {size} bytes, at most {LARGEST} are read")
    if path.suffix == ".onnx":
        return read_onnx(path, output)
    if output is not None:
        raise InputError(f"{path}: has one output; network_output is for ONNX")
    return read_npz(path)
