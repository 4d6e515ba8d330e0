"""The program of docs/kits/mavlink/ground-stations.md, as it stands, with the trial made of FMUs."""

from __future__ import annotations

import re
import subprocess
import sys
from pathlib import Path

import numpy as np

from .running import HOST, free_port, running, wait_for

PAGE = Path(__file__).parents[2] / "docs/kits/mavlink/ground-stations.md"
METRE = 90e-7 * np.pi / 180.0 * 6.378e6
"""What the page takes for one, on a sphere."""


def test_the_program_of_the_page(tmp_path: Path) -> None:
    found = re.search(
        r"^`triangle.py`:\n\n```python\n(.*?)^```$", PAGE.read_text("utf-8"), re.S | re.M
    )
    assert found is not None
    program, port = tmp_path / "triangle.py", free_port()
    program.write_text(found[1], "utf-8")
    links = f"udpout:{HOST}:{port}"
    with running(
        "hydrone-mission", tmp_path, factor=4.0, engine="fmu", autopilot__mavlink__links=links
    ) as trial:
        wait_for(lambda: trial.is_running, "the trial runs", 180.0)
        command = [sys.executable, str(program), f"udpin://{HOST}:{port}"]
        done = subprocess.run(command, capture_output=True, text=True, timeout=300, check=False)
        assert done.returncode == 0, done.stdout + done.stderr
        run = trial.stop()
    assert "of 4" in done.stdout
    assert done.stdout.rstrip().endswith("home")
    x, y = (run.signals[f"vehicle.hull.position.{axis}"] for axis in "xy")
    east = 10.0 * METRE * np.cos(np.radians(31.78))
    for north, to_east in ((10.0 * METRE, 0.0), (10.0 * METRE, east)):
        assert np.hypot(x - north, y - to_east).min() <= 2.1
    assert np.hypot(x[-1], y[-1]) <= 3.5
    assert not run.signals["autopilot.mavlink.armed"][-1]
