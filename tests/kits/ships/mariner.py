"""The Mariner, built from its parameter file, with its rudder machine and PD control."""

from seatrial.fmi.direct import DirectInstance
from seatrial.system.parameters import load_vehicle
from seatrial.system.references.values import from_entry, port_scalars
from seatrial_kits.ships.devices.rudder_machine import RudderMachine
from seatrial_kits.ships.hulls.manoeuvring_ship import ManoeuvringShip

L, U = 160.93, 7.7175
FEET = 25.3171479  # 15 knots in ft/s: what B of the source is too large by
K, T_D = 0.034, 1.25379
A = ((-0.76944, -0.33442), (-3.38925, -2.09400))
B = (4.3247, -41.235)


def ship(variant, **changes):
    return _built(ManoeuvringShip, "manoeuvring-ship", variant, changes)


def machine(**changes):
    return _built(RudderMachine, "rudder-machine", None, changes)


def dimensionless(**changes):
    """Return the source's ship with L = U = 1."""
    unit = {"length": 1.0, "speed": 1.0, "nu_start": (1.0, 0.0, 0.0)}
    return ship("source", **{**unit, **changes})


def slope_at(craft, state, rudder):
    """Return the derivatives with this angle of the rudder."""
    craft.set("rudder", rudder)
    return craft.derivatives(state)


def rudder_effect(linear):
    """Return what the rudder adds to dv/dt and dr/dt, per radian."""
    return linear.B[4:, linear.u_names.index("rudder")]


def _built(cls, table, variant, changes):
    component = cls(table)
    variables = DirectInstance(component).variables
    for name, entry in load_vehicle("mariner").parameter_set(table, variant).values.items():
        for scalar, given in from_entry(entry, port_scalars(variables, name), name).items():
            component.set(scalar, given.value)
    for name, value in changes.items():
        component.set(name, value)
    return component
