"""Pictures of terminals, as files beside the pages."""

from __future__ import annotations

import re
from pathlib import Path

from rich.console import Console

IMAGES = Path(__file__).resolve().parent / "images"
_FONTS = re.compile(r"@font-face \{.*?\}\s*", re.DOTALL)


def draw(console: Console, name: str, title: str) -> None:
    """Draw what ``console`` recorded, without the fonts that a picture would fetch."""
    svg = _FONTS.sub("", console.export_svg(title=title, unique_id=name))
    (IMAGES / f"{name}.svg").write_text(svg, "utf-8")
