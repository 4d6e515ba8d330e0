"""Networks as plain layers, in NumPy's ``.npz``."""

from __future__ import annotations

import re
import zipfile
import zlib
from pathlib import Path
from typing import Any

import numpy as np

from seatrial.errors import InputError, unknown

from .network import LARGEST, Array, Steps

_LAYER = re.compile(r"([Wb])(0|[1-9]\d{0,3})")
_SCALES = ("input_mean", "input_scale", "output_mean", "output_scale", "input_low", "input_high")
_KEYS = ("W0", "b0", "W1", "b1", "activations", *_SCALES)


def read_npz(path: Path) -> Steps:
    """Return the network of ``path``.

    Arrays ``W0``, ``b0``, ``W1``, ``b1`` ... are weights, a row for each output of the layer, and
    offsets; ``activations`` has a text for each layer. Optional, a number for each: the network
    takes (x - ``input_mean``) / ``input_scale``, and y ``output_scale`` + ``output_mean`` comes out
    of it; x was between ``input_low`` and ``input_high`` in training.

    Raises InputError naming file and key.
    """
    arrays = _arrays(path)
    layers = sum(name.startswith("W") for name in arrays)
    for number in range(layers):
        for key in (f"W{number}", f"b{number}"):
            if key not in arrays:
                raise InputError(f"{path}: {key}: is not there; the keys are {', '.join(arrays)}")
    if not layers or len([name for name in arrays if _LAYER.fullmatch(name)]) != 2 * layers:
        raise InputError(
            f"{path}: weights W0, W1, ... and as many offsets b0, b1, ... are needed; the keys are "
            f"{', '.join(arrays) or 'none'}"
        )
    weights = [_numbers(arrays, path, f"W{number}", 2) for number in range(layers)]
    found = Steps(weights[0].shape[1])
    _scale(found, arrays, path, "input")
    texts = _activations(arrays, path, layers)
    for number, each in enumerate(weights):
        offsets = _numbers(arrays, path, f"b{number}", 1)
        found.dense(each, offsets, f"{path}: W{number}, b{number}")
        found.activate_as(texts[number], f"{path}: activations[{number}]")
    _scale(found, arrays, path, "output")
    _ranges(found, arrays, path)
    return found


def _arrays(path: Path) -> dict[str, Any]:
    try:
        with zipfile.ZipFile(path) as archive:
            size = sum(each.file_size for each in archive.infolist())
        if size > LARGEST:
            raise InputError(f"{path}: {size} bytes unpacked, at most {LARGEST} are read")
        with np.load(path, allow_pickle=False) as file:
            arrays = {name: file[name] for name in file.files}
    except (zipfile.BadZipFile, zlib.error, EOFError, KeyError, NotImplementedError) as error:
        raise InputError(f"{path}: not an .npz file, or cut: {error}") from None
    except (OSError, ValueError, RuntimeError) as error:
        raise InputError(f"{path}: cannot be read: {error}") from None
    for name in arrays:
        if not _LAYER.fullmatch(name) and name not in _KEYS:
            raise InputError(f"{path}: {unknown('key', name, _KEYS)}")
    return arrays


def _numbers(arrays: dict[str, Any], path: Path, key: str, axes: int) -> Array:
    """Return an array of numbers. Raises InputError for another kind, or number of axes."""
    array = arrays[key]
    if array.dtype.kind not in "fiu":
        raise InputError(f"{path}: {key}: numbers are needed, found {array.dtype}")
    if array.ndim != axes or not array.size:
        what = "a matrix" if axes == 2 else "a row of numbers"
        raise InputError(f"{path}: {key}: {what} is needed, found shape {array.shape}")
    return np.asarray(array, dtype=np.float64)


def _activations(arrays: dict[str, Any], path: Path, layers: int) -> list[str]:
    where = f"{path}: activations"
    if "activations" not in arrays:
        raise InputError(f"{where}: is not there: a text for each layer, such as 'tanh'")
    array = np.atleast_1d(arrays["activations"])
    if array.dtype.kind != "U":
        raise InputError(f"{where}: texts are needed, found {array.dtype}")
    if array.shape != (layers,):
        raise InputError(f"{where}: {layers} are needed, one for each layer, found {array.size}")
    return [str(each) for each in array]


def _scale(found: Steps, arrays: dict[str, Any], path: Path, side: str) -> None:
    mean, scale = np.zeros(found.outputs), np.ones(found.outputs)
    keys = [key for key in (f"{side}_mean", f"{side}_scale") if key in arrays]
    for key in keys:
        array = _numbers(arrays, path, key, 1)
        if array.shape != mean.shape:
            raise InputError(f"{path}: {key}: {len(mean)} are needed, found {len(array)}")
        if key.endswith("mean"):
            mean = array
        else:
            scale = array
    where = f"{path}: {', '.join(keys)}"
    if side == "output":
        found.scale(scale, mean, where)
        return
    if not np.all(scale):
        raise InputError(f"{path}: input_scale: what is divided by is 0")
    found.scale(1.0 / scale, -mean / scale, where)


def _ranges(found: Steps, arrays: dict[str, Any], path: Path) -> None:
    keys = [key for key in ("input_low", "input_high") if key in arrays]
    if not keys:
        return
    if len(keys) == 1:
        raise InputError(f"{path}: {keys[0]}: input_low and input_high are needed, both or none")
    low, high = (_numbers(arrays, path, key, 1) for key in keys)
    for key, array in zip(keys, (low, high), strict=True):
        if len(array) != found.inputs:
            raise InputError(f"{path}: {key}: {found.inputs} are needed, found {len(array)}")
    if not np.all(low <= high):
        place = int(np.argmin(low <= high))
        raise InputError(f"{path}: input_low, input_high: {low[place]} to {high[place]} at {place}")
    found.low, found.high = low, high
