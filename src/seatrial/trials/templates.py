"""The templates of this package's pages and drawings; what is put into them is escaped."""

from __future__ import annotations

from functools import cache
from pathlib import Path

from jinja2 import Environment, FileSystemBytecodeCache, FileSystemLoader, StrictUndefined

from ..fmi.cache import cache_folder
from .packed import packed
from .readable import number


@cache
def environment() -> Environment:
    """Return the templates, with their compiled form in the user's cache."""
    found = Environment(
        loader=FileSystemLoader(Path(__file__).parent / "templates"),
        autoescape=True,
        undefined=StrictUndefined,
        trim_blocks=True,
        bytecode_cache=FileSystemBytecodeCache(str(cache_folder("pages"))),
    )
    found.filters["number"] = number
    found.filters["packed"] = packed
    return found
