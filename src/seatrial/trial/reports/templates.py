"""The templates of this package's pages and drawings; what is put into them is escaped."""

from __future__ import annotations

import contextlib
from functools import cache
from pathlib import Path

from jinja2 import Environment, FileSystemBytecodeCache, FileSystemLoader, StrictUndefined
from jinja2.bccache import Bucket

from ...fmi.cache import cache_folder
from ...model.readable import number
from ...whole_file import write_whole
from .packed import packed


class _Compiled(FileSystemBytecodeCache):
    """Compiled templates; Jinja's own would write them for their user alone."""

    def dump_bytecode(self, bucket: Bucket) -> None:
        with contextlib.suppress(OSError):
            write_whole(Path(self._get_cache_filename(bucket)), bucket.bytecode_to_string())


@cache
def environment() -> Environment:
    """Return the templates, with their compiled form in the user's cache."""
    found = Environment(
        loader=FileSystemLoader(Path(__file__).parent / "templates"),
        autoescape=True,
        undefined=StrictUndefined,
        trim_blocks=True,
        bytecode_cache=_Compiled(str(cache_folder("pages"))),
    )
    found.filters["number"] = number
    found.filters["packed"] = packed
    return found
