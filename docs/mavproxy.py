"""Draws images/mavproxy.svg anew: ``python docs/mavproxy.py`` holds the session of the page."""

from __future__ import annotations

import io
import re
import sys
import tempfile
from pathlib import Path

from rich.console import Console
from rich.text import Text

DOCS = Path(__file__).resolve().parent
sys.path.insert(0, str(DOCS.parent))  # the tests, which hold the same session

from tests.interop.mavproxy_page import follow, session  # noqa: E402

WIDTH = 84
_NOISE = re.compile(r"^(?:[A-Z]+> )+| t=.*$")
"""Prompts, which stand before what is said next, and wall times."""
_FONTS = re.compile(r"@font-face \{.*?\}\s*", re.S)


def lines(prompt: str, typed: str, said: str) -> list[Text]:
    """Return what was typed and what was said then, as a terminal shows it."""
    shown = [Text.assemble((f"{prompt}> ", "green"), (typed, "bold"))]
    for line in (_NOISE.sub("", each) for each in said.splitlines()):
        shown += [Text(line, "cyan" if line.startswith("AP: ") else "")] if line else []
    return shown


def main() -> None:
    """Hold the session, and draw it."""
    with tempfile.TemporaryDirectory() as folder, session(Path(folder)) as proxy:
        held = follow(proxy)
    console = Console(record=True, width=WIDTH, file=io.StringIO())
    for step in held:
        for line in lines(*step):
            console.print(line)
    # Without the fonts that it would fetch from elsewhere.
    svg = _FONTS.sub("", console.export_svg(title="MAVProxy", unique_id="mavproxy"))
    (DOCS / "images" / "mavproxy.svg").write_text(svg, "utf-8")


if __name__ == "__main__":
    main()
