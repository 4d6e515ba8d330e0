"""Text and bytes as pages carry them: deflated, in base 85; `templates/figures.js` unpacks them."""

from __future__ import annotations

import base64
import zlib

LESS = b","
"""For ``<``, which would begin a tag; Python's alphabet has no comma."""


def packed(content: str | bytes) -> str:
    """Return content as text for an element of a page or a string of JavaScript, unescaped.

    Letters are those of `base64.b85encode`, with a comma for ``<``; below is zlib's format.
    """
    data = content.encode() if isinstance(content, str) else content
    return base64.b85encode(zlib.compress(data, 9)).replace(b"<", LESS).decode("ascii")
