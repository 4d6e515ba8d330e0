"""Cost of an irregular sea of 200 components beside the step of a hull, in one run."""

from __future__ import annotations

import time
from collections.abc import Callable

from seatrial.model.plant import Plant
from seatrial.physics.craft.marine_craft import MarineCraft
from seatrial.physics.craft.rov import Rov
from seatrial.system.parameters import load_vehicle

SEA = {
    "sea_spectrum": "jonswap",
    "sea_height": 0.5,
    "sea_period": 4.0,
    "sea_direction": 0.5,
    "sea_components_per_octave": 50.0,
}
BARGE = {
    "terms": "restoring coriolis damping wave-loads",
    "mass": 205.0,
    "inertia": [8.2, 51.0, 60.0, 0, 0, 0],
    "added_mass": [10.0, 133.0, 200.0, 0, 0, 0],
    "linear_damping_force": [50.0, 100.0, 450.0],
    "linear_damping_moment": [50.0, 150.0, 50.0],
    "waterplane_area": 1.0,
    "GM_T": 0.06,
    "GM_L": 1.6,
    "hull_length": 2.0,
    "section_beam": 0.5,
    "section_draught": 0.2,
    "section_area": 0.1,
}
H = 0.01


def made(craft: Plant, *values: dict[str, object]) -> Plant:
    """Return ``craft`` with ``values``, started."""
    for given in values:
        for name, value in given.items():
            craft.set(name, value)
    craft.setup(0.0)
    craft.initialise()
    craft.begin()
    return craft


def seconds_each(act: Callable[[], object], count: int = 1000) -> float:
    """Return the time of one call, s, of ``count``."""
    begin = time.perf_counter()
    for _ in range(count):
        act()
    return (time.perf_counter() - begin) / count


def main() -> None:
    """Print the communication step of a craft in calm water and in the sea, and their ratio."""
    videoray = load_vehicle("videoray").parameter_set("rov", None).values
    deep = {"eta_start": [0, 0, 1.0, 0, 0, 0]}
    rov = {name: entry.value for name, entry in videoray.items()} | deep
    for name, kind, values in (("barge", MarineCraft, BARGE), ("VideoRay", Rov, rov)):
        calm, rough = made(kind(name), values), made(kind(name), values, SEA)
        waves = rough.sea_state().waves()
        assert waves is not None
        assert len(waves.omega) >= 200
        # In turn, so that both meet the same load of the machine; the least of each.
        times = [
            [seconds_each(lambda of=of: of.advance(of.now, H)) for of in (calm, rough)]  # type: ignore[misc]
            for _ in range(7)
        ]
        still, moving = (min(column) for column in zip(*times, strict=True))
        print(
            f"{name}: {1e6 * still:.0f} us in calm water, {1e6 * moving:.0f} us among "
            f"{len(waves.omega)} waves: {(moving - still) / still:.2f} of its own step on top"
        )


if __name__ == "__main__":
    main()
