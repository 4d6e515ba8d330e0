"""Power manager of the ROV: the power its thrusters may use.

The map has names and scales only: each loop the power falls by the decrement of a limit that is
crossed (least voltage, greatest current), and else grows by its increment, between the least and
the greatest power. Its limits on changes of thrust are not carried out here.
"""

from __future__ import annotations

from .node import RovNode


def manage(node: RovNode, power: float, voltage: float, current: float) -> float:
    """Return the power of the next loop, 0 to 1, and enter it; V and A of the tether."""
    low = voltage < node.value("min_voltage")
    high = current > node.value("max_current")
    if low or high:
        power -= low * node.value("voltage_decrement") + high * node.value("current_decrement")
    else:
        power += min(node.value("voltage_increment"), node.value("current_increment"))
    power = max(min(power, node.value("max_power"), 1.0), node.value("min_power"))
    for name in ("power_manager", "total_power"):
        node.measure(name, power)
    return power
