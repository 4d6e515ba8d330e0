"""Headers that a sketch includes in another case than they have: Windows and macOS do not mind."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

from .libraries import ASSEMBLY, included, read_source
from .sketch import Sketch

_OF_C = ("ctype.h", "inttypes.h", "math.h", "stdint.h", "stdio.h", "stdlib.h", "string.h")


def with_other_cases(sketch: Sketch, command: list[str], place: Path) -> Sketch:
    """Return a sketch with one more folder, ``place``, of headers under the names that it includes.

    ``command`` is the compiler with its folders of headers. Each header in ``place`` includes the
    one whose name differs in case alone; without any the sketch is as it was.
    """
    folders = [Path(each[2:]) for each in command if each.startswith("-I")]
    names = [f.name for each in folders if each.is_dir() for f in each.iterdir()]
    by_case = {name.casefold(): name for name in (*names, *_OF_C) if name.endswith((".h", ".hpp"))}
    known = {*names, *_OF_C}
    made: set[str] = set()
    for file in sketch.files():
        if file.suffix in ASSEMBLY:
            continue
        for header, _ in included(read_source(file)):
            other = by_case.get(header.casefold())
            if other and header not in known | made and not (file.parent / header).is_file():
                place.mkdir(exist_ok=True)
                (place / header).write_text(f"#include <{other}>\n", "utf-8")
                made.add(header)
    return replace(sketch, flags=(*sketch.flags, f"-I{place}")) if made else sketch
