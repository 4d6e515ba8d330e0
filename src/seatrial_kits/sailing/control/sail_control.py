"""Control of a rigid sail with a flap."""

from __future__ import annotations

import math
from typing import ClassVar

from seatrial.errors import InputError
from seatrial.model.component import Input, Output, Parameter, terminal
from seatrial.model.sampled import Sampled
from seatrial.physics.foils import HIGH_ALPHA, SAIL_ENTRIES, sail_naca0015

from .sail_search import Setting, best_setting, setting
from .sail_surface import smooth_setting

_DEG = math.radians(1.0)


class SailControl(Sampled):
    """Controller of sail and flap: greatest drive, on the right side, with a limit on heel.

    **Side** ([Silva2018], eqs 3.36 and 3.37). With d = heading - direction the wind blows to, in
    [0, 360) deg: boom to port for 0 < d < 180, else to starboard. Within ``hysteresis`` of dead
    downwind (d = 0) it stays where it was: 0 is the source's rule, with which the sail chatters
    there.

    **Upwind**, min(d, 360 deg - d) > ``upwind_threshold``: sail at ``upwind_sail``, flap 0.

    **Elsewhere**: the angle in 0 ... ``sail_limit`` and the flap with the greatest drive in the
    sail's table (3.34, 3.35; `sail_search`). The source searches all angles and cuts the best
    one off afterwards, which downwind takes a flap that is not the best. ``optimum`` = "smooth"
    takes the maximum of a smooth surface through the table, as the source proposes beside its
    search (section 3.2; `sail_surface`), without a limit on heel.

    **Limit on heel**, ``roll_limit`` = "on" (proposed, not worked out, in chapter 5 of the
    source). In a steady state the keel takes the side force Y of the sail, and both heel the
    boat by |Y| ``heeling_arm``, the height of the sail's centre of effort over the keel's. That
    must not exceed

        righting_moment sin(design_heel) cos(design_heel) f,
        f = (spill_heel - lee) / (spill_heel - design_heel) within 0 ... 1

    where lee is the heel to leeward that the boat will have, heel + ``lead`` roll_rate: what
    gusts do beyond the prediction is spilled. Among the settings that keep to it, the one with
    the greatest drive; if none does, the one with the least side force. Upwind the angle stays
    at ``upwind_sail`` if that keeps to it, and is eased from there otherwise.

    **By hand.** Not ``trimming``, the flap is 0 and the sail streams in the wind like a boom on a
    sheet, at the angle of attack 0, but goes out no further than (1 - ``sheet``) ``sail_limit``:
    with ``sheet`` = 0, as a disarmed boat has it, nothing drives as long as the apparent wind is
    before the beam. No limit on heel acts then.

    ``apparent_wind`` is the flow at the centre of effort of the sail amidships: speed, and the
    direction it blows to from the bow, to starboard positive. ``wind`` is the true one: where
    it blows to. ``sail`` is positive with the boom to port, ``flap`` the size of its angle;
    ``heel`` is positive starboard down. SI, rad.

    Not modelled: the lift that heel takes from the sail, unsteady flow, the weight of the sail.

    Raises InputError at the start for an upwind angle beyond the limit, a spill heel that is not
    more than the design heel, or a limit on heel with "smooth".
    """

    exercised: ClassVar = {"roll_limit": "on"}

    period = Parameter(0.02, "s", "sample period", min=1e-6)
    sail_limit = Parameter(90.0 * _DEG, "rad", "greatest angle of the sail", min=0.0)
    upwind_threshold = Parameter(
        100.0 * _DEG, "rad", "angle from dead downwind beyond which it is upwind", min=0.0
    )
    upwind_sail = Parameter(40.0 * _DEG, "rad", "angle of the sail upwind", min=0.0, tunable=True)
    hysteresis = Parameter(
        0.0,
        "rad",
        "angle from dead downwind within which the sail keeps its side",
        min=0.0,
        tunable=True,
    )
    sail_entry = Parameter(
        "patched", "1", "C_L of the sail at flap 15, alpha 175 deg", choices=SAIL_ENTRIES
    )
    high_alpha = Parameter(
        "physical", "1", "C_L beyond 90 deg: as in the tables, or negated", choices=HIGH_ALPHA
    )
    optimum = Parameter(
        "table",
        "1",
        "greatest drive of the table's points, or of a smooth surface through them",
        choices=("table", "smooth"),
    )
    roll_limit = Parameter("off", "1", "whether heel is limited", choices=("off", "on"))
    design_heel = Parameter(
        15.0 * _DEG, "rad", "steady heel allowed", min=0.0, max=45.0 * _DEG, tunable=True
    )
    spill_heel = Parameter(
        35.0 * _DEG, "rad", "heel at which no moment is allowed", min=0.0, tunable=True
    )
    lead = Parameter(1.0, "s", "time by which the heel is foreseen", min=0.0, tunable=True)
    heeling_arm = Parameter(1.0, "m", "sail's centre of effort over the keel's", min=0.0)
    righting_moment = Parameter(1.0, "N.m", "weight times GM_T", min=0.0)
    sail_area = Parameter(1.0, "m2", "area of the sail", min=0.0)
    air_density = Parameter(1.225, "kg/m3", "density of the air", min=0.0)

    heading = Input("rad", "heading, clockwise from north")
    wind = Input(
        "m/s", "velocity of the air over ground: where it blows to, {n}", axes=("north", "east")
    )
    apparent_wind = Input(
        ("m/s", "rad"),
        "apparent wind at the sail, and where it blows to from the bow, to starboard positive",
        axes=("speed", "angle"),
    )
    heel = Input("rad", "heel, starboard down")
    roll_rate = Input("rad/s", "roll rate, starboard down")
    trimming = Input(
        "1", "whether it sets the sail for drive", type=bool, start=True, optional=True
    )
    sheet = Input("1", "share of the sheet that is hauled in, if not, 0 to 1", optional=True)

    sail = Output("rad", "angle wanted of the sail, boom to port positive")
    flap = Output("rad", "size wanted of the flap's angle")
    heeling_moment = Output("N.m", "heeling moment predicted, to starboard positive")

    feedthrough: ClassVar = {
        "flap": ("heading", "wind", "apparent_wind", "heel", "roll_rate", "trimming")
    }
    terminals: ClassVar = {
        "wanted": terminal(sail_engaged="trimming", direct_sheet="sheet"),
        "sensors": terminal(
            "heading",
            "heel",
            "roll_rate",
            wind_speed="apparent_wind__speed",
            wind_angle="apparent_wind__angle",
        ),
        "estimate": terminal("wind"),
        "actuators": terminal("sail", "flap"),
    }

    def reset(self, t: float) -> None:
        """Start without a side; raises InputError for angles out of order."""
        if self.upwind_sail > self.sail_limit:
            raise InputError(
                f"{self.name}: upwind_sail ({self.upwind_sail!r} rad) must not exceed sail_limit "
                f"({self.sail_limit!r} rad)"
            )
        if not self.design_heel < self.spill_heel:
            raise InputError(
                f"{self.name}: design_heel ({self.design_heel!r} rad) must be less than "
                f"spill_heel ({self.spill_heel!r} rad)"
            )
        if self.optimum == "smooth" and self.roll_limit == "on":
            raise InputError(
                f"{self.name}: optimum is 'smooth', which knows no limit on heel, and roll_limit "
                "is 'on': one of them must be 'table' or 'off'"
            )
        self._side = 0
        self._table = (self.sail_entry, self.high_alpha)

    def sample(self, t: float, k: int) -> None:
        """Set sail and flap."""
        side = self._side_now()
        chosen = self._chosen(side) if self.trimming else self._sheeted(side)
        self.sail, self.flap = side * chosen.angle, chosen.flap
        # The side force to starboard of a sail to port heels to starboard.
        self.heeling_moment = side * chosen.side * self._moment_per_side()

    def update(self, t: float, k: int) -> None:
        """Remember the side."""
        self._side = self._side_now()

    def _downwind_angle(self) -> float:
        """Return the heading from dead downwind, to starboard positive, in [-pi, pi]."""
        north, east = self.wind
        return math.remainder(self.heading - math.atan2(east, north), math.tau)

    def _side_now(self) -> int:
        """Return 1 for boom to port, -1 for starboard."""
        away = self._downwind_angle()
        if self._side and abs(away) < self.hysteresis:
            return self._side
        return 1 if 0.0 < away < math.pi else -1

    def _chosen(self, side: int) -> Setting:
        """Return the setting with the boom to port; ``side`` mirrors the wind."""
        table = sail_naca0015(*self._table)
        beta = side * self.apparent_wind[1]
        allowed = self._side_force_allowed(side)
        upwind = abs(self._downwind_angle()) > self.upwind_threshold
        if self.optimum == "smooth" and not upwind:
            return smooth_setting(table, beta, 0.0, self.sail_limit)
        if upwind:
            fixed = setting(table, beta, self.upwind_sail, 0.0)
            if allowed is None or abs(fixed.side) <= allowed:
                return fixed
        least = self.upwind_sail if upwind else 0.0
        if allowed is None:
            return best_setting(table, beta, least, self.sail_limit)
        return best_setting(table, beta, least, self.sail_limit, allowed)

    def _sheeted(self, side: int) -> Setting:
        """Return the setting of a sail that streams as far as its sheet lets it."""
        beta = side * self.apparent_wind[1]
        streaming = math.remainder(beta + math.pi, math.tau)
        most = (1.0 - min(max(self.sheet, 0.0), 1.0)) * self.sail_limit
        # Wind from abaft the beam presses the boom to where it is.
        out = most if abs(streaming) > math.pi / 2 else min(max(streaming, -most), most)
        return setting(sail_naca0015(*self._table), beta, out, 0.0)

    def _side_force_allowed(self, side: int) -> float | None:
        """Return the greatest coefficient of the side force that the heel allows, if limited."""
        per_side = self._moment_per_side()
        if self.roll_limit == "off" or per_side == 0.0:
            return None
        # With the boom to port the wind comes from starboard: leeward is port.
        lee = -side * (self.heel + self.lead * self.roll_rate)
        # A design heel that was tuned beyond the spill heel is all there is.
        margin = max(self.spill_heel - self.design_heel, 1e-9)
        share = (self.spill_heel - lee) / margin
        most = self.righting_moment * math.sin(self.design_heel) * math.cos(self.design_heel)
        allowed: float = most * min(max(share, 0.0), 1.0) / per_side
        return allowed

    def _moment_per_side(self) -> float:
        """Return the heeling moment per coefficient of the side force, N.m."""
        moment: float = (
            0.5 * self.air_density * self.sail_area * self.apparent_wind[0] ** 2 * self.heeling_arm
        )
        return moment
