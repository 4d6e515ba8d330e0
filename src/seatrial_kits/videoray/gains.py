"""Named sets of what the ROV stores: gains and slew rates.

``captured`` is what VideoRay's capture of a vehicle shows. With a slew of 0.005 per loop of 0.1 s
it takes 20 s to full thrust, and oscillates. ``holding`` is ours, for the vehicle videoray: the
natural frequencies are 1.4 rad/s in depth and 1.1 rad/s in heading, and the slew is no limit.
"""

from __future__ import annotations

GAINS: dict[str, dict[str, int]] = {
    "captured": {},
    "holding": {
        **dict(zip((f"auto_depth_{x}" for x in "pidk"), (-1000, -1, -12000, 1000), strict=True)),
        **dict(zip((f"auto_heading_{x}" for x in "pidk"), (410, 12, 6400, 100), strict=True)),
        **{f"{name}_slew_rate": 10000 for name in ("port", "starboard", "vertical")},
    },
}
"""Raw numbers by register, where they differ from the captured vehicle's."""
