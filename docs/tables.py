"""The parts of the pages that come from code, parameter files and runs.

``python docs/tables.py`` writes them anew, ``--check`` only says which are out of date
(status 1). A part stands between a comment that names it and a comment that ends it; nothing
else of a page is touched.
"""

from __future__ import annotations

import contextlib
import json
import re
import sys
import tempfile
import tomllib
from collections.abc import Callable, Iterable, Sequence
from functools import cache, partial
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from seatrial.cosim.parameters import Entry, load_vehicle
from seatrial.cosim.profile import SENSORS
from seatrial.craft.marine_craft import MarineCraft
from seatrial.ports import Parameter
from seatrial.shipped import shipped_folder
from seatrial.trials.campaign import load_campaign, run_campaign
from seatrial.trials.heading_design import design_heading
from seatrial.trials.heading_design_page import rows as design_rows
from seatrial.trials.heading_design_page import stability
from seatrial.trials.readable import number
from seatrial.trials.run import run_trial
from seatrial.trials.run_folder import Run, load_run
from seatrial.trials.trial import load_trial

DOCS = Path(__file__).resolve().parent
PART = re.compile(
    r"(?P<begin><!-- made by docs/tables\.py: (?P<name>[\w-]+) -->\n).*?(?P<end><!-- end -->)",
    re.DOTALL,
)
PADS = ("nominal", "longitudinal", "transversal", "diagonal-aft", "diagonal-fore")
PHASES = ("landing", "takeoff")
PHASE_NAMES = {"landing": "landing", "takeoff": "take-off"}
VARIANTS = ("source", "consistent", "physical")
SPOOL_UP = 9.9
"""Take-offs count from just before the spool-up at 10 s: from t = 0 on the craft, at rest at
its unloaded draught, first sinks and heels under the HUAUV that stands on it, s."""

_PARTS: dict[str, Callable[[], str]] = {}


def part(name: str) -> Callable[[Callable[[], str]], Callable[[], str]]:
    """Register the function that makes the part ``name``."""

    def register(make: Callable[[], str]) -> Callable[[], str]:
        _PARTS[name] = make
        return make

    return register


def pages() -> dict[Path, list[str]]:
    """Return the parts that each page has."""
    found = {}
    for page in sorted(DOCS.rglob("*.md")):
        names = [m["name"] for m in PART.finditer(page.read_text("utf-8"))]
        if names:
            found[page] = names
    return found


def made(name: str) -> str:
    """Return the part ``name`` as code, files and runs have it now."""
    return _PARTS[name]()


def written(page: Path, name: str) -> str:
    """Return the part ``name`` as the page has it."""
    return next(
        m.group()[len(m["begin"]) : -len(m["end"])]
        for m in PART.finditer(page.read_text("utf-8"))
        if m["name"] == name
    )


def main(arguments: Sequence[str]) -> int:
    """Write all parts anew, or with ``--check`` only compare; return the exit status."""
    stale = []
    for page, names in pages().items():
        text = page.read_text("utf-8")
        stale += [f"{page.relative_to(DOCS)}: {n}" for n in names if written(page, n) != made(n)]
        if "--check" not in arguments:
            text = PART.sub(lambda m: m["begin"] + made(m["name"]) + m["end"], text)
            page.write_text(text, "utf-8")
    for place in stale:
        print(("out of date: " if "--check" in arguments else "written: ") + place)
    return 1 if stale and "--check" in arguments else 0


# ---------------------------------------------------------------------- Markdown


def _table(head: Sequence[str], rows: Iterable[Sequence[str]]) -> str:
    lines = [head, ["---"] * len(head), *rows]
    return "".join(f"| {' | '.join(line)} |\n" for line in lines)


def _number(value: float | int | str) -> str:
    return value if isinstance(value, str) else f"{value:g}"


def _value(value: Any) -> str:
    if isinstance(value, list):
        return f"({', '.join(_number(v) for v in value)})"
    return _number(value)


def _fixed(value: float, decimals: int) -> str:
    text = f"{value:.{decimals}f}"
    return text.replace("-", "−") if float(text) else text.lstrip("-")


def _unit(text: str | Sequence[str]) -> str:
    if not isinstance(text, str):
        return f"({', '.join(text)})"
    return "" if text == "1" else text


# ---------------------------------------------------------------------- files.md


@part("sensor-keys")
def sensor_keys() -> str:
    """Keys of a profile's sensors: the parameters of their components."""
    rows: dict[tuple[str, str, str], dict[str, str]] = {}
    for kind, component in SENSORS.items():
        for name, port in component.ports.items():
            if isinstance(port, Parameter) and name != "seed":
                starts = port.start if len(set(port.start)) > 1 else port.start[:1]
                texts = [f"{start:.4g}" for start in starts]
                axes = f" ({', '.join(port.axes)})" if port.axes else ""
                row = rows.setdefault((name, _unit(port.unit), port.description + axes), {})
                row[kind] = f"({', '.join(texts)})" if len(texts) > 1 else texts[0]
    common_first = sorted(rows.items(), key=lambda item: len(item[1]) == 1)
    return _table(
        ("key", "meaning", "unit", *SENSORS),
        [
            (f"`{name}`", meaning, unit, *(starts.get(kind, "") for kind in SENSORS))
            for (name, unit, meaning), starts in common_first
        ],
    )


# ---------------------------------------------------------------------- vehicles: parameters


def parameters(vehicle: str) -> str:
    """Parameters that all variants share."""
    file = load_vehicle(vehicle).file
    varied = {(t, n) for c in file.variants.values() for t, entries in c.items() for n in entries}
    return _table(
        ("component", "parameter", "value", "unit", "mark", "source"),
        [
            (table, f"`{name}`", _value(e.value), _unit(e.unit), e.mark, e.source)
            for table, entries in file.components.items()
            for name, e in entries.items()
            if (table, name) not in varied
        ],
    )


def variants(vehicle: str) -> str:
    """Parameters in which the variants differ."""
    file = load_vehicle(vehicle).file
    places = dict.fromkeys(
        (table, name)
        for changes in file.variants.values()
        for table, entries in changes.items()
        for name in entries
    )
    rows = []
    for table, name in places:
        for variant, changes in file.variants.items():
            shared: dict[str, Entry] = file.components[table]
            e = changes.get(table, {}).get(name, shared.get(name))
            assert e is not None
            value = _value(e.value)
            rows.append((table, f"`{name}`", variant, value, _unit(e.unit), e.mark, e.source))
    head = ("component", "parameter", "variant", "value", "unit", "mark", "source")
    return _table(head, rows)


for _vehicle in ("hydrone", "gloria", "mariner"):
    part(f"{_vehicle}-parameters")(partial(parameters, _vehicle))
    part(f"{_vehicle}-variants")(partial(variants, _vehicle))
part("thruster-ship-parameters")(partial(parameters, "thruster-ship"))


# ---------------------------------------------------------------------- hydrone.md: the rest


@part("hydrone-pads")
def hydrone_pads() -> str:
    """Landing points by name."""
    return _table(
        ("landing point", "x, m", "y, m", "z, m", "source"),
        [
            (f"`{name}`", *(_number(v) for v in e.value), e.source)
            for name, e in load_vehicle("hydrone").file.presets["downwash"]["pad"].items()
            if isinstance(e.value, list)
        ],
    )


def sensors_of(profile: str) -> str:
    """Sensors of a profile, as its file has them."""
    path = shipped_folder("hil_profiles") / f"{profile}.toml"
    sensors = tomllib.loads(path.read_text("utf-8"))["sensors"]
    rows = []
    for name, entries in sensors.items():
        for key, value in entries.items():
            if key not in ("kind", "source"):
                rows.append((name, f"`{key}`", ", ".join(value) if type(value) is list else value))
    listed = "".join(f"- **{name}**: {entries['source']}\n" for name, entries in sensors.items())
    return listed + "\n" + _table(("sensor", "key", "value"), rows)


for _profile in ("hydrone", "gloria"):
    part(f"{_profile}-sensors")(partial(sensors_of, _profile))


# ---------------------------------------------------------------------- hydrone.md: runs


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
    x, y, z = (signals[f"hull.position.{axis}"] for axis in "xyz")
    angles = [np.degrees(signals[f"hull.attitude.{a}"]) for a in ("phi", "theta", "psi")]
    settles = next(v["worst"] for v in run.verdicts if "settles" in v["check"])
    load = signals["downwash.load"]
    return Motion(run.time, x, y, z, *angles, load, bool(run.passed), settles)


@contextlib.contextmanager
def _elsewhere():
    """Work in an empty folder, where no file can stand in for a shipped one."""
    with tempfile.TemporaryDirectory() as folder, contextlib.chdir(folder):
        yield Path(folder)


@cache
def _campaign(name: str) -> dict[tuple[str, str], Motion]:
    """Return the runs of a campaign by phase and what was varied."""
    motions = {}
    with _elsewhere() as folder:
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
    with _elsewhere() as folder:
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
    craft.set("load_force", [0.0, 0.0, weight])
    craft.set("load_moment", [pad_y * weight, -pad_x * weight, 0.0])
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
                _fixed(row.ours, row.decimals),
                row.unit,
                _fixed(off, row.decimals),
                f"{row.tolerance:g}",
                "yes" if abs(off) <= row.tolerance else "**no**",
            )
        )
    head = ("quantity", "place", "stated", "ours", "unit", "difference", "tolerance", "reproduced")
    return _table(head, rows)


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
                    *(_fixed(m.peak(name, since), 2) for name in ("roll", "pitch")),
                    *(_fixed(m.at(name, 20), 2) for name in ("roll", "pitch")),
                    _fixed(m.peak("z", since), 4),
                    _fixed(m.settling, 2),
                    "pass" if m.passed else "fail",
                )
            )
    head = (
        *("phase", "landing point", "largest roll, deg", "largest pitch, deg"),
        *("roll at 20 s, deg", "pitch at 20 s, deg", "largest heave, m"),
        *("heave settles in, s", "limits of table 7"),
    )
    return _table(head, rows)


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
                        *(_fixed(m.peak(name, since), 2) for name in ("roll", "pitch")),
                        *(_fixed(m.at(name, 20), 2) for name in ("roll", "pitch", "yaw")),
                    )
                )
    head = (
        *("phase", "landing point", "variant", "largest roll, deg", "largest pitch, deg"),
        *("roll at 20 s, deg", "pitch at 20 s, deg", "yaw at 20 s, deg"),
    )
    return _table(head, rows)


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
                *(_fixed(m.peak(name, since), 2) for name in ("roll", "pitch")),
                *(_fixed(m.at(name, 20), 2) for name in ("roll", "pitch")),
                _fixed(m.at("z", 20), 4),
            )
        )
    head = (
        *("phase", "changed", "largest roll, deg", "largest pitch, deg"),
        *("roll at 20 s, deg", "pitch at 20 s, deg", "heave at 20 s, m"),
    )
    return _table(head, rows)


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

    return _table(
        (
            "roll and pitch damping",
            *(f"yaw at 20 s, {PHASE_NAMES[phase]}, deg" for phase in PHASES),
        ),
        [
            (
                f"{factor:.0%}".replace("%", " %"),
                *(
                    _fixed(_open(ph, "diagonal-aft", "physical", less(factor)).at("yaw", 20), 2)
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
                    *(_fixed(m.peak(angle, since), 2) for angle in ("roll", "pitch")),
                    _fixed(float(np.hypot(m.x, m.y).max()), 3),
                    *(_fixed(yaw, 2) for yaw in (m.peak("yaw"), m.at("yaw", 20))),
                )
            )
    head = (
        *("phase", "thrusters", "largest roll, deg", "largest pitch, deg"),
        *("greatest distance from the start, m", "largest yaw, deg", "yaw at 20 s, deg"),
    )
    return _table(head, rows)


@part("hydrone-static")
def hydrone_static() -> str:
    """Equilibria under the standing HUAUV, variant source, by trim."""
    rows = []
    for pad, entry in load_vehicle("hydrone").file.presets["downwash"]["pad"].items():
        assert isinstance(entry.value, list)
        z, roll, pitch = _static(*entry.value[:2])
        rows.append((pad, _fixed(z, 5), _fixed(roll, 3), _fixed(pitch, 3)))
    return _table(("landing point", "sinkage, m", "roll, deg", "pitch, deg"), rows)


# ---------------------------------------------------------------------- trials and their criteria


def verdicts(rig: str) -> str:
    """Every criterion of the trials whose names begin so, and what was found."""
    rows = []
    for path in sorted((shipped_folder("harness") / "trials").glob(f"{rig}-*.toml")):
        with _elsewhere() as folder:
            run = load_run(run_trial(load_trial(path.stem), folder / "out", engine="direct").folder)
        for verdict in run.verdicts:
            found = verdict["detail"].partition("; ")[0].replace("-", "−")
            holds = "yes" if verdict["passed"] else "**no**"
            rows.append((f"`{path.stem}`", verdict["name"], holds, found))
    return _table(("trial", "criterion", "holds", "found"), rows)


for _rig in ("gloria-fixed", "gloria-pid", "gloria-backstepping", "mariner", "thruster-ship"):
    part(f"{_rig}-trials")(partial(verdicts, _rig))


# ---------------------------------------------------------------------- the two ships


@part("mariner-gains")
def mariner_gains() -> str:
    """Gains of the source's ship for a damping ratio of 0.7071, and limits of stability."""
    design = design_heading("mariner", "source", (0.0, -1.3427, 1.25379))
    stable = {number(one.derivative_time, 6): stability(one) for one in design.loci}
    return _table(
        ("T_d, L/U", "K", "poles, U/L", "least damping ratio", "stable for"),
        [
            (
                row.derivative_time.replace("-", "−"),
                row.K,
                row.poles.replace("-", "−"),
                row.damping,
                stable[row.derivative_time],
            )
            for row in design_rows(design)
        ],
    )


@part("thruster-ship-cases")
def thruster_ship_cases() -> str:
    """The six published cases after 10 s, nonlinear and linear."""
    lines = []
    with _elsewhere() as folder:
        run_campaign(load_campaign("thruster-ship-cases"), folder / "out", engine="direct")
        for case in json.loads((folder / "out/campaign.json").read_text())["cases"]:
            end = {k: v[-1] for k, v in load_run(folder / "out" / case["folder"]).signals.items()}
            ends = [
                [end[f"{model}.{s}"] for s in ("position.x", "position.y", "attitude.psi")]
                for model in ("nonlinear", "linear")
            ]
            shown = [number(value, 6).replace("-", "−") for value in (*ends[0], *ends[1])]
            lines.append((next(iter(case["set"].values())), *shown))
    axes = ("x, m", "y, m", "psi, rad")
    head = [f"{model} {axis}" for model in ("nonlinear", "linear") for axis in axes]
    return _table(("case", *head), lines)


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
