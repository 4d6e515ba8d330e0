"""Run an SSP package in FMPy, in a process of its own; prints every step as JSON.

Reads {"package": path, "step": s, "steps": n, "watch": ["component.variable"]} from standard
input.
"""

from __future__ import annotations

import json
import os
import sys
from typing import Any

from fmpy.ssp.simulation import simulate_ssp


def run(job: dict[str, Any]) -> list[list[float]]:
    stop = job["step"] * (job["steps"] - 0.5)  # FMPy adds up its time
    result = simulate_ssp(job["package"], stop_time=stop, step_size=job["step"])
    return [[float(row[name]) for name in job["watch"]] for row in result]


if __name__ == "__main__":
    result = json.dumps(run(json.load(sys.stdin)))
    sys.stdout.write("\n" + result + "\n")
    sys.stdout.flush()
    os._exit(0)  # pythonfmu 0.7's library frees its state twice when it is unloaded
