"""Tables of the Hydrone's page: landing points, runs beside what the source states."""

from __future__ import annotations

import json
from functools import cache
from typing import Any, NamedTuple

import numpy as np

from parts import elsewhere, part
from parts.markdown import fixed, shown_number, table
from seatrial.physics.craft.marine_craft import MarineCraft
from seatrial.system.parameters import load_vehicle
from seatrial.trial.files.trial import load_trial
from seatrial.trial.records.run_folder import Run, load_run
from seatrial.trial.running.run import run_trial
from seatrial_kits.campaigns.campaign import load_campaign
from seatrial_kits.campaigns.in_folders import run_campaign
from seatrial_kits.identify.damping import HullForm, damping
from seatrial_kits.identify.hull_file import estimate_damping

PADS = ("nominal", "longitudinal", "transversal", "diagonal-aft", "diagonal-fore")
PHASES = ("landing", "takeoff")
PHASE_NAMES = {"landing": "landing", "takeoff": "take-off"}
VARIANTS = ("source", "consistent", "physical")
SPOOL_UP = 9.9
"""Take-offs count from just before the spool-up at 10 s: from t = 0 on the craft, at rest at
its unloaded draught, first sinks and heels under the HUAUV that stands on it, s."""


@part("hydrone-pads")
def hydrone_pads() -> str:
    """Landing points by name."""
    return table(
        ("landing point", "x, m", "y, m", "z, m", "source"),
        [
            (f"`{name}`", *(shown_number(v) for v in e.value), e.source)
            for name, e in load_vehicle("hydrone").entries(None).presets("downwash")["pad"].items()
            if isinstance(e.value, list)
        ],
    )


@part("hydrone-damping")
def hydrone_damping() -> str:
    """Damping as printed, by the source's equations with its areas, and from box hulls."""
    boxes = estimate_damping("hydrone")
    length = 1.276
    # Eq. 46: one drag coefficient, an area ahead of 0.04 m2 and one abeam of 0.28 m2.
    stated = HullForm(
        length=length,
        draught=(0.28 / length,) * 2,
        beam=(0.0,) * 2,
        wetted_area=0.0,
        frontal_area=0.04,
        drag_ahead=1.2,
    )
    by_area = {each.symbol: each for each in damping(stated, 1.0, 1025.0, 1.19e-6)}
    printed = {"X_u|u|": 24.6, "Y_v|v|": 172.2, "Z_w|w|": 800.0, "M_q|q|": 400.0, "N_r|r|": 0.716}
    rows = []
    for each in boxes.derivatives:
        if each.symbol not in {*printed, "X_u", "Y_r|r|"}:
            continue
        areas = -by_area[each.symbol].value
        rows.append(
            (
                each.symbol.replace("|", r"\|"),
                each.unit,
                shown_number(printed[each.symbol]) if each.symbol in printed else "none",
                "" if each.symbol[0] in "ZM" or each.symbol == "X_u" else fixed(areas, 3),
                fixed(-each.value + 0.0, 3),
                each.equation,
            )
        )
    return table(("", "unit", "printed", "areas of the source, C_d 1.2", "box hulls", "from"), rows)


class Motion(NamedTuple):
    """What the pages quote of a run: times in s, angles in degrees, the rest SI."""

    t: Any
    x: Any
    y: Any
    z: Any
    roll: Any
    pitch: Any
    yaw: Any
    load: Any
    passed: bool
    settling: float

    def at(self, name: str, time: float) -> float:
        """Return a column's value at ``time``."""
        return float(getattr(self, name)[int(np.searchsorted(self.t, time - 1e-9))])

    def peak(self, name: str, since: float = 0.0) -> float:
        """Return the value of largest magnitude from ``since`` on."""
        values = getattr(self, name)[self.t >= since - 1e-9]
        return float(values[np.argmax(np.abs(values))])

    def peak_time(self, name: str, since: float = 0.0) -> float:
        """Return when that is."""
        late = self.t >= since - 1e-9
        return float(self.t[late][np.argmax(np.abs(getattr(self, name)[late]))])


def _motion(run: Run) -> Motion:
    signals = run.signals
    closed = "vehicle.hull.position.x" in signals
    hull, load = ("vehicle.hull", "drone.load") if closed else ("hull", "downwash.load")
    x, y, z = (signals[f"{hull}.position.{axis}"] for axis in "xyz")
    angles = [np.degrees(signals[f"{hull}.attitude.{a}"]) for a in ("phi", "theta", "psi")]
    settles = next(v["worst"] for v in run.verdicts if "settles" in v["check"])
    return Motion(run.time, x, y, z, *angles, signals[load], bool(run.passed), settles)


@cache
def _campaign(name: str) -> dict[tuple[str, str], Motion]:
    """Return the runs of a campaign by phase and what was varied."""
    motions = {}
    with elsewhere() as folder:
        run_campaign(load_campaign(name), folder / "out", engine="direct")
        for case in json.loads((folder / "out/campaign.json").read_text())["cases"]:
            phase = case["trial"].rpartition("-")[2]
            varied = [
                f"{key.removesuffix(' times')} x {value}" if key.endswith(" times") else str(value)
                for key, value in case["set"].items()
                if key != "variant"
            ]
            motions[phase, "".join(varied)] = _motion(load_run(folder / "out" / case["folder"]))
    return motions


@cache
def _single(trial: str, settings: tuple[tuple[str, Any], ...]) -> Motion:
    """Return one run of a trial with settings; a tuple is a list of values."""
    with elsewhere() as folder:
        written = {k: list(v) if isinstance(v, tuple) else v for k, v in settings}
        changed = load_trial(trial).changed(written, "docs/tables.py")
        return _motion(load_run(run_trial(changed, folder / "out", engine="direct").folder))


def _open(phase: str, pad: str, variant: str, more: tuple[tuple[str, Any], ...] = ()) -> Motion:
    """Return a run with thrusters off; those of the source are the campaign's."""
    if variant == "source":
        return _campaign("hydrone-open-pads")[phase, pad]
    return _single(f"hydrone-open-{phase}", (("variant", variant), ("downwash.pad", pad), *more))


def _static(pad_x: float, pad_y: float, weight: float = 98.1) -> tuple[float, float, float]:
    """Return sinkage (m), roll and pitch (deg) at rest under a standing load, variant source."""
    craft = MarineCraft("hull")
    values = load_vehicle("hydrone").parameter_set("marine-craft", "source").values
    for name, entry in values.items():
        craft.set(name, entry.value)
    craft.set("force_2", [0.0, 0.0, weight])
    craft.set("moment_2", [pad_y * weight, -pad_x * weight, 0.0])
    x = craft.trim(np.zeros(12), hold=("position.x", "position.y", "attitude.psi"))
    return float(x[2]), float(np.degrees(x[3])), float(np.degrees(x[4]))


class Stated(NamedTuple):
    """A figure of the source beside ours; ``tolerance`` is for what can be read from a text."""

    what: str
    where: str
    stated: float
    ours: float
    unit: str
    decimals: int
    tolerance: float


def stated() -> list[Stated]:
    """Return every figure that the source states and a run can give."""
    angle, height = ("deg", 2, 0.5), ("m", 4, 0.006)
    land, off = ({pad: _open(phase, pad, "source") for pad in PADS} for phase in PHASES)
    across, nominal = off["transversal"], off["nominal"]
    spell = nominal.pitch[(nominal.t >= 10) & (nominal.t <= 12)]
    vary = _campaign("hydrone-sensitivity")
    earlier = (("variant", "source"), ("downwash.pad", (0.3, 0.05, -0.065)))
    table_8 = [
        ("landing", "transversal", "roll", 10.5),
        ("landing", "longitudinal", "pitch", -3.2),
        ("landing", "diagonal-aft", "roll", -10.5),
        ("landing", "diagonal-aft", "pitch", 3.2),
        ("landing", "diagonal-fore", "roll", 10.5),
        ("landing", "diagonal-fore", "pitch", -3.2),
        ("takeoff", "transversal", "roll", 14.0),
        ("takeoff", "longitudinal", "pitch", -7.0),
        ("takeoff", "diagonal-aft", "roll", -14.0),
        ("takeoff", "diagonal-aft", "pitch", 7.0),
        ("takeoff", "diagonal-fore", "roll", 14.0),
        ("takeoff", "diagonal-fore", "pitch", -7.0),
    ]
    rows = []
    for phase, pad, name, value in table_8:
        if phase == "landing":
            what, ours = f"{name} at 10 s", land[pad].at(name, 10)
        else:
            what, ours = f"largest {name}", off[pad].peak(name, SPOOL_UP)
        rows.append(Stated(f"{PHASE_NAMES[phase]}, {pad}: {what}", "table 8", value, ours, *angle))
    others = [
        ("take-off, transversal: time of the largest roll", "4.3", 11.0,
         across.peak_time("roll", SPOOL_UP), "s", 2, 0.3),
        ("take-off, nominal: least pitch, 10 to 12 s", "4.1", -0.06,
         float(spell.min()), "deg", 3, 0.01),
        ("take-off, nominal: greatest pitch, 10 to 12 s", "4.1", 0.04,
         float(spell.max()), "deg", 3, 0.01),
        ("take-off, nominal: largest heave", "4.1", 0.05, nominal.peak("z", SPOOL_UP), *height),
        ("landing, nominal: heave at 20 s", "4.1", 0.02, land["nominal"].at("z", 20), *height),
        *(
            (f"landing, diagonal-aft, mass × {factor}: heave at 20 s", "4.5.1", 0.019,
             vary["landing", key].at("z", 20), *height)
            for factor, key in (("0.8", "hull.mass x 0.8"), ("1", ""), ("1.2", "hull.mass x 1.2"))
        ),
        ("largest load over the weight of the craft", "5", 1.0,
         float(across.load.max()) / 215.69, "", 2, 0.2),
        ("take-off, transversal: y at 20 s", "4.3", 0.05, across.at("y", 20), "m", 3, 0.02),
        ("take-off, transversal: x at 20 s", "4.3", -0.08, across.at("x", 20), "m", 4, 0.02),
        ("landing, diagonal-aft: pitch at rest, text", "4.4", 4.0,
         land["diagonal-aft"].at("pitch", 20), *angle),
        ("landing, diagonal-aft, GM_T × 0.8: roll at 20 s", "4.5.1", -15.0,
         vary["landing", "hull.GM_T x 0.8"].at("roll", 20), *angle),
        ("landing, diagonal-aft, GM_L × 0.8: pitch at 20 s", "4.5.1", 5.0,
         vary["landing", "hull.GM_L x 0.8"].at("pitch", 20), *angle),
        ("landing, diagonal-aft, GM_L × 1.2: pitch at 20 s", "4.5.1", 3.0,
         vary["landing", "hull.GM_L x 1.2"].at("pitch", 20), *angle),
        ("landing at (0.3, 0.05, −0.065) m: roll at 20 s", "4.5", 5.0,
         _single("hydrone-open-landing", earlier).at("roll", 20), *angle),
    ]  # fmt: skip
    return [*rows, *(Stated(*row) for row in others)]


@part("hydrone-stated")
def hydrone_stated() -> str:
    """Figures that the source states, beside those of our runs."""
    rows = []
    for row in stated():
        off = row.ours - row.stated
        rows.append(
            (
                row.what,
                row.where,
                f"{row.stated:g}".replace("-", "−"),
                fixed(row.ours, row.decimals),
                row.unit,
                fixed(off, row.decimals),
                f"{row.tolerance:g}",
                "yes" if abs(off) <= row.tolerance else "**no**",
            )
        )
    head = ("quantity", "place", "stated", "ours", "unit", "difference", "tolerance", "reproduced")
    return table(head, rows)


@part("hydrone-open-pads")
def hydrone_open_pads() -> str:
    """All ten runs of the campaign hydrone-open-pads."""
    rows = []
    for phase in PHASES:
        for pad in PADS:
            m = _open(phase, pad, "source")
            since = SPOOL_UP if phase == "takeoff" else 0.0
            rows.append(
                (
                    PHASE_NAMES[phase],
                    pad,
                    *(fixed(m.peak(name, since), 2) for name in ("roll", "pitch")),
                    *(fixed(m.at(name, 20), 2) for name in ("roll", "pitch")),
                    fixed(m.peak("z", since), 4),
                    fixed(m.settling, 2),
                    "pass" if m.passed else "fail",
                )
            )
    head = (
        *("phase", "landing point", "largest roll, deg", "largest pitch, deg"),
        *("roll at 20 s, deg", "pitch at 20 s, deg", "largest heave, m"),
        *("heave settles in, s", "limits of table 7"),
    )
    return table(head, rows)


@part("hydrone-three-variants")
def hydrone_three_variants() -> str:
    """The same manoeuvres in the three variants."""
    rows = []
    for phase in PHASES:
        for pad in ("transversal", "diagonal-aft"):
            for variant in VARIANTS:
                m = _open(phase, pad, variant)
                since = SPOOL_UP if phase == "takeoff" else 0.0
                rows.append(
                    (
                        PHASE_NAMES[phase],
                        pad,
                        variant,
                        *(fixed(m.peak(name, since), 2) for name in ("roll", "pitch")),
                        *(fixed(m.at(name, 20), 2) for name in ("roll", "pitch", "yaw")),
                    )
                )
    head = (
        *("phase", "landing point", "variant", "largest roll, deg", "largest pitch, deg"),
        *("roll at 20 s, deg", "pitch at 20 s, deg", "yaw at 20 s, deg"),
    )
    return table(head, rows)


@part("hydrone-sensitivity")
def hydrone_sensitivity() -> str:
    """The campaign hydrone-sensitivity."""
    runs = _campaign("hydrone-sensitivity")
    rows = []
    for (phase, varied), m in runs.items():
        since = SPOOL_UP if phase == "takeoff" else 0.0
        rows.append(
            (
                PHASE_NAMES[phase],
                varied.replace(" x ", " × ") or "unchanged",
                *(fixed(m.peak(name, since), 2) for name in ("roll", "pitch")),
                *(fixed(m.at(name, 20), 2) for name in ("roll", "pitch")),
                fixed(m.at("z", 20), 4),
            )
        )
    head = (
        *("phase", "changed", "largest roll, deg", "largest pitch, deg"),
        *("roll at 20 s, deg", "pitch at 20 s, deg", "heave at 20 s, m"),
    )
    return table(head, rows)


@part("hydrone-yaw")
def hydrone_yaw() -> str:
    """Yaw of the variant physical with less damping of roll and pitch."""
    hull = load_vehicle("hydrone").parameter_set("marine-craft", "physical").values

    def less(factor: float) -> tuple[tuple[str, Any], ...]:
        if factor == 1.0:
            return ()
        names = ("linear_damping_moment", "quadratic_damping_moment")
        factors = (factor, factor, 1.0)
        return tuple(
            (f"hull.{n}", tuple(f * v for f, v in zip(factors, hull[n].value, strict=True)))
            for n in names
        )

    return table(
        (
            "roll and pitch damping",
            *(f"yaw at 20 s, {PHASE_NAMES[phase]}, deg" for phase in PHASES),
        ),
        [
            (
                f"{factor:.0%}".replace("%", " %"),
                *(
                    fixed(_open(ph, "diagonal-aft", "physical", less(factor)).at("yaw", 20), 2)
                    for ph in PHASES
                ),
            )
            for factor in (1.0, 0.5, 0.1)
        ],
    )


@part("hydrone-station")
def hydrone_station() -> str:
    """The autopilot at work beside the same with thrusters off, variant physical."""
    rows = []
    for phase in PHASES:
        held = _single(f"hydrone-{phase}", ())
        for name, m in (("held", held), ("off", _open(phase, "diagonal-aft", "physical"))):
            since = SPOOL_UP if phase == "takeoff" else 0.0
            rows.append(
                (
                    PHASE_NAMES[phase],
                    name,
                    *(fixed(m.peak(angle, since), 2) for angle in ("roll", "pitch")),
                    fixed(float(np.hypot(m.x, m.y).max()), 3),
                    *(fixed(yaw, 2) for yaw in (m.peak("yaw"), m.at("yaw", 20))),
                )
            )
    head = (
        *("phase", "thrusters", "largest roll, deg", "largest pitch, deg"),
        *("greatest distance from the start, m", "largest yaw, deg", "yaw at 20 s, deg"),
    )
    return table(head, rows)


@part("hydrone-static")
def hydrone_static() -> str:
    """Equilibria under the standing HUAUV, variant source, by trim."""
    rows = []
    for pad, entry in load_vehicle("hydrone").entries(None).presets("downwash")["pad"].items():
        assert isinstance(entry.value, list)
        z, roll, pitch = _static(*entry.value[:2])
        rows.append((pad, fixed(z, 5), fixed(roll, 3), fixed(pitch, 3)))
    return table(("landing point", "sinkage, m", "roll, deg", "pitch, deg"), rows)
