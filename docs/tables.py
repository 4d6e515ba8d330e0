"""The parts of the pages that come from code, parameter files and runs.

``python docs/tables.py`` writes them anew, or those of the pages named; ``--check`` only says
which are out of date (status 1). A part stands between a comment that names it and a comment that
ends it; nothing else of a page is touched.
"""

from __future__ import annotations

import re
import sys
from collections.abc import Sequence
from functools import partial
from pathlib import Path

DOCS = Path(__file__).resolve().parent
sys.path.insert(0, str(DOCS))  # also when this file is loaded by its path

from parts import (  # noqa: E402, F401  each registers its parts
    PARTS,
    ais,
    can,
    can_signals,
    dronecan,
    faults,
    hydrone,
    hydrone_deck,
    logs,
    mavlink,
    measured,
    native,
    nmea0183,
    nmea2000,
    profile,
    reference,
    sea_trials,
    settings,
    ships,
    tether,
    vehicles,
    videoray_actuation,
    videoray_control,
    videoray_stream,
)

PART = re.compile(
    r"(?P<begin><!-- made by docs/tables\.py: (?P<name>[\w-]+) -->\n).*?(?P<end><!-- end -->)",
    re.DOTALL,
)


def pages() -> dict[Path, list[str]]:
    """Return the parts that each page has."""
    found = {}
    for page in sorted(DOCS.rglob("*.md")):
        names = [m["name"] for m in PART.finditer(page.read_text("utf-8"))]
        if names:
            found[page] = names
    return found


def made(name: str) -> str:
    """Return the part ``name`` as code, files and runs have it now."""
    return PARTS[name]()


def written(page: Path, name: str) -> str:
    """Return the part ``name`` as the page has it."""
    return next(
        m.group()[len(m["begin"]) : -len(m["end"])]
        for m in PART.finditer(page.read_text("utf-8"))
        if m["name"] == name
    )


def _anew(parts: dict[str, str], found: re.Match[str]) -> str:
    return found["begin"] + parts[found["name"]] + found["end"]


def main(arguments: Sequence[str]) -> int:
    """Write parts anew, or with ``--check`` only compare; return the exit status."""
    stale = []
    named = {(DOCS / name).resolve() for name in arguments if name != "--check"}
    if unknown := named - pages().keys():
        print(f"no page with tables: {', '.join(sorted(map(str, unknown)))}", file=sys.stderr)
        return 2
    for page, names in pages().items():
        if named and page not in named:
            continue
        text, parts = page.read_text("utf-8"), {name: made(name) for name in names}
        stale += [f"{page.relative_to(DOCS)}: {n}" for n in names if written(page, n) != parts[n]]
        if "--check" not in arguments:
            page.write_text(PART.sub(partial(_anew, parts), text), "utf-8")
    for place in stale:
        print(("out of date: " if "--check" in arguments else "written: ") + place)
    return 1 if stale and "--check" in arguments else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
