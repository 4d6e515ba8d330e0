"""Program in a network of its own: our node behind a gateway, the dronecan package's at mcast:0."""

import json
import threading
import time

import dronecan
from dronecan import uavcan

from seatrial_kits.can.component import CanBus
from seatrial_kits.can.component_gateway import CanGateway
from seatrial_kits.can.dronecan.peripheral import DroneCanPeripheral
from tests.kits.can.dronecan.bench import made

STEP = 0.002
DEADLINE_S = 60.0


def simulate(node, gateway, bus, stop):
    """Step in real time, about."""
    now_ns = 0
    while not stop.is_set():
        texts = [node.get("tx"), gateway.get("tx")]
        node.set("rx", bus.get("rx.n1"))
        gateway.set("rx", bus.get("rx.n2"))
        bus.set("tx.n1", texts[0])
        bus.set("tx.n2", texts[1])
        for each in (node, gateway, bus):
            each.advance(now_ns / 1e9, STEP)
        now_ns += round(STEP * 1e9)
        time.sleep(STEP)


def main() -> None:
    node = made(DroneCanPeripheral, "esc", node_id=10.0)
    gateway = made(CanGateway, "gateway", link="dronecan-multicast:0")
    bus = made(CanBus, "can", nodes="esc gateway", bit_rate=1e6)
    for each in (node, gateway, bus):
        each.setup(0.0)
        each.initialise()
        each.begin()
    stop = threading.Event()
    peer = dronecan.make_node("mcast:0", node_id=100)
    thread = threading.Thread(target=simulate, args=(node, gateway, bus, stop))
    thread.start()
    found = {"names": [], "health": []}
    end = time.monotonic() + DEADLINE_S

    def named(event) -> None:
        if event is not None:
            found["names"].append(event.response.name.decode())

    def status(event) -> None:
        if event.transfer.source_node_id == 10:
            found["health"].append(event.message.health)

    peer.add_handler(uavcan.protocol.NodeStatus, status)
    try:
        while not (found["names"] and found["health"] and found.get("command")):
            assert time.monotonic() < end, found
            peer.broadcast(uavcan.equipment.esc.RawCommand(cmd=[4096]))
            if not found["names"]:  # in seven frames
                peer.request(uavcan.protocol.GetNodeInfo.Request(), 10, named)
            peer.spin(0.1)
            found["command"] = found.get("command") or node.get("command.c1")
    finally:
        stop.set()
        thread.join()
        gateway.close()
        peer.can_driver.proc.terminate()
    print(json.dumps({**found, "clients": gateway.get("clients"), "at": gateway.get("reached_at")}))


if __name__ == "__main__":
    main()
