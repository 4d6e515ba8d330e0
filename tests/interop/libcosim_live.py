"""Let libcosim pace a system of FMUs in real time; prints what it reads, until it is told to stop.

The first line of standard input is a job as `libcosim_run` has it, but with "watch": {type:
[[slave, vr]]}. A line of JSON is printed every 0.1 s of simulated time. At any further line the
system is destroyed, and "port" of the job is bound, to see that it is free again.
"""

from __future__ import annotations

import json
import os
import select
import socket
import sys
from typing import Any

from .libcosim_run import assembled

_EVERY_NS = 100_000_000


def live(job: dict[str, Any]) -> None:
    execution, index, observer = assembled(job)
    assert execution.real_time_simulation_enabled(True)
    until = 0
    while not select.select([sys.stdin], [], [], 0.0)[0]:
        until += _EVERY_NS
        assert execution.simulate_until(until)
        row = {}
        for kind, watched in job["watch"].items():
            for name, reference in watched:
                (value,) = getattr(observer, f"last_{kind}_values")(index[name], [reference])
                row[reference] = value.decode() if isinstance(value, bytes) else value
        print(json.dumps(row), flush=True)


def is_free(port: int) -> bool:
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as probe:
        try:
            probe.bind(("127.0.0.1", port))
        except OSError:
            return False
    return True


if __name__ == "__main__":
    given = json.loads(sys.stdin.readline())
    live(given)
    print("free" if is_free(given["port"]) else "in use", flush=True)
    os._exit(0)  # pythonfmu 0.7's library frees its state twice when it is unloaded
