"""Plotly's JavaScript as pages carry it: packed, two fifths of its size.

``plotly.min.js.z`` is plotly.js 4.1.1 (MIT, as it says itself), of the Python package plotly 7.1.0,
compressed by zlib: of that package pages need this file alone.
"""

from __future__ import annotations

import base64
from functools import cache
from pathlib import Path

from .templates import LESS

FILE = Path(__file__).with_name("plotly.min.js.z")


@cache
def plotly_js() -> str:
    """Return the library for a script element of a page; the page inflates it."""
    return base64.b85encode(FILE.read_bytes()).replace(b"<", LESS).decode("ascii")
