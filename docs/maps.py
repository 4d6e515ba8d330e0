"""The figure of a campaign's map, as on its page: ``python docs/maps.py CAMPAIGN`` makes it anew.

With the folder of a run of that campaign, ``python docs/maps.py CAMPAIGN FOLDER``, it is made of
that. Needs Debian's chromium.
"""

from __future__ import annotations

import subprocess
import sys
import tempfile
from pathlib import Path

from playwright.sync_api import sync_playwright

from seatrial_kits.campaigns.results.page import write_table_page

IMAGES = Path(__file__).resolve().parent / "images"
_SEATRIAL = "from seatrial.cli import main; main()"
_WIDTH = 960
_PATIENCE_MS = 120_000


def drawn(folder: Path, target: Path) -> None:
    """Write the page of a campaign's folder, and its map as a picture."""
    page = write_table_page(folder).resolve()
    with sync_playwright() as playwright:
        browser = playwright.chromium.launch(
            executable_path="/usr/bin/chromium", args=["--no-sandbox", "--disable-gpu"]
        )
        tab = browser.new_page(viewport={"width": _WIDTH, "height": 1200}, device_scale_factor=1.5)
        tab.goto(page.as_uri())
        tab.wait_for_selector(".map .main-svg", timeout=_PATIENCE_MS)
        tab.locator(".map .figure").screenshot(path=str(target))
        browser.close()


def main() -> None:
    """Run the campaign, unless there is a folder, and draw its map."""
    name, *folders = sys.argv[1:]
    with tempfile.TemporaryDirectory() as place:
        folder = Path(folders[0]) if folders else Path(place, "run")
        if not folders:
            command = ["run", name, "--engine", "direct", "--out", str(folder), "--no-report"]
            subprocess.run([sys.executable, "-c", _SEATRIAL, *command], check=False)
        drawn(folder, IMAGES / f"{name}.png")


if __name__ == "__main__":
    main()
