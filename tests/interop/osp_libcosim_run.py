"""Run an OspSystemStructure.xml in libcosim, in a process of its own; prints outputs as JSON.

Reads {"file", "slave", "references", "steps"} from standard input.
"""

from __future__ import annotations

import json
import os
import sys

from libcosimpy.CosimExecution import CosimExecution
from libcosimpy.CosimLogging import CosimLogLevel, log_output_level
from libcosimpy.CosimObserver import CosimObserver

if __name__ == "__main__":
    job = json.load(sys.stdin)
    log_output_level(CosimLogLevel.WARNING)
    execution = CosimExecution.from_osp_config_file(osp_path=job["file"])
    observer = CosimObserver.create_last_value()
    execution.add_observer(observer=observer)
    for _ in range(job["steps"]):
        execution.step()
    slave = execution.slave_index_from_instance_name(job["slave"])
    sys.stdout.write("\n" + json.dumps(observer.last_real_values(slave, job["references"])) + "\n")
    sys.stdout.flush()
    os._exit(0)  # pythonfmu 0.7's library frees its state twice when it is unloaded
