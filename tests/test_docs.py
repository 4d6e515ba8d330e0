"""The pages below docs/: their examples run, their tables are complete and up to date."""

from __future__ import annotations

import datetime
import doctest
import importlib
import importlib.util
import json
import re
import shlex
import shutil
import subprocess
import sys
import tomllib
from collections.abc import Iterator
from contextlib import ExitStack
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
import pytest
from pydantic import BaseModel
from pydantic_core import PydanticUndefined

from seatrial.model.units import quantity
from seatrial.physics.craft.marine_craft import MarineCraft
from seatrial.physics.environment.downwash import Downwash
from seatrial.shipped import available, provided_folders
from seatrial.system.files import FileModel
from seatrial.system.parameters import load_vehicle
from seatrial.trial.criteria.criteria import parse
from seatrial.trial.files.trial import load_trial
from seatrial.trial.records.run_folder import load_run
from seatrial.trial.running.run import run_trial
from tests.command import seatrial
from tests.interop.running import HOST, free_port, running, wait_for

pytestmark = pytest.mark.interop

ROOT = Path(__file__).parents[1]
DOCS = ROOT / "docs"
DESIGN = DOCS / "design.md"
HOW_TO, KITS, REFERENCE = DOCS / "how-to", DOCS / "kits", DOCS / "reference"
FILES, RESULTS = REFERENCE / "files.md", REFERENCE / "results.md"
CRITERIA, PROFILE = HOW_TO / "state-criteria.md", HOW_TO / "write-a-profile.md"
DINGHY = [
    HOW_TO / f"{name}.md"
    for name in (
        "write-a-rig",
        "run-a-trial",
        "inject-faults",
        "state-criteria",
        "run-a-campaign",
        "write-a-vehicle-file",
        "write-a-profile",
    )
]
"""The pages of one dinghy: each has some of its files."""
COMPONENT = [
    HOW_TO / f"{name}.md"
    for name in ("write-a-component", "write-a-sensor", "write-a-plant", "build-an-fmu")
]
"""The pages of a user's own components."""
LONG = {
    KITS / "identify/identification.md",
    KITS / "identify/from-trials.md",
    HOW_TO / "decide-with-campaigns.md",
    DOCS / "vehicles/guidance.md",
    DOCS / "kits/fitted/remus100.md",
    DOCS / "kits/fitted/supply-ship.md",
    HOW_TO / "new-vehicle.md",
    HOW_TO / "own-vehicle.md",
    HOW_TO / "shadow.md",
}
"""Pages whose examples take minutes."""
ELSEWHERE = {
    KITS / "arduino/arduino.md",  # a fixture of the sketch's own tests
    KITS
    / "ardupilot/autopilots.md",  # tests/kits/ardupilot: time stands still until a firmware comes
    KITS / "px4/px4.md",  # tests/kits/px4: the same
    KITS / "ros2/ros2.md",  # tests/kits/ros2: a run that waits for nodes
    KITS / "ros2/ros2-controller.md",  # the same, where there is a ROS 2
    KITS / "mavlink/ground-stations.md",  # sessions of MAVSDK and MAVProxy, in tests/interop
    HOW_TO / "test-with-pytest.md",  # tests/testing
    DOCS / "tutorials/ci.md",  # tests/testing: a project of its own
    REFERENCE / "cli.md",  # made from the commands' own help
    DOCS / "performance.md",  # a benchmark
    KITS / "live/watch-a-run.md",  # tests/kits/live: pages that wait for a browser
}
"""Pages whose examples other tests run, or none."""
MADE = {KITS / "panels/panel-codes.md": ("barge_capytaine.nc", "vehicles/barge.nc")}
"""What a page makes with a tool that is not installed here: reference data, and its place."""
LIVE = re.compile(r"^\$ seatrial run (\S+-mission)\n", re.M)
"""A trial for ground stations: it goes on while the rest of the page is run."""
STATION_PORT = "14550"


def _script(path: Path) -> Any:
    spec = importlib.util.spec_from_file_location(f"docs_{path.stem}", path)
    assert spec is not None
    assert spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    sys.modules[spec.name] = module
    spec.loader.exec_module(module)
    return module


TABLES = _script(DOCS / "tables.py")
DIAGRAMS = _script(DOCS / "diagrams.py")


# ---------------------------------------------------------------------- a page taken apart


class Block(NamedTuple):
    """A block of code, and the file that the line before it names."""

    language: str
    file: str
    text: str
    line: int


def blocks(page: Path) -> list[Block]:
    text = page.read_text("utf-8")
    found = re.finditer(r"(?:^`([^`\n]+)`:\n\n)?^```(\w+)\n(.*?)^```$", text, re.DOTALL | re.M)
    return [Block(m[2], m[1] or "", m[3], text.count("\n", 0, m.start()) + 1) for m in found]


def rows_after(page: Path, marker: str) -> Iterator[list[str]]:
    """Yield the cells of the table that follows ``marker``, without its head."""
    text = page.read_text("utf-8")
    lines = text[text.index(marker) :].splitlines()
    table = [line for line in lines[1:] if line.strip()]
    for line in table[2:]:
        if not line.startswith("|"):
            return
        yield [cell.strip() for cell in re.split(r"(?<!\\)\|", line)[1:-1]]


# ---------------------------------------------------------------------- examples


def run_page(page: Path, folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Write a page's files and run its commands and Python, in the order of the page."""
    monkeypatch.chdir(folder)
    monkeypatch.syspath_prepend(str(folder))
    found, port = blocks(page), str(free_port())
    for shared in (DINGHY, COMPONENT):
        if page in shared:
            write_files([block for each in shared for block in blocks(each)], folder)
    if any(LIVE.match(block.text) for block in found):
        found = [block._replace(text=block.text.replace(STATION_PORT, port)) for block in found]
    write_files(found, folder)
    if page in MADE:
        made, place = MADE[page]
        shutil.copy(ROOT / "tests/reference" / made, folder / place)
    with ExitStack() as background:
        run_blocks(page, [live(block, folder, port, background) for block in found])
    for file in folder.glob("*.py"):
        sys.modules.pop(file.stem, None)


def write_files(found: list[Block], folder: Path) -> None:
    for block in found:
        if block.file:
            path = folder / block.file
            path.parent.mkdir(parents=True, exist_ok=True)
            path.write_text(block.text, "utf-8")


def live(block: Block, folder: Path, port: str, background: ExitStack) -> Block:
    """Start the trial for ground stations that a block starts with; return the rest of it."""
    trial = LIVE.match(block.text)
    if trial is None:
        return block
    links = f"udpout:{HOST}:{port}"
    running_trial = background.enter_context(
        running(trial[1], folder, autopilot__mavlink__links=links)
    )
    wait_for(lambda: running_trial.is_running, f"{trial[1]} runs", 180.0)
    return block._replace(text=block.text[trial.end() :])


def run_blocks(page: Path, found: list[Block]) -> None:
    """Run commands and Python, in the order of the page."""
    names: dict[str, Any] = {}
    runner = doctest.DocTestRunner(optionflags=doctest.ELLIPSIS, verbose=False)
    for block in found:
        if block.language == "console" and block.text:
            run_commands(block)
        elif block.text.startswith(">>>"):
            test = doctest.DocTestParser().get_doctest(
                block.text, names, page.name, str(page), block.line
            )
            output: list[str] = []
            runner.run(test, out=output.append, clear_globs=False)
            assert not output, "".join(output)
            names = test.globs
        elif block.text:
            assert block.file, f"{page.name}, line {block.line}: a block that nothing runs"


def run_commands(block: Block) -> None:
    commands = re.findall(r"^\$ ([^\n]*)\n((?:(?!\$ )[^\n]*\n)*)", block.text, re.M)
    assert commands
    for line, shown in commands:
        words = shlex.split(line, comments=True)
        assert words[0] in ("seatrial", "python")
        if words[0] == "seatrial":
            done: Any = seatrial(*words[1:], cwd=Path())
        else:
            program = [sys.executable, *words[1:]]
            done = subprocess.run(program, capture_output=True, text=True, check=False)
        got = done.stdout + re.sub(
            r"(?m)^.*: \d+ %, .* (x real time|cases/s)\b.*\n", "", done.stderr
        )
        matches = doctest.OutputChecker().check_output(shown, got, doctest.ELLIPSIS)
        assert matches or not shown, f"{line}\n{got}"
        shows_failure = re.search(
            r"FAIL|seatrial: |Error|of \d+ cases pass|went from pass to fail", shown
        )
        assert done.returncode == 0 or shows_failure, f"{line}: status {done.returncode}\n{got}"


def pages_with_examples() -> list[Any]:
    return [
        pytest.param(page, marks=pytest.mark.long if page in LONG else (), id=page.stem)
        for page in sorted(DOCS.rglob("*.md"))
        if page not in ELSEWHERE and blocks(page)
    ]


@pytest.mark.parametrize("page", pages_with_examples())
def test_examples_run(page: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    run_page(page, tmp_path, monkeypatch)


# ---------------------------------------------------------------------- keys of files


def file_models() -> set[type[BaseModel]]:
    """Return every model of a file that a module of seatrial names."""
    for path in (ROOT / "src").rglob("*.py"):
        if "BaseModel" in (text := path.read_text("utf-8")) or "FileModel" in text:
            module = path.relative_to(ROOT / "src").with_suffix("")
            importlib.import_module(".".join(module.parts))

    def below(cls: type[BaseModel]) -> Iterator[type[BaseModel]]:
        for sub in cls.__subclasses__():
            yield sub
            yield from below(sub)

    return {
        cls
        for cls in below(FileModel)
        if getattr(sys.modules.get(cls.__module__), cls.__name__, None) is cls
    }


def key_tables() -> dict[type[BaseModel], dict[str, str]]:
    """Return, per model that a page names, the default that it says for each key."""
    tables = {}
    for page in [*HOW_TO.glob("*.md"), *KITS.rglob("*.md"), *REFERENCE.glob("*.md")]:
        for name in re.findall(r"<!-- keys of (\S+) -->", page.read_text("utf-8")):
            module, _, model = name.rpartition(".")
            cls = getattr(importlib.import_module(module), model)
            assert cls not in tables, f"two tables of {name}"
            rows = rows_after(page, f"<!-- keys of {name} -->")
            tables[cls] = {row[0].strip("`"): row[2] for row in rows}
    return tables


def test_every_kind_of_file_has_a_table_of_its_keys() -> None:
    assert set(key_tables()) == file_models()


@pytest.mark.parametrize("model", key_tables(), ids=lambda model: model.__name__)
def test_keys_and_defaults_are_those_of_the_model(model: type[BaseModel]) -> None:
    shown = key_tables()[model]
    if "COMPONENT" in shown:  # every other table of a vehicle file
        shown["components"] = shown.pop("COMPONENT")
    fields = {field.alias or name: field for name, field in model.model_fields.items()}
    assert list(shown) == list(fields) or sorted(shown) == sorted(fields)
    for key, field in fields.items():
        default = field.get_default(call_default_factory=True, validated_data={})
        if default is PydanticUndefined:
            expected = "needed"
        elif isinstance(default, BaseModel):
            continue
        elif default is None:
            expected = "none"
        elif default in ("", {}, []):
            expected = "empty"
        elif isinstance(default, datetime.date):
            expected = f"`{default}`"
        else:
            expected = f"`{json.dumps(default)}`"
        assert shown[key] == expected, key


def test_every_top_level_key_of_the_shipped_files_is_in_its_page() -> None:
    pages = {
        "harness/rigs": "write-a-rig",
        "harness/trials": "run-a-trial",
        "harness/campaigns": "run-a-campaign",
    }
    for kind, name in pages.items():
        text = (HOW_TO / f"{name}.md").read_text("utf-8")
        for path in [p for folder in provided_folders(kind) for p in folder.glob("*.toml")]:
            for key in tomllib.loads(path.read_text("utf-8")):
                assert f"`{key}`" in text, f"{path}: {key}"
    text = (REFERENCE / "profile-keys.md").read_text("utf-8")
    for path in [p for folder in provided_folders("hil_profiles") for p in folder.glob("*.toml")]:
        for key in tomllib.loads(path.read_text("utf-8")):
            assert f"`{key}`" in text, f"{path}: {key}"


# ---------------------------------------------------------------------- what the pages on files say


@pytest.fixture(scope="module")
def dash(tmp_path_factory: pytest.TempPathFactory) -> Any:
    """Return the record of the pages' trial."""
    folder = tmp_path_factory.mktemp("dash")
    write_files([block for page in DINGHY for block in blocks(page)], folder)
    with pytest.MonkeyPatch.context() as patch:
        patch.chdir(folder)
        return load_run(
            run_trial(load_trial("dinghy-dash"), folder / "out", engine="direct").folder
        )


def criteria_of_the_page() -> list[str]:
    text = CRITERIA.read_text("utf-8")
    cells = [row for row in text.splitlines() if row.startswith("| ")]
    texts = [t for row in cells for t in re.findall(r"`([^`]+)`", row) if re.search(r"\w\.\w", t)]
    assert len(texts) > 15
    return texts


@pytest.mark.parametrize("text", criteria_of_the_page())
def test_criteria_of_the_page_can_be_evaluated_and_hold(text: str, dash: Any) -> None:
    """On the record of the pages' trial, and beside it signals of other rigs."""
    late, always = dash.time >= 5.0, dash.time >= 0.0
    others = {
        "gnss.valid": ~always,
        "gnss.powered": always,
        "autopilot.armed": late,
        "autopilot.mode": np.full(dash.time.shape, "AUTO"),
        "mega.uart0": np.full(dash.time.shape, "OK"),
        "thruster.thrust": np.zeros(dash.time.shape),
        "valve.open": late,
        "panel.pressed": dash.time >= 4.0,
        "helm.ahead": always,
    }
    units = dict.fromkeys(others, "1") | {"thruster.thrust": "N"} | dash.units
    verdict = parse(text).evaluate(dash.time, others | dash.signals, units)
    assert verdict.passed, verdict.detail


def test_bands_of_settling(dash: Any) -> None:
    rows = list(rows_after(CRITERIA, "| example | band |\n"))
    (section,) = [CRITERIA.read_text("utf-8").partition("| example | band |\n")[2]]
    bands = re.findall(r"^\| `([^`]+)` \| (\d+) % \|$", section, re.M)
    assert len(bands) == 3, rows
    for text, band in bands:
        criterion = parse(text)
        settling: Any = criterion.says
        assert settling.band == pytest.approx(float(band) / 100)
        times, x = dash.time, dash.signals["hull.velocity.u"]
        outside = np.abs(x - x[-1]) > settling.band * np.abs(x - x[-1]).max()
        last = times[np.flatnonzero(outside & (times >= 11.0))[-1]]
        took = criterion.evaluate(times, dash.signals, dash.units).worst
        assert last - 11.0 <= took <= last - 11.0 + 0.02


@pytest.mark.parametrize(
    ("text", "unit"),
    [("24 kg", "kg"), ("10 deg", "rad"), ("1650 us", "s"), ("0.2 kn", "m/s")],
)
def test_quantities_of_the_page(text: str, unit: str) -> None:
    assert f'`"{text}"`' in FILES.read_text("utf-8")
    quantity(text, unit)


def test_units_of_the_page() -> None:
    section = re.search(r"customary units are\s+known\s+\((.*?)\)", FILES.read_text("utf-8"), re.S)
    assert section is not None
    for name in re.findall(r"`([^`]+)`", section[1]):
        importlib.import_module("seatrial.model.units").unit(name)


def test_values_come_from_where_the_page_says(write: Any, tmp_path: Path) -> None:
    """Each parameter is set one level higher than the one before; the highest wins."""
    names = [
        *("heading_resolution", "seed", "variation", "heading_instability", "heading_noise"),
        *("heading_bias", "delay", "dropout", "correlation_time"),
    ]
    units = dict.fromkeys(names, "rad") | {"delay": "s", "dropout": "1", "correlation_time": "s"}

    def entries(of: list[str], value: float) -> str:
        return "".join(
            f'{n} = {{ value = {value}, unit = "{units[n]}", source = "x", mark = "assumed" }}\n'
            for n in of
        )

    def written(of: list[str], value: float) -> str:
        shown = (f'{n} = "{value}{" " + units[n] if units[n] != "1" else ""}"' for n in of)
        return "\n".join(shown)

    write(
        "v.toml",
        'title = "v"\nsource = "x"\ndefault = "a"\n'
        f"[compass]\n{entries(names[2:], 0.1)}[variants.a.compass]\n{entries(names[3:], 0.2)}",
    )
    profile = next(b.text for b in blocks(PROFILE) if b.file.startswith("hil_profiles"))
    profile = profile[: profile.index("[sensors")]
    write(
        "p.toml",
        f'{profile}[sensors.c]\nkind = "compass"\nsource = "x"\n{written(names[4:], 0.3)}\n',
    )
    rig_set = written(names[5:], 0.4).replace("\n", ", ")
    write(
        "r.toml",
        'step = "10 ms"\nprofile = "p.toml"\n[components]\nc = { fmu = "compass", '
        f'parameters = "v.toml", profile = "sensors.c", set = {{ {rig_set} }} }}\n',
    )
    trial_set = "\n".join(
        f'"c.{line.replace(" =", chr(34) + " =", 1)}'
        for line in written(names[6:], 0.5).splitlines()
    )
    path = write("t.toml", f'rig = "r.toml"\nstop = "1 s"\n[set]\n{trial_set}\n')
    trial = load_trial(str(path)).changed(
        {"c.dropout": 0.6, "c.correlation_time": "0.6 s"}, "--set"
    )
    trial = trial.scaled("c.correlation_time", 2.0, "scale")
    result = run_trial(trial, tmp_path / "out", engine="direct")
    given = load_run(result.folder).manifest["components"]["c"]["parameters"]
    assert given["heading_resolution"]["from"] == "start value of the FMU"
    assert given["seed"]["from"] == "derived from seed 1"
    values = [given[name]["value"] for name in names[2:]]
    assert values == [0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 1.2]
    origins = [given[name]["from"] for name in names[2:]]
    for origin, part in zip(
        origins,
        [
            "[compass]",
            "variant a",
            "[sensors.c]",
            "components.c.set",
            "t.toml: set",
            "--set",
            "scale",
        ],
        strict=True,
    ):
        assert part in origin


def test_exit_statuses_of_the_page(write: Any) -> None:
    """0 and 1 by the page's own commands; 2 and 3 here."""
    statuses = importlib.import_module("seatrial.cli.statuses")
    shown = {row[0]: row[1] for row in rows_after(RESULTS, "## Exit status")}
    assert list(shown) == ["0", "1", "2", "3"]
    assert (statuses.FAILED, statuses.BAD_INPUT, statuses.BROKEN) == (1, 2, 3)


# ---------------------------------------------------------------------- tables made from code


VERDICTS = "-trials"
"""How the tables end that need minutes of whole trials."""


SLOW = {
    "hydrone-stated",
    "hydrone-sensitivity",
    "hydrone-sensitivity-more",
    "videoray-actuation",
    "hydrone-three-variants",
    "vehicles-campaign",
    "native-carried",
    *(f"videoray-rejection{part}" for part in ("", "-table75", "-table81")),
}


def made_parts(*, verdicts: bool | None = None) -> list[Any]:
    """Return page and name of the tables; those that take long are compared in the long run."""
    return [
        pytest.param(
            page,
            name,
            id=name,
            marks=pytest.mark.long
            if verdicts is None and (name.endswith(VERDICTS) or name in SLOW)
            else (),
        )
        for page, names in TABLES.pages().items()
        for name in names
        if verdicts is None or name.endswith(VERDICTS) == verdicts
    ]


@pytest.mark.parametrize(("page", "name"), made_parts())
def test_a_table_is_up_to_date(page: Path, name: str) -> None:
    assert TABLES.written(page, name) == TABLES.made(name), "run: python docs/tables.py"


@pytest.mark.interop
@pytest.mark.parametrize("vehicle", DIAGRAMS.DRAWN)
def test_a_block_diagram_is_up_to_date(vehicle: str, tmp_path: Path) -> None:
    """In all that it says; other versions of Graphviz have other places."""
    said = [
        re.findall(r"<title>.*?</title>|<text[^>]*>.*?</text>", path.read_text("utf-8"), re.DOTALL)
        for path in (DIAGRAMS.draw(vehicle, tmp_path), DIAGRAMS.IMAGES / f"rig-{vehicle}.svg")
    ]
    made, kept = (sorted(re.sub(r' [xy]="[^"]*"', "", text) for text in texts) for texts in said)
    assert made == kept, "run: python docs/diagrams.py"


@pytest.mark.parametrize(("page", "name"), made_parts(verdicts=True))
def test_a_table_of_verdicts_has_every_criterion(page: Path, name: str) -> None:
    stem = name.removesuffix(VERDICTS)
    trials = (
        trial
        for trial in available("harness/trials")
        if trial == stem or trial.startswith(f"{stem}-")
    )
    loaded = {trial: load_trial(trial) for trial in sorted(trials, key=lambda name: f"{name}.toml")}
    expected = [
        [f"`{trial}`", criterion]
        for trial, found in loaded.items()
        for criterion, _ in found.criteria
        if not found.file.real_time
    ]
    shown = list(rows_after(page, f"<!-- made by docs/tables.py: {name} -->"))
    assert [row[:2] for row in shown] == expected, f"run: python docs/tables.py {page.name}"
    assert {row[2] for row in shown} <= {"yes", "**no**"}


def test_every_table_that_can_be_made_is_in_a_page() -> None:
    shown = [name for names in TABLES.pages().values() for name in names]
    assert sorted(shown) == sorted(TABLES.PARTS)


# ---------------------------------------------------------------------- hydrone.md: what its text says


def test_figures_in_the_text_of_the_hydrone() -> None:
    aft, across = (
        TABLES.hydrone._open("landing", pad, "source") for pad in ("diagonal-aft", "transversal")
    )
    assert aft.at("x", 20) == pytest.approx(-0.04, abs=0.005)
    speed = np.hypot(*(np.diff(axis)[-1] for axis in (across.x, across.y))) / 0.01
    assert speed == pytest.approx(1.2e-3, abs=0.05e-3)
    standing = TABLES.hydrone._open("landing", "diagonal-aft", "physical").at("roll", 20)
    peak = TABLES.hydrone._open("takeoff", "diagonal-aft", "physical").peak(
        "roll", TABLES.hydrone.SPOOL_UP
    )
    assert 0.0 < abs(peak) - abs(standing) < 0.15
    for phase in TABLES.hydrone.PHASES:
        for run in (
            TABLES.hydrone._single(f"hydrone-{phase}", ()),
            TABLES.hydrone._open(phase, "diagonal-aft", "physical"),
        ):
            assert abs(run.peak("roll")) > 10.0


@pytest.mark.parametrize("phase", ["landing", "takeoff"])
def test_solvers_agree_as_the_page_says(phase: str) -> None:
    vehicle = load_vehicle("hydrone")
    downwash = Downwash("downwash")
    craft = MarineCraft("hull")
    for component, table in ((downwash, "downwash"), (craft, "marine-craft")):
        for name, entry in vehicle.parameter_set(table, "source").values.items():
            component.set(name, entry.value)
    downwash.set("phase", phase)
    downwash.set(
        "pad", vehicle.parameter_set("downwash", None).presets["pad"]["diagonal-aft"].value
    )

    def load(t: float, x: Any) -> dict[str, Any]:
        force, moment = downwash.wrench(t, x.attitude.tolist())
        return {"force_2": force, "moment_2": moment}

    runs = [
        craft.reference(np.arange(21.0), load, downwash.breaks(), method=m, rtol=1e-6, atol=1e-6).x
        for m in ("RK23", "RK45", "DOP853")
    ]
    apart = np.max([np.abs(a - b).max(axis=0) for a in runs for b in runs], axis=0)
    assert apart[:6].max() < 1e-6
    assert 1e-6 < apart[6:].max() < 1e-5


# ---------------------------------------------------------------------- all pages


@pytest.mark.parametrize("page", sorted(DOCS.rglob("*.md")), ids=lambda page: page.stem)
def test_images_are_small_and_links_lead_somewhere(page: Path) -> None:
    text = page.read_text("utf-8")
    anchors = {
        re.sub(r"[^\w\- ]", "", heading.lower()).strip().replace(" ", "-")
        for heading in re.findall(r"^#+ (.*)$", text, re.M)
    }
    for target in re.findall(r"\]\(([^)\s]+)\)", text):
        if target.startswith("#"):
            assert target[1:] in anchors, target
        elif "://" not in target:
            file = page.parent / target.partition("#")[0]
            assert file.exists(), target
            assert file.suffix != ".png" or file.stat().st_size < 150_000, target


# ---------------------------------------------------------------------- decisions

RECORDS = sorted(set((DOCS / "decisions").glob("*.md")) - {DOCS / "decisions/index.md"})


@pytest.mark.parametrize("record", RECORDS, ids=lambda record: record.stem)
def test_a_decision_is_whole_and_names_tests_that_exist(record: Path) -> None:
    text = record.read_text("utf-8")
    assert re.findall(r"^## (.*)$", text, re.M) == ["Context", "Decision", "Consequence", "Test"]
    held = text[text.index("## Test") :]
    for file, names in re.findall(r"^- `([\w/]+\.py)`: (.*(?:\n  .*)*)", held, re.M):
        tests = (ROOT / file).read_text("utf-8")
        for name in re.findall(r"`(\w+)`", names):
            assert f"def {name}(" in tests, f"{file}: {name}"
    index = (DOCS / "decisions/index.md").read_text("utf-8")
    assert f"[{text.splitlines()[0].removeprefix('# ')}]({record.name})" in index


# ---------------------------------------------------------------------- design.md


def test_layers_of_the_page_are_those_of_the_contract() -> None:
    config = tomllib.loads((ROOT / "pyproject.toml").read_text("utf-8"))["tool"]["importlinter"]
    layers, forbidden, *_ = config["contracts"]
    text = DESIGN.read_text("utf-8")
    diagram = re.search(r"```\n(cli .*?)```", text, re.DOTALL)
    assert diagram is not None
    shown = [set(re.findall(r"\w+", line.partition("  ")[0])) for line in diagram[1].splitlines()]
    contract = []
    for layer in layers["layers"]:
        modules = [module.strip(" ()") for module in layer.split("|")]
        exists = [
            m for m in modules if (ROOT / "src" / m.replace(".", "/")).exists() or "(" not in layer
        ]
        contract.append({module.removeprefix("seatrial.") for module in exists})
    assert shown == contract
    second = text[text.index("The second contract") :].partition("\n\n")[0]
    named = set(re.findall(r"`(\w+)`", second))
    assert named == {m.removeprefix("seatrial.") for m in forbidden["source_modules"]}
