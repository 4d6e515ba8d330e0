"""The templates of pages and drawings, here and in kits; what is put into them is escaped."""

from __future__ import annotations

import base64
import contextlib
import zlib
from functools import cache
from pathlib import Path

from jinja2 import Environment, FileSystemBytecodeCache, FileSystemLoader, StrictUndefined
from jinja2.bccache import Bucket

from ...files.whole_file import write_whole
from ...fmi.cache import cache_folder
from ...kits import kits
from ...model.readable import number

FOLDER = "templates"
"""Beside this module, and beside the manifest of a kit whose pages have templates of their own."""


class _Compiled(FileSystemBytecodeCache):
    """Compiled templates; Jinja's own would write them for their user alone."""

    def dump_bytecode(self, bucket: Bucket) -> None:
        with contextlib.suppress(OSError):
            write_whole(Path(self._get_cache_filename(bucket)), bucket.bytecode_to_string())


def _of_kits() -> list[Path]:
    return [kit.folder / FOLDER for kit in kits().found]


@cache
def environment() -> Environment:
    """Return the templates, with their compiled form in the user's cache."""
    found = Environment(
        loader=FileSystemLoader([Path(__file__).parent / FOLDER, *_of_kits()]),
        autoescape=True,
        undefined=StrictUndefined,
        trim_blocks=True,
        bytecode_cache=_Compiled(str(cache_folder("pages"))),
    )
    found.filters["number"] = number
    found.filters["packed"] = packed
    return found


LESS = b","
"""For ``<``, which would begin a tag; Python's alphabet has no comma."""


def packed(content: str | bytes) -> str:
    """Return content as text for an element of a page or a string of JavaScript, unescaped.

    Letters are those of `base64.b85encode`, with a comma for ``<``; below is zlib's format.
    """
    data = content.encode() if isinstance(content, str) else content
    return base64.b85encode(zlib.compress(data, 9)).replace(b"<", LESS).decode("ascii")
