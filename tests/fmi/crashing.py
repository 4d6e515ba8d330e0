"""A component that ends its own process, or never returns; the C slave's ways to do so."""

FINE, SEGFAULT, ABORT, EXIT, HANG, PRINT, LOG, REFUSE, DIE_AT_THE_END, DIE_IN_THE_RELEASE = range(
    10
)
"""What the C slave's ``how`` makes of its steps from t = 0.25 s, or of its last calls."""

CRASHING = '''
"""Ends its process, or never returns."""
import ctypes
import os
import signal
import sys
import time

from seatrial.model.component import Component, Input, Output, Parameter


class Crashing(Component):
    """Counts its steps until t = 0.3 s."""

    how = Parameter("fine", "1", "what then")
    u = Input("m", "input")
    steps = Output("1", "steps", type=int)

    def __init__(self, name):
        super().__init__(name)
        if "NO_BOAT" in os.environ:
            raise RuntimeError("there is no boat")

    def start(self, t):
        self.count = 0
        if self.how == "at the start":
            os._exit(4)

    def step(self, t, h):
        self.count += 1
        if t > 0.29:
            self.end()

    def end(self):
        if self.how == "exit":
            os._exit(3)
        if self.how == "segfault":
            ctypes.string_at(0)
        if self.how == "kill":
            os.kill(os.getpid(), signal.SIGKILL)
        while self.how == "spin":
            pass
        if self.how == "sleep":
            time.sleep(1000.0)
        if self.how == "scribble":
            os.write(int(sys.argv[2]), b"x" * 100)
        if self.how == "raise":
            raise ValueError("the boat has sunk")
        if self.how == "interrupt":
            raise KeyboardInterrupt
        if self.how == "print":
            print("from Python")

    def outputs(self, t):
        self.steps = self.count
'''
