"""Make a container FMU of an SSP package, run it in FMPy, in a process of its own; prints JSON.

Reads {"package": path, "step": s, "steps": n, "watch": [output of the system]} from standard
input. Prints every step.
"""

from __future__ import annotations

import json
import os
import sys
from pathlib import Path
from typing import Any

from fmpy import simulate_fmu
from fmu_manipulation_toolbox.assembly import Assembly


def run(job: dict[str, Any]) -> list[list[float]]:
    package = Path(job["package"])
    assembly = Assembly(package.name, default_step_size=job["step"], fmu_directory=package.parent)
    assembly.make_fmu()
    made = str(package.with_suffix(".fmu"))
    if not job["watch"]:
        return []
    stop = job["step"] * job["steps"]
    result = simulate_fmu(made, stop_time=stop, output_interval=job["step"], output=job["watch"])
    return [[float(row[name]) for name in job["watch"]] for row in result][1:]


if __name__ == "__main__":
    result = json.dumps(run(json.load(sys.stdin)))
    sys.stdout.write("\n" + result + "\n")
    sys.stdout.flush()
    os._exit(0)
