"""Links from the keys of works on every page to their entries in the bibliography."""

from __future__ import annotations

import os
import re
from pathlib import Path, PurePosixPath

from mkdocs.config.defaults import MkDocsConfig
from mkdocs.structure.files import Files
from mkdocs.structure.pages import Page

BIBLIOGRAPHY = "bibliography.md"
ENTRY = re.compile(r"^- \*\*\[(\w+)\]\*\*", re.MULTILINE)


def on_page_markdown(markdown: str, page: Page, config: MkDocsConfig, files: Files) -> str:
    """Return a page with link definitions of the keys; the bibliography, with their anchors."""
    if page.file.src_uri == BIBLIOGRAPHY:
        return ENTRY.sub(lambda entry: f'- <a id="{entry[1]}"></a>**\\[{entry[1]}\\]**', markdown)
    keys = ENTRY.findall((Path(config.docs_dir) / BIBLIOGRAPHY).read_text("utf-8"))
    target = os.path.relpath(BIBLIOGRAPHY, PurePosixPath(page.file.src_uri).parent)
    used = (key for key in keys if f"[{key}]" in markdown)
    return "\n".join([markdown, "", *(f"[{key}]: {target}#{key}" for key in used)])
