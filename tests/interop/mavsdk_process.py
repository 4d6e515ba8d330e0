"""A trial and MAVSDK, each in a process of its own, until the flight is over."""

from __future__ import annotations

import json
import subprocess
import sys
from pathlib import Path
from typing import Any

from seatrial.trial.records.run_folder import Run

from .running import HOST, free_port, running, wait_for

ROOT = Path(__file__).parents[2]
FACTOR = 4.0
FLIGHT_S = 900.0
"""Wall time in which a flight must be over; the long one takes 70 s on an idle machine."""


def flown(module: str, trial: str, dialect: str, folder: Path) -> tuple[Run, dict[str, Any]]:
    """Return the record, and what the program ``module`` wrote into its log.

    The times for which manual control and set-points are valid are simulated, ``FACTOR`` times shorter to
    their peers: they are longer here.
    """
    port, log, transcript = free_port(), folder / "log.json", folder / "flight.txt"
    given = {
        "links": f"udpout:{HOST}:{port}",
        "autopilot_type": dialect,
        "station_timeout": "30 s",
        "manual_timeout": "5 s",
        "target_timeout": "10 s",
    }
    sets = {f"autopilot__mavlink__{name}": value for name, value in given.items()}
    with running(trial, folder, factor=FACTOR, stop="6000 s", **sets) as started:
        wait_for(lambda: started.is_running, "the trial runs")
        name = f"tests.interop.{module}"
        command = [sys.executable, "-m", name, dialect, f"udpin://{HOST}:{port}", str(log)]
        with transcript.open("wb") as output:
            flight = subprocess.Popen(command, cwd=ROOT, stdout=output, stderr=subprocess.STDOUT)
            try:
                status = flight.wait(FLIGHT_S)
            except subprocess.TimeoutExpired:
                status = None
            finally:
                flight.kill()
                flight.wait()
        assert status == 0, f"status {status}\n{transcript.read_text('utf-8', 'replace')}"
        run = started.stop()
    return run, json.loads(log.read_text("utf-8"))
