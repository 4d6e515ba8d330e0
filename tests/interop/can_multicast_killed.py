"""Program in a network of its own: a run that is killed, and python-can's multicast bus beside it."""

import json
import os
import signal
import subprocess
import sys
import time
from pathlib import Path

import can

GROUP = "239.65.82.9"
RIG = f"""
step = "10 ms"
[components]
bus = {{ fmu = "canbus", set = {{ nodes = "gateway" }} }}
gateway = {{ fmu = "can-gateway", set = {{ link = "python-can:udp_multicast:{GROUP}", safe_state = "09F10D17#FF00FF7F 123#" }} }}
[connections]
"bus.n1" = "gateway.bus"
"""
COMMAND = [sys.executable, "-c", "from seatrial.cli import main; main()", "run", "trial.toml"]
OPTIONS = ["--engine", "direct", "--real-time", "1", "--network", "--out", "run"]
DEADLINE_S = 60.0


def main() -> None:
    Path("rig.toml").write_text(RIG)
    Path("trial.toml").write_text('rig = "rig.toml"\nstop = "1000 s"\n')
    pipe = subprocess.PIPE
    with can.Bus(GROUP, "udp_multicast") as bus:
        run = subprocess.Popen([*COMMAND, *OPTIONS], stdout=pipe, stderr=pipe, text=True)
        deadline = time.monotonic() + DEADLINE_S
        while not Path("run/signals.csv").is_file():
            assert time.monotonic() < deadline
            time.sleep(0.02)
        (child,) = Path(f"/proc/{run.pid}/task/{run.pid}/children").read_text().split()
        os.kill(int(child), signal.SIGKILL)
        _, message = run.communicate(timeout=DEADLINE_S)
        received = [bus.recv(10.0), bus.recv(10.0)]
    frames = [(each.arbitration_id, each.is_extended_id, each.data.hex()) for each in received]
    print(json.dumps({"status": run.returncode, "message": message, "frames": frames}))


if __name__ == "__main__":
    main()
