"""A vehicle in a thread, at a port, in real time: a stand-in for the one in the water."""

import threading
import time

from seatrial.links.serial_gateway import SerialGateway
from seatrial_kits.videoray.rov import Pro4Rov

STEP = 0.01
WAIT_S = 30.0


class LiveRov:
    """A `Pro4Rov` at ``url``, stepped in real time until the block ends; it does not move."""

    def __init__(self, url, **parameters):
        self.rov, self.gateway = Pro4Rov("rov"), SerialGateway("gateway")
        self.gateway.set("links", url)
        for name, value in parameters.items():
            self.rov.set(name, value)
        for component in (self.rov, self.gateway):
            component.setup(0.0)
            component.initialise()
            component.begin()
        self.rov.set("depth", 3.0)
        self.rov.set("attitude", [0.05, -0.03, 1.0])
        self.at = self.gateway.get("reached_at")
        self.error = None
        self._stop = threading.Event()
        self._thread = threading.Thread(target=self._run)

    def __enter__(self):
        self._thread.start()
        return self

    def __exit__(self, *_):
        self._stop.set()
        self._thread.join(WAIT_S)
        self.gateway.close()
        if self.error is not None:
            raise self.error

    def wait(self, condition):
        deadline = time.monotonic() + WAIT_S
        while not condition():
            assert time.monotonic() < deadline
            time.sleep(0.01)

    def _run(self):
        begun, steps = time.monotonic(), 0
        try:
            while not self._stop.is_set():
                sent, received = self.rov.get("tx"), self.gateway.get("tx")
                self.rov.set("rx", received)
                self.gateway.set("rx", sent)
                for component in (self.rov, self.gateway):
                    component.advance(steps * STEP, STEP)
                steps += 1
                self._stop.wait(max(begun + steps * STEP - time.monotonic(), 0.0))
        except Exception as error:
            self.error = error
