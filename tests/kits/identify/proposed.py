"""Vehicles by their main particulars, and what others published of them."""

from typing import NamedTuple

MARINER = 160.93, 1025.0
KVLCC2 = 320.0, 20.8, 1025.0

VEHICLES = {
    "REMUS 100, Fossen": ("torpedo", {"length": "1.6 m", "diameter": "19 cm", "density": "1026"}),
    "REMUS 100, Prestero": (
        "torpedo",
        {"length": "1.33", "diameter": "0.191", "mass": "30.48 kg", "density": "1030"},
    ),
    "BlueROV2 Heavy": (
        "rov",
        {
            "length": "457 mm", "beam": "575 mm", "height": "254 mm", "mass": "13.5",
            "density": "1000", "frontal_area": "0.0877", "side_area": "0.1131",
            "top_area": "0.2049",
        },
    ),
    "Otter": (
        "catamaran",
        {
            "length": "2 m", "beam": "1.08 m", "hull_beam": "25 cm", "spacing": "79 cm",
            "mass": "55 kg", "draught": "0.1341463415", "cg_height": "0.3341463415",
            "speed": "6 kn",
        },
    ),
    "Mariner": (
        "monohull",
        {
            "length": "160.93", "beam": "23.17", "draught": "7.468", "mass": "17045000",
            "speed": "15 kn",
        },
    ),
    "KVLCC2": (
        "monohull",
        {
            "length": "320", "beam": "58", "draught": "20.8", "mass": "320415000",
            "speed": "15.5 kn",
        },
    ),
    "KVLCC2, model": (
        "monohull",
        {
            "length": "7", "beam": "1.27", "draught": "0.46", "mass": "3270", "density": "1000",
            "speed": "1.17935",
        },
    ),
}  # fmt: skip
"""Kind and particulars; masses of ships from their displacement."""


def _mariner(prime: float, power: int) -> float:
    length, density = MARINER
    return prime * 0.5 * density * length**power


def _kvlcc2(prime: float, power: int) -> float:
    length, draught, density = KVLCC2
    return prime * 0.5 * density * length**power * draught


class Figure(NamedTuple):
    """A published figure: ``axis`` is the place in the entry; the ratio is that of ours to it."""

    vehicle: str
    what: str
    entry: str
    axis: int
    unit: str
    published: float
    low: float
    high: float


FIGURES = [
    Figure("REMUS 100, Fossen", "added mass, surge", "added_mass", 0, "kg", 0.838908593, 0.999, 1.001),
    Figure("REMUS 100, Fossen", "added mass, sway", "added_mass", 1, "kg", 29.43763662, 0.999, 1.001),
    Figure("REMUS 100, Fossen", "added inertia, yaw", "added_inertia", 2, "kg.m2", 3.426210115, 0.999, 1.001),
    Figure("REMUS 100, Prestero", "added mass, surge", "added_mass", 0, "kg", 0.93, 0.9, 1.3),
    Figure("REMUS 100, Prestero", "added mass, sway, with fins", "added_mass", 1, "kg", 35.5, 0.7, 1.0),
    Figure("REMUS 100, Prestero", "inertia, yaw", "inertia", 2, "kg.m2", 3.45, 0.75, 1.25),
    Figure("BlueROV2 Heavy", "added mass, surge", "added_mass", 0, "kg", 6.36, 0.5, 2.0),
    Figure("BlueROV2 Heavy", "added mass, sway", "added_mass", 1, "kg", 7.12, 0.5, 2.0),
    Figure("BlueROV2 Heavy", "added mass, heave", "added_mass", 2, "kg", 18.68, 0.5, 2.0),
    Figure("BlueROV2 Heavy", "added inertia, roll", "added_inertia", 0, "kg.m2", 0.189, 0.4, 2.5),
    Figure("BlueROV2 Heavy", "added inertia, pitch", "added_inertia", 1, "kg.m2", 0.135, 0.4, 2.5),
    Figure("BlueROV2 Heavy", "added inertia, yaw", "added_inertia", 2, "kg.m2", 0.222, 0.4, 2.5),
    Figure("BlueROV2 Heavy", "inertia, yaw", "inertia", 2, "kg.m2", 0.37, 0.5, 2.0),
    Figure("BlueROV2 Heavy", "quadratic drag, surge", "quadratic_damping_force", 0, "N.s2/m2", 141, 0.3, 1.0),
    Figure("BlueROV2 Heavy", "quadratic drag, heave", "quadratic_damping_force", 2, "N.s2/m2", 190, 0.3, 1.0),
    Figure("Otter", "added mass, surge, both hulls as one", "added_mass", 0, "kg", 5.281521, 0.6, 0.7),
    Figure("Otter", "added mass, sway", "added_mass", 1, "kg", 82.5, 0.6, 1.6),
    Figure("Otter", "added mass, heave", "added_mass", 2, "kg", 55, 0.6, 1.6),
    Figure("Otter", "added inertia, yaw", "added_inertia", 2, "kg.m2", 23.375, 0.6, 1.6),
    Figure("Otter", "GM_T", "GM_T", 0, "m", 1.9967187599, 0.9, 1.1),
    Figure("Otter", "GM_L", "GM_L", 0, "m", 4.7294530673, 0.5, 1.0),
    Figure("Mariner", "added mass, surge", "added_mass", 0, "kg", _mariner(42e-5, 3), 0.9, 1.4),
    Figure("Mariner", "added mass, sway", "added_mass", 1, "kg", _mariner(748e-5, 3), 0.9, 1.2),
    Figure("Mariner", "added inertia, yaw", "added_inertia", 2, "kg.m2", _mariner(43.8e-5, 5), 0.9, 1.2),
    Figure("Mariner", "inertia, yaw", "inertia", 2, "kg.m2", _mariner(39.2e-5, 5), 0.9, 1.4),
    Figure("KVLCC2", "added mass, surge", "added_mass", 0, "kg", _kvlcc2(0.022, 2), 0.9, 1.7),
    Figure("KVLCC2", "added mass, sway", "added_mass", 1, "kg", _kvlcc2(0.223, 2), 0.9, 1.2),
    Figure("KVLCC2", "added inertia, yaw", "added_inertia", 2, "kg.m2", _kvlcc2(0.011, 4), 0.9, 1.2),
    Figure("KVLCC2, model", "resistance", "quadratic_damping_force", 0, "N.s2/m2", 0.022 * 500 * 7 * 0.46, 0.7, 1.1),
]  # fmt: skip
