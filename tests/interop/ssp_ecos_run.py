"""Run an SSP package in ecos, in a process of its own; prints every step as JSON.

Reads {"package": path, "step": s, "steps": n, "watch": ["component.variable"], "parameters":
name of a parameter set, or null} from standard input.
"""

from __future__ import annotations

import json
import os
import sys
from typing import Any

from ecospy import EcosSimulation


def run(job: dict[str, Any]) -> list[list[float]]:
    simulation = EcosSimulation(step_size=job["step"], ssp_path=job["package"])
    assert simulation.init(parameter_set=job["parameters"])
    names = ["::".join(name.split(".", 1)) for name in job["watch"]]
    rows = []
    for _ in range(job["steps"]):
        simulation.step()
        rows.append([simulation.get_real(name) for name in names])
    return rows


if __name__ == "__main__":
    result = json.dumps(run(json.load(sys.stdin)))
    sys.stdout.write("\n" + result + "\n")
    sys.stdout.flush()
    os._exit(0)  # pythonfmu 0.7's library frees its state twice when it is unloaded
