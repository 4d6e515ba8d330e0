"""Grid files of seabeds and texts of obstacles."""

from __future__ import annotations

import contextlib
import math
import tempfile
from pathlib import Path

from seatrial.errors import InputError
from seatrial_kits.underwater.seabed.grid import read_grid
from seatrial_kits.underwater.seabed.obstacles import read_obstacles
from seatrial_kits.underwater.seabed.scene import Scene


def one(data: bytes) -> None:
    """Read the bytes as each kind of grid and as obstacles; rays come back with a distance."""
    scenes = []
    with tempfile.TemporaryDirectory() as folder:
        for name in ("x.asc", "x.csv"):
            path = Path(folder) / name
            path.write_bytes(data)
            with contextlib.suppress(InputError):
                scenes.append(Scene(read_grid(path)))
    with contextlib.suppress(InputError):
        scenes.append(Scene(None, read_obstacles(data.decode("utf-8", "replace"))))
    for scene in scenes:
        for ray in ((0.0, 0.0, 1.0), (0.6, 0.0, 0.8), (0.0, -1.0, 0.0)):
            hit = scene.ray((1.0, 2.0, 3.0), ray)
            assert hit is None or 0.0 <= hit.distance < math.inf
