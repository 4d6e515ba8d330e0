"""Run an SSP package in libcosim, in a process of its own; prints every step as JSON.

Reads {"package": path, "steps": n, "watch": ["component.variable"]} from standard input.
"""

from __future__ import annotations

import json
import os
import sys
from typing import Any

from libcosimpy.CosimExecution import CosimExecution
from libcosimpy.CosimLogging import CosimLogLevel, log_output_level
from libcosimpy.CosimObserver import CosimObserver


def run(job: dict[str, Any]) -> list[list[float]]:
    log_output_level(CosimLogLevel.WARNING)
    execution = CosimExecution.from_ssp_file(job["package"])
    observer = CosimObserver.create_last_value()
    assert execution.add_observer(observer=observer)
    references = {
        f"{slave.name.decode()}.{variable.name.decode()}": (slave.index, variable.reference)
        for slave in execution.slave_infos()
        for variable in execution.slave_variables(slave.index)
    }
    places = [references[name] for name in job["watch"]]
    rows = []
    for _ in range(job["steps"]):  # libcosim initialises with its first step
        execution.step()
        rows.append([observer.last_real_values(index, [ref])[0] for index, ref in places])
    return rows


if __name__ == "__main__":
    result = json.dumps(run(json.load(sys.stdin)))
    sys.stdout.write("\n" + result + "\n")
    sys.stdout.flush()
    os._exit(0)  # pythonfmu 0.7's library frees its state twice when it is unloaded
