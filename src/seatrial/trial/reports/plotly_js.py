"""Plotly's JavaScript as pages carry it: packed, two fifths of its size.

``plotly.min.js.z`` is plotly.js 4.1.1 (MIT, as it says itself), of the Python package plotly 7.1.0,
compressed by zlib: of that package pages need this file alone.
"""

from __future__ import annotations

import string
from functools import cache
from pathlib import Path

import numpy as np

from .templates import LESS

_DIGITS = np.frombuffer(
    f"{string.digits}{string.ascii_uppercase}{string.ascii_lowercase}!#$%&()*+-;<=>?@^_`{{|}}~".encode(),
    np.uint8,
)
_WEIGHTS = 85 ** np.arange(4, -1, -1, dtype=np.uint32)
FILE = Path(__file__).with_name("plotly.min.js.z")


@cache
def plotly_js() -> str:
    """Return the library for a script element of a page; the page inflates it."""
    return _base85(FILE.read_bytes()).replace(b"<", LESS).decode("ascii")


def _base85(data: bytes) -> bytes:
    """Return what `base64.b85encode` does, a hundred times as fast."""
    padding = -len(data) % 4
    words = np.frombuffer(data + bytes(padding), ">u4")
    digits = words[:, np.newaxis] // _WEIGHTS % 85
    return _DIGITS[digits].tobytes()[: len(words) * 5 - padding]
