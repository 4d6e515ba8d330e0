"""Networks as plain layers, in NumPy's ``.npz``."""

from __future__ import annotations

import re
import zipfile
import zlib
from pathlib import Path
from typing import Any

import numpy as np

from seatrial.errors import InputError, unknown

from .network import LARGEST, Array, Steps, finite

_LAYER = re.compile(r"([Wb])(0|[1-9]\d{0,3})")
_SCALES = ("input_mean", "input_scale", "output_mean", "output_scale")
_LIMITS = ("input_low", "input_high", "output_low", "output_high")
_KEYS = ("W0", "b0", "W1", "b1", "activations", *_SCALES, *_LIMITS)


def read_npz(path: Path) -> Steps:
    """Return the network of ``path``.

    Arrays ``W0``, ``b0``, ``W1``, ``b1`` ... are weights, a row for each output of the layer, and
    offsets; ``activations`` has a text for each layer. Optional, a number for each: the network
    takes (x - ``input_mean``) / ``input_scale``, and y ``output_scale`` + ``output_mean`` comes out
    of it; x was between ``input_low`` and ``input_high`` in training, and what comes out is limited
    to ``output_low`` to ``output_high``.

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
    if (limits := _limits(arrays, path, "output", found.outputs)) is not None:
        low, high = limits
        middle, half = (low + high) / 2.0, (high - low) / 2.0
        shrink = np.divide(1.0, half, out=np.zeros_like(half), where=half > 0.0)
        where = f"{path}: output_low, output_high"
        found.scale(shrink, -middle * shrink, where)
        found.clip(-1.0, 1.0, where)
        found.scale(half, middle, where)
    if (limits := _limits(arrays, path, "input", found.inputs)) is not None:
        found.low, found.high = limits
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


def _limits(arrays: dict[str, Any], path: Path, side: str, size: int) -> tuple[Array, Array] | None:
    """Return lowest and highest values of the inputs or outputs, if the file has them."""
    both = f"{side}_low", f"{side}_high"
    keys = [key for key in both if key in arrays]
    if not keys:
        return None
    if len(keys) == 1:
        raise InputError(f"{path}: {keys[0]}: {' and '.join(both)} are needed, both or none")
    low, high = (_numbers(arrays, path, key, 1) for key in keys)
    for key, array in zip(keys, (low, high), strict=True):
        if len(finite(array, f"{path}: {key}")) != size:
            raise InputError(f"{path}: {key}: {size} are needed, found {len(array)}")
    if not np.all(low <= high):
        place = int(np.argmin(low <= high))
        raise InputError(f"{path}: {', '.join(both)}: {low[place]} to {high[place]} at {place}")
    return low, high
