"""Draws the block diagrams of the vehicles' pages anew: ``python docs/diagrams.py``."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

IMAGES = Path(__file__).resolve().parent / "images"
DRAWN = {
    "bluerov2": "bluerov2-course-box",
    "gloria": "gloria-triangle",
    "hydrone": "hydrone-landing",
    "mariner": "mariner-course-change",
    "otter": "otter-course-square",
    "thruster-ship": "thruster-ship-move",
    "videoray": "videoray-course-box",
}
"""The trial whose rig is drawn, of each page."""


def draw(vehicle: str, folder: Path = IMAGES) -> Path:
    """Draw the rig of a vehicle's page into a folder, and return the file."""
    path = folder / f"rig-{vehicle}.svg"
    command = [Path(sys.executable).with_name("seatrial"), "describe", DRAWN[vehicle]]
    subprocess.run([*command, "--diagram", str(path), "--quiet"], check=True)
    return path


if __name__ == "__main__":
    for name in DRAWN:
        draw(name)
