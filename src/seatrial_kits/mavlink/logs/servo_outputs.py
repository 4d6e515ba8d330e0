"""Orders of servo outputs: pulses of a log as shares, by ArduPilot's parameters SERVOn_*."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from seatrial.trial.logs.channels import Channel, channel

_FUNCTIONS = {
    26: "ground_steering",
    70: "throttle",
    73: "throttle_left",
    74: "throttle_right",
    **{33 + k: f"motor_{k + 1}" for k in range(8)},
}
"""By SERVOn_FUNCTION; names as ArduPilot's documentation has them."""

DEFAULTS = {
    "helm": ("servo.ground_steering",),
    "command": ("servo.throttle",),
    "port": ("servo.throttle_left",),
    "starboard": ("servo.throttle_right",),
}
"""Quantities that they serve."""


def servo_orders(
    pulses: Mapping[int, Channel], parameters: Mapping[str, float]
) -> dict[str, Channel]:
    """Return the orders by ``servo.FUNCTION``, from -1 to 1, of outputs whose parameters are known.

    ``pulses`` are by output, in us. The share is (pulse - TRIM) / (MAX - TRIM) above TRIM and
    (pulse - TRIM) / (TRIM - MIN) below, of opposite sign if REVERSED: ArduPilot's SRV_Channel. A
    pulse of 0 is none.
    """
    found = {}
    for output, each in pulses.items():
        name = _FUNCTIONS.get(int(parameters.get(f"SERVO{output}_FUNCTION", 0)))
        limits = [parameters.get(f"SERVO{output}_{key}") for key in ("MIN", "TRIM", "MAX")]
        if name is None or None in limits:
            continue
        least, trim, most = (float(limit) for limit in limits if limit is not None)
        if not least < trim < most:
            continue
        above = each.values - trim
        share = np.clip(
            np.where(above >= 0.0, above / (most - trim), above / (trim - least)), -1, 1
        )
        if parameters.get(f"SERVO{output}_REVERSED", 0.0):
            share = -share
        share = np.where(each.values > 0.0, share, np.nan)
        found[f"servo.{name}"] = channel(f"servo.{name}", "1", each.time, share, each.rows)
    return found
