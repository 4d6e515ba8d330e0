"""Control allocation to the parts of any body: force and moment to orders and angles."""

from __future__ import annotations

import math
from typing import ClassVar

from seatrial.model.component import Input, Output, Parameter, Terminal, terminal
from seatrial.model.sampled import Sampled

from ..parts.slots import COUNT
from .allocated_parts import PRIORITIES, AllocatedParts
from .extended_thrust import Demand, Shares, shares_of
from .steering import Turning, angles_for, as_one, with_directions

_PROPULSORS = tuple(f"p{number}" for number in range(1, COUNT + 1))
_FOILS = tuple(f"f{number}" for number in range(1, COUNT + 1))
_DEMAND = ("surge", "sway", "heave", "roll_moment", "pitch_moment", "yaw_moment")


class PartAllocation(AllocatedParts, Sampled):
    """Orders and angles of propulsors and foils that give a force and a moment, as they can.

    Parameters of the parts are those of the craft (`PropulsorSlots`, `FoilSlots`): thrusters,
    azimuths, outboards, tunnels, propellers, jets, fins and rudders in any number and mix. At
    every ``period`` the shares x of what each of them gives at most have the least

        |W (B x - tau)|^2 + 1e-8 |x|^2    within their limits

    tau = (X, Y, Z, K, M, N), those of ``axes``; others are left out, and take what comes. B has a
    column (d_i, r_i x d_i) T_i per part. W weighs an axis by its share of the largest that the
    parts give there: roll and pitch before yaw, yaw before heave, heave before surge and sway,
    each by a factor of 30 in W. A demand that the parts can give is given within 1e-6.

    **Propulsors.** T_i is ``propulsor_thrust`` for every kind, the bollard thrust; of a tunnel it
    falls by 1 - (u / ``propulsor_fading_speed``)^2. Other losses with the speed are left to the
    holds. An order is sgn(T) (|T| / T_i)^(1/e), e = ``propulsor_exponent``, or 2 where the order
    is a share of the shaft speed (propeller, wageningen-b, four-quadrant, jet: K_T of J = 0).

    **Those that turn** (with a range of angles, of whatever kind) are allocated twice. By
    extended thrust, rectangular components within the circle of T_i, they find the angle that
    they should have (`angles_for`): no direction is singular, and the nearer of ahead and astern
    is taken where the thrust astern is enough. They turn there at ``propulsor_angle_rate``, the
    nearest way in their range, and the thrusts of all parts are those for the angles of this
    instant, so that what is asked is given on the way too, as far as it goes. One that has less
    than ``idle_share`` to give keeps its angle. Those that ``propulsor_turns_with`` another find it
    as one propulsor of all their thrust; at that angle each has a thrust of its own.

    **Foils** give rho/2 u^2 A C_L' delta each, u = ``speed`` ahead through the water, C_L' of
    their aspect ratio (`lift_slope`), or ``foil_lift`` of a linear-fin, their direction that of
    `lift_wrench`. Slower than ``steerage_speed``, or astern, they lie amidships. Sails are not
    allocated: their angle is 0.

    X ahead, Y to starboard, Z down positive, N; K starboard down, M bow up, N to starboard
    positive, N.m; about the body origin. Angles rad: a propulsor's about z from x to y.

    ``speed`` is a log's, or in its place guidance's over ground; not connected, it is 0.

    Not modelled: moments of shafts, flow that a part meets from another, stall.

    Raises InputError at the start for an axis that is no unit vector, or is not horizontal where
    it turns, for angles out of order or shared with no angle, for a propeller or jet without
    ``propulsor_thrust``, for a linear-fin without ``foil_lift``, for ``axes`` that name none though
    there are parts, and for one that the parts cannot give, or only together with another one.
    """

    exercised: ClassVar = {
        "propulsors": "azimuth outboard tunnel propeller thruster thruster",
        "foils": "fin fin",
        "axes": "surge sway heave roll pitch yaw",
        "propulsor_position_1": [-3.0, 0.5, 0.5],
        "propulsor_position_2": [-3.0, -0.5, 0.5],
        "propulsor_position_3": [3.0, 0.0, 0.5],
        "propulsor_position_5": [1.0, 1.0, 0.0],
        "propulsor_position_6": [-1.0, -0.5, 0.0],
        "propulsor_axis_3": [0.0, 1.0, 0.0],
        "propulsor_axis_5": [0.0, 0.0, 1.0],
        "propulsor_axis_6": [0.0, 0.0, 1.0],
        "propulsor_thrust_1": [8.0, 2.0],
        "propulsor_thrust_2": [8.0, 2.0],
        "propulsor_thrust_4": [2.0, 1.0],
        "propulsor_angle_limit_1": [-1e9, 1e9],
        "propulsor_angle_limit_2": [-0.7, 0.7],
        "propulsor_fading_speed_3": 4.0,
        "foil_position_1": [-2.0, 0.5, 0.0],
        "foil_position_2": [-2.0, -0.5, 0.0],
        "foil_roll_1": 1.5,
        "foil_roll_2": -1.5,
    }

    period = Parameter(0.05, "s", "sample period", min=1e-6)
    density = Parameter(1025.0, "kg/m3", "density of the water", min=0.0)
    idle_share = Parameter(
        0.02, "1", "share of its thrust below which a propulsor does not turn", min=0.0, max=1.0
    )
    steerage_speed = Parameter(0.3, "m/s", "speed ahead below which foils are amidships", min=1e-3)

    surge = Input("N", "surge force wanted, positive ahead", optional=True)
    sway = Input("N", "sway force wanted, positive to starboard", optional=True)
    heave = Input("N", "heave force wanted, positive down", optional=True)
    roll_moment = Input("N.m", "roll moment wanted, positive starboard down", optional=True)
    pitch_moment = Input("N.m", "pitch moment wanted, positive bow up", optional=True)
    yaw_moment = Input("N.m", "yaw moment wanted, positive to starboard", optional=True)
    speed = Input("m/s", "speed ahead through the water", optional=True)

    propulsor_order = Output(
        "1", "share of the largest thrust or shaft speed, -1 to 1", axes=_PROPULSORS
    )
    propulsor_angle = Output("rad", "angle of each propulsor about z", axes=_PROPULSORS)
    foil_angle = Output("rad", "angle of each foil", axes=_FOILS)

    feedthrough: ClassVar = dict.fromkeys(
        ("propulsor_order", "propulsor_angle", "foil_angle"), (*_DEMAND, "speed")
    )
    terminals: ClassVar = {
        "demand": terminal(*_DEMAND),
        "wanted": terminal("speed"),
        "sensors": terminal(water_speed="speed"),
        "propulsor_orders": Terminal({p: f"propulsor_order.{p}" for p in _PROPULSORS}),
        "propulsor_angles": Terminal({p: f"propulsor_angle.{p}" for p in _PROPULSORS}),
        "foil_angles": Terminal({f: f"foil_angle.{f}" for f in _FOILS}),
    }

    def reset(self, t: float) -> None:
        """Work out what each part gives; raises InputError as the class says."""
        self.read_parts()
        self._angles = list(self._first_angles)

    def sample(self, t: float, k: int) -> None:
        """Allocate."""
        if not self._rows:  # there are no parts
            return
        others, turning = self._others(), self._those_that_turn()
        demand = self._demanded(others)
        now = [self._angles[helm] for helm in self._helms]
        on_helms = [as_one([turning[i] for i in places]) for places in self._on_helm]
        goals = angles_for(demand, others, on_helms, now, self.idle_share)
        angles = self._steered(goals)
        reached = [angles[number] for number in self._turning]
        self._order(shares_of(demand, with_directions(others, turning, reached)))
        self.propulsor_angle = angles

    def update(self, t: float, k: int) -> None:
        """Remember the angles."""
        self._angles = list(self.propulsor_angle)

    def _demanded(self, others: Shares) -> Demand:
        """Return what is asked for, and the weights for what there is to give it."""
        demand = [getattr(self, name) for name in _DEMAND]
        most = [0.0 for _ in self._rows]
        for column in (*others.columns, *self._along, *self._abeam):
            most = [size + abs(one) for size, one in zip(most, column, strict=True)]
        first = [PRIORITIES[row] for row in self._rows]
        return Demand(
            [demand[row] for row in self._rows],
            [p / size if size > 0.0 else 0.0 for p, size in zip(first, most, strict=True)],
        )

    def _others(self) -> Shares:
        """Return the parts that do not turn, as they are at this speed."""
        ahead = self.speed if self.speed >= self.steerage_speed else 0.0
        pressure = 0.5 * self.density * ahead**2
        effects = [
            *[self._effect(number) for number in self._fixed],
            *[pressure for _ in self._foils],
        ]
        columns = [
            [effect * one for one in column]
            for effect, column in zip(effects, self._columns, strict=True)
        ]
        reaches = [*[self._reaches[n] for n in self._fixed], *[(1.0, 1.0) for _ in self._foils]]
        return Shares(columns, [-astern for astern, _ in reaches], [most for _, most in reaches])

    def _those_that_turn(self) -> list[Turning]:
        return [
            Turning(along, abeam, *self._ranges[self._leaders[number]], *self._reaches[number])
            for number, along, abeam in zip(self._turning, self._along, self._abeam, strict=True)
        ]

    def _effect(self, number: int) -> float:
        """Return the share of a propulsor's thrust that the speed leaves."""
        gone = self._fading[number]
        return 1.0 - min(1.0, (self.speed / gone) ** 2) if gone > 0.0 else 1.0

    def _steered(self, goals: list[float]) -> list[float]:
        """Return the angles of all propulsors after the move of this instant to those of helms."""
        angles = list(self._angles)
        rates = self.propulsor_angle_rate
        for helm, goal in zip(self._helms, goals, strict=True):
            most = rates[helm] * self.period if rates[helm] > 0.0 else math.inf
            moved = angles[helm] + min(max(goal - angles[helm], -most), most)
            for number, leader in enumerate(self._leaders):
                if leader == helm:
                    angles[number] = moved
        return angles

    def _order(self, shares: list[float]) -> None:
        """Publish orders and angles of shares: of fixed propulsors, foils, those that turn."""
        fixed, foils = len(self._fixed), len(self._fixed) + len(self._foils)
        orders = [0.0] * COUNT
        angles = [0.0] * COUNT
        numbers = [*self._fixed, *self._turning]
        for number, share in zip(numbers, [*shares[:fixed], *shares[foils:]], strict=True):
            orders[number] = self.order_of(number, share)
        for number, share in zip(self._foils, shares[fixed:foils], strict=True):
            angles[number] = share * self._most[number]
        self.propulsor_order, self.foil_angle = orders, angles
