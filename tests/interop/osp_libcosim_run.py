"""Run an OspSystemStructure.xml in libcosim, in a process of its own; prints every step as JSON.

Reads {"file", "steps", "watch": [[slave, type, references]], "scenario": file, "times": true} from
standard input; with times, each row begins with that of its step, ns.
"""

from __future__ import annotations

import json
import os
import sys
from typing import Any

from libcosimpy.CosimExecution import CosimExecution
from libcosimpy.CosimLogging import CosimLogLevel, log_output_level
from libcosimpy.CosimManipulator import CosimManipulator
from libcosimpy.CosimObserver import CosimObserver


def run(job: dict[str, Any]) -> list[list[Any]]:
    log_output_level(CosimLogLevel.WARNING)
    execution = CosimExecution.from_osp_config_file(osp_path=job["file"])
    observer = CosimObserver.create_last_value()
    assert execution.add_observer(observer=observer)
    if job.get("scenario"):
        manager = CosimManipulator.create_scenario_manager()
        assert execution.add_manipulator(manipulator=manager)
        assert execution.load_scenario(manipulator=manager, scenario_file=job["scenario"])
    watch = [
        (
            getattr(observer, f"last_{kind}_values"),
            execution.slave_index_from_instance_name(slave),
            references,
        )
        for slave, kind, references in job["watch"]
    ]
    rows = []
    for _ in range(job["steps"]):
        assert execution.step()
        values = [value for read, slave, refs in watch for value in read(slave, refs)]
        if job.get("times"):
            values = [execution.status().current_time, *values]
        rows.append([v.decode() if isinstance(v, bytes) else v for v in values])
    return rows


if __name__ == "__main__":
    result = json.dumps(run(json.load(sys.stdin)))
    sys.stdout.write("\n" + result + "\n")
    sys.stdout.flush()
    os._exit(0)  # pythonfmu 0.7's library frees its state twice when it is unloaded
