"""Run a system of FMUs in libcosim, in a process of its own; prints every step as JSON.

Reads {"slaves": [{"name", "path", "real": {vr: value}, "string": {...}}], "wires":
[[from, vr, to, vr, type]], "step": s, "steps": n, "watch": [[slave, vr]]} from standard input.
"""

from __future__ import annotations

import json
import os
import sys
from typing import Any

from libcosimpy.CosimExecution import CosimExecution
from libcosimpy.CosimLogging import CosimLogLevel, log_output_level
from libcosimpy.CosimObserver import CosimObserver
from libcosimpy.CosimSlave import CosimLocalSlave


def assembled(job: dict[str, Any]) -> tuple[CosimExecution, dict[str, int], CosimObserver]:
    """Return the system, the indices of its slaves by name, and an observer of their values."""
    log_output_level(CosimLogLevel.WARNING)
    execution = CosimExecution.from_step_size(round(job["step"] * 1e9))
    index = {}
    for slave in job["slaves"]:
        local = CosimLocalSlave(fmu_path=slave["path"], instance_name=slave["name"])
        index[slave["name"]] = number = execution.add_local_slave(local_slave=local)
        for kind in ("real", "integer", "boolean", "string"):
            set_initial = getattr(execution, f"{kind}_initial_value")
            for reference, value in slave[kind].items():
                assert set_initial(number, int(reference), value)
    for source, vr_out, target, vr_in, kind in job["wires"]:
        connect = getattr(execution, f"connect_{kind}_variables")
        assert connect(index[source], vr_out, index[target], vr_in) == 0
    observer = CosimObserver.create_last_value()
    assert execution.add_observer(observer=observer)
    return execution, index, observer


def run(job: dict[str, Any]) -> list[list[float]]:
    execution, index, observer = assembled(job)
    groups = [(index[name], references) for name, references in job["watch"]]

    def row() -> list[float]:
        return [v for n, refs in groups for v in observer.last_real_values(n, refs)]

    execution.step()  # libcosim initialises with its first step
    rows = [row()]
    for _ in range(job["steps"] - 1):
        execution.step()
        rows.append(row())
    return rows


if __name__ == "__main__":
    result = json.dumps(run(json.load(sys.stdin)))
    sys.stdout.write("\n" + result + "\n")
    sys.stdout.flush()
    os._exit(0)  # pythonfmu 0.7's library frees its state twice when it is unloaded
