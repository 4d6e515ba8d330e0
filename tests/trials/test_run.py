"""Running trials: both carriers, reruns, failures, events, mistakes in trial files."""

from __future__ import annotations

import csv
import html
import json
from pathlib import Path

import pytest

import seatrial
from seatrial.errors import InputError
from seatrial.trial.files.trial import load_trial
from seatrial.trial.records.run_folder import load_run
from seatrial.trial.reports.report import write_report
from seatrial.trial.running.output import claim_folder
from seatrial.trial.running.run import Hooks, StoppedError, run_trial
from tests.kit import needs_kits
from tests.trials.conftest import figure_below

BOAT = '''
"""A boat for trials."""
from seatrial.model.component import Component, Input, Noise, Output, Parameter
from seatrial.model.sampled import Sampled


class Boat(Noise, Sampled):
    """Drifts with noise, and may fail."""

    fail_at = Parameter(1e9, "s", "time of a failure")
    how = Parameter("raise", "1", "how", choices=("raise", "nan", "exit"))
    push = Input("N", "force")
    dry = Input("1", "flag", type=bool)
    trim = Parameter(1.0, "rad", "trim", tunable=True)
    mode = Parameter("calm", "1", "mode", choices=("calm", "storm"))
    x = Output("m", "place")
    angle = Output("rad", "an angle")
    label = Output("1", "text", type=str)
    wet = Output("1", "flag", type=bool)

    def reset(self, t):
        self.place = 0.0

    def sample(self, t, k):
        self.x = self.place + 0.01 * self.generator(k).standard_normal()
        self.angle = self.trim
        self.wet = self.place > 0.1
        self.label = f'{self.mode}, "{k}"'

    def update(self, t, k):
        if t >= self.fail_at:
            if self.how == "raise":
                raise OSError("the radio is on fire")
            if self.how == "exit":
                raise SystemExit(5)
            self.place = float("nan")
        self.place += 0.01 * (1.0 + self.push)
'''
RIG = """
step = "10 ms"
[components]
boat = { fmu = "boat.py:Boat" }
twin = { fmu = "boat.py:Boat" }
"""
TRIAL = """
rig = "rig.toml"
stop = "1 s"
[[criteria]]
name = "stays near"
check = "abs(boat.x) < 2 m"
"""
FAULT = TRIAL + '[[faults]]\n{}\nwhere = "{}"\n'
PLOT = TRIAL + '[[plots]]\ntitle = "both"\nsignals = [{}]\n'


@pytest.fixture
def bench(write):
    write("boat.py", BOAT)
    write("rig.toml", RIG)

    def trial(text: str = TRIAL) -> str:
        return str(write("trial.toml", text))

    return trial


def test_both_carriers_and_a_rerun_give_the_same_bytes(bench, tmp_path: Path) -> None:
    trial = load_trial(bench())
    records = []
    for number, engine in enumerate(("fmu", "direct", "fmu")):
        result = run_trial(trial, tmp_path / str(number), engine=engine)
        assert result.passed
        records.append((result.folder / "signals.csv").read_bytes())
    assert records[0] == records[1] == records[2]
    manifests = [json.loads((tmp_path / n / "manifest.json").read_text()) for n in ("0", "2")]
    assert manifests[0] == manifests[1]


def test_seeds_give_each_instance_its_own_noise(bench, tmp_path: Path) -> None:
    def column(seed: int, name: str) -> list[str]:
        folder = tmp_path / f"{seed}-{name}-{len(list(tmp_path.iterdir()))}"
        run_trial(load_trial(bench()).changed({"seed": seed}, "test"), folder, engine="direct")
        rows = [line.split(",") for line in (folder / "signals.csv").read_text().splitlines()]
        return [row[rows[0].index(f"{name}.x")] for row in rows[1:]]

    assert column(1, "boat") != column(1, "twin")
    assert column(1, "boat") != column(2, "boat")


@pytest.mark.parametrize("engine", ["fmu", "direct"])
@pytest.mark.parametrize(
    ("how", "expected"),
    [("raise", "the radio is on fire"), ("nan", "output x is nan"), ("exit", "SystemExit")],
)
def test_a_failure_keeps_what_was_recorded(engine, how, expected, bench, tmp_path: Path) -> None:
    settings = {"boat.fail_at": 0.5, "boat.how": how}
    result = run_trial(
        load_trial(bench()).changed(settings, "test"), tmp_path / "run", engine=engine
    )
    assert result.status == "failed"
    assert "boat" in result.error
    assert expected in result.error
    assert not result.passed
    rows = (tmp_path / "run" / "signals.csv").read_text().splitlines()
    assert len(rows) - 1 == 51  # times 0 to 0.5 s
    manifest = json.loads((tmp_path / "run" / "manifest.json").read_text())
    assert (manifest["status"], manifest["error"]) == ("failed", result.error)
    timing = json.loads((tmp_path / "run" / "timing.json").read_text())
    assert timing["steps"] == 50
    assert result.error in html.unescape(write_report(tmp_path / "run").read_text("utf-8"))


@pytest.mark.parametrize("before", ["building", "starting"])
def test_a_run_stopped_before_it_begins_leaves_nothing(before, bench, tmp_path: Path) -> None:
    polls = iter(range(1000))
    allowed = {"building": 1, "starting": 2}[before]  # one poll for each component
    hooks = Hooks(stop_requested=lambda: next(polls) >= allowed)
    with pytest.raises(StoppedError, match="before the run began"):
        run_trial(load_trial(bench()), tmp_path / "run", engine="direct", hooks=hooks)
    assert not (tmp_path / "run").exists()


def test_a_stopped_run_is_whole(bench, tmp_path: Path) -> None:
    polls = iter(range(1000))
    hooks = Hooks(stop_requested=lambda: next(polls) >= 33)  # 3 of them before the run begins
    result = run_trial(load_trial(bench()), tmp_path / "run", engine="direct", hooks=hooks)
    assert (result.status, result.passed) == ("stopped", False)
    assert len((tmp_path / "run" / "signals.csv").read_text().splitlines()) == 32


def test_events_set_and_faults_replace(bench, tmp_path: Path) -> None:
    events = """
[[events]]
at = "200 ms"
set = { "boat.push" = "2 N", "boat.trim" = "180 deg" }
[[faults]]
what = "fixed"
where = "twin.angle"
value = "90 deg"
at = "500 ms"
for = "200 ms"
"""
    run_trial(load_trial(bench(TRIAL + events)), tmp_path / "run", engine="direct")
    with (tmp_path / "run" / "signals.csv").open(newline="") as file:
        rows = list(csv.reader(file))
    column = {name: i for i, name in enumerate(rows[0])}

    def at(t: float, name: str) -> float:
        row = next(r for r in rows[1:] if float(r[0]) == t)
        return float(row[column[name]])

    pi = 3.141592653589793
    assert at(0.19, "boat.angle") == 1.0
    assert at(0.21, "boat.angle") == pi
    assert [at(t, "twin.angle") for t in (0.49, 0.5, 0.69, 0.7)] == [1.0, pi / 2, pi / 2, 1.0]
    assert at(1.0, "boat.x") == pytest.approx(0.01 * (20 + 80 * 3), abs=0.06)


def test_the_manifest_says_which_connection_feeds_a_parameter(bench, write, tmp_path: Path) -> None:
    text = bench()
    write("rig.toml", RIG + '[connections]\n"boat.angle" = "twin.trim"\n')
    folder = run_trial(load_trial(text), tmp_path / "run", engine="direct").folder
    manifest = json.loads((folder / "manifest.json").read_text())
    trim = {name: manifest["components"][name]["parameters"]["trim"] for name in ("boat", "twin")}
    assert (trim["boat"]["value"], trim["boat"]["from"]) == (1.0, "start value of the FMU")
    assert (trim["twin"]["value"], trim["twin"]["from"]) == (None, "fed by boat.angle")
    assert manifest["connections"] == [["boat.angle", "twin.trim"]]
    page = write_report(folder).read_text("utf-8")
    assert "<td></td>\n  <td>rad</td>\n  <td></td>\n  <td>fed by boat.angle</td>" in page


def test_manifest_and_report_say_what_connections_do_to_values(
    bench, write, tmp_path: Path
) -> None:
    connections = (
        "[connections]",
        '"boat.x" = { to = "twin.push", factor = 2.0, offset = 1.0, convert = false }',
        '"boat.wet" = { to = "twin.dry", mapping = [[true, false], [false, true]] }',
    )
    text = bench()
    write("rig.toml", RIG + "\n".join(connections) + "\n")
    folder = run_trial(load_trial(text), tmp_path / "run", engine="direct").folder
    assert json.loads((folder / "manifest.json").read_text())["connections"] == [
        ["boat.x", "twin.push", 2.0, 1.0],
        ["boat.wet", "twin.dry", 1.0, 0.0, [[True, False], [False, True]]],
    ]
    page = " ".join(write_report(folder).read_text("utf-8").split())
    assert "<code>twin.push</code> times 2, plus 1" in page
    assert "<code>twin.dry</code> by True → False, False → True" in page


def test_what_is_recorded_can_be_chosen(bench, tmp_path: Path) -> None:
    record = '[record]\nsignals = ["boat.*", "twin.label"]\nevery = "50 ms"\n'
    run_trial(load_trial(bench(TRIAL + record)), tmp_path / "run", engine="direct")
    lines = (tmp_path / "run" / "signals.csv").read_text().splitlines()
    assert lines[0] == "time,boat.x,boat.angle,boat.label,boat.wet,twin.label"
    assert len(lines) == 22
    assert lines[2].startswith("0.05,")
    assert lines[2].endswith(',"calm, ""5""",0,"calm, ""5"""')


def test_plots_of_a_trial_come_first_in_its_report(bench, tmp_path: Path) -> None:
    text = PLOT.format('"boat.x", "twin.x"')
    folder = run_trial(load_trial(bench(text)), tmp_path / "run", engine="direct").folder
    page = write_report(folder).read_text("utf-8")
    assert page.index("What the trial shows") < page.index("Other signals of boat")
    figure = figure_below(page, "What the trial shows")
    assert [trace["name"] for trace in figure["data"]][:2] == ["boat.x", "twin.x"]


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ('rig = "nowhere.toml"\nstop = "1 s"', "there is no file"),
        ('rig = "landnig"\nstop = "1 s"', "did you mean 'landing'"),
        ('rig = "rig.toml"', "stop: this key is missing"),
        ('rig = "rig.toml"\nstop = "1.005 s"', "whole number of communication steps"),
        ('rig = "rig.toml"\nstop = "0 s"', "not after the start"),
        (TRIAL + '[record]\nevery = "2 s"', "longer than the trial"),
        (TRIAL.replace("abs(boat.x) < 2 m", "boat.label < 2"), "boat.label is a text"),
        ('rig = "rig.toml"\nstop = "1 m"', "'m' cannot be converted to 's'"),
        ('rig = "rig.toml"\nstop = "1 s"\nseed = -1', "seed"),
        ('rig = "rig.toml"\nstop = "1 s"\ncritera = []', "did you mean 'criteria'"),
        (TRIAL.replace("name", "nmae"), r"criteria\.0.*did you mean 'name'"),
        (TRIAL.replace("2 m", "2 deg"), "stays near"),
        (TRIAL.replace("boat.x", "boat.y"), "unknown signal 'boat.y'"),
        (TRIAL.replace("< 2", "<< 2"), "stays near"),
        (TRIAL + '[set]\n"boat.trmi" = 1', "did you mean 'trim'"),
        (TRIAL + '[set]\n"bote.trim" = 1', "did you mean 'boat'"),
        (TRIAL + '[set]\n"boat.trim" = "3 kg"', "'kg' cannot be converted to 'rad'"),
        (TRIAL + '[set]\n"boat.mode" = 3', "a text is needed"),
        (TRIAL + '[record]\nsignals = ["boot.*"]', "no signal matches 'boot"),
        (TRIAL + '[[events]]\nat = "2 s"\nset = { "boat.push" = "1 N" }', "outside the trial"),
        (TRIAL + '[[events]]\nat = "15 ms"\nset = { "boat.push" = "1 N" }', "whole number"),
        (TRIAL + '[[events]]\nat = "0.5 s"\nset = { "boat.mode" = "storm" }', "is fixed"),
        (TRIAL + '[[events]]\nat = "0.5 s"\noverride = { "boat.push" = "1 N" }', r"\[\[faults\]\]"),
        (TRIAL + '[[events]]\nat = "0.5 s"\nrelease = ["boat.x"]', "key `for` of"),
        (FAULT.format('what = "bios"', "boat.x"), r"faults.0.what: .*did you mean 'bias'"),
        (FAULT.format('what = "bias"', "boat.x"), r"faults.0.value: bias needs it"),
        (FAULT.format('what = "bias"\nvalue = "1 kg"', "boat.x"), "'kg' cannot be converted"),
        (FAULT.format('what = "bias"\nvalue = [1, 2]', "boat.x"), "1 values are needed"),
        (FAULT.format('what = "bias"\nvalue = 1', "boat.label"), "bias is of numbers"),
        (FAULT.format('what = "bias"\nvalue = 1', "boat"), "acts on a port, boat.PORT"),
        (FAULT.format('what = "bias"\nrate = 1', "boat.x"), "faults.0.rate: bias takes value"),
        (FAULT.format('what = "bias"\nvalue = 1', "bote.x"), "did you mean 'boat'"),
        (FAULT.format('what = "off"', "boat"), "a whole boat takes nan, hang, crash, power-loss"),
        (FAULT.format('what = "hang"', "boat.x"), "hang acts on a whole component"),
        (FAULT.format('what = "loss"', "boat.x"), "loss is of streams"),
        (FAULT.format('what = "stuck"', "boat.mode"), "neither an output nor an input"),
        (FAULT.format('what = "stuck"\nfor = "0 s"', "boat.x"), "faults.0.for: '0 s' is no time"),
        (FAULT.format('what = "stuck"\ngrows_over = "1 s"', "boat.x"), "stuck acts at once"),
        (FAULT.format('what = "stuck"\nat = "2 s"', "boat.x"), "outside the trial"),
        (FAULT.format('what = "dropout"\nprobability = 2', "boat.x"), "from 0 to 1, found 2"),
        (FAULT.format('what = "limit"\nlow = 2\nhigh = 1', "boat.x"), "it is above `high`"),
        (FAULT.format('what = "delay"\ntime = "0 s"', "boat.x"), "a time above 0 is needed"),
        (FAULT.format('what = "deviation"\ncoefficients = [1]', "boat.x"), "five of them"),
        (TRIAL + '[[events]]\nat = "0.5 s"\nset = { "boat.push" = "1 rad" }', "'rad' cannot"),
        (PLOT.format('"boat.y"'), "plot 'both': unknown signal 'boat.y'"),
        (PLOT.format('"boat.label"'), "plot 'both': boat.label is a text"),
        (PLOT.format('"boat.x", "boat.angle"'), "of one unit .* boat.x in m, boat.angle in rad"),
        (PLOT.format(""), r"plots\.0\.signals"),
        (
            PLOT.format('"boat.x"') + '[record]\nsignals = ["boat.angle"]',
            "boat.x is not recorded, see record.signals",
        ),
        ("rig = 3", "rig: .*found 3"),
        ("rig = ", "not TOML: .*end of document"),
    ],
)
def test_mistakes_in_a_trial_are_named_and_leave_nothing(
    text: str, message: str, bench, tmp_path: Path
) -> None:
    path = bench(text)
    with pytest.raises(InputError, match=message) as error:
        run_trial(load_trial(path), tmp_path / "run", engine="direct")
    assert "trial.toml" in str(error.value)
    assert not (tmp_path / "run").exists()


def test_criteria_see_every_step_however_seldom_rows_are_recorded(bench, tmp_path: Path) -> None:
    spike = """
[record]
every = "300 ms"
[[faults]]
what = "fixed"
where = "boat.x"
value = "100 m"
at = "400 ms"
for = "20 ms"
"""
    result = run_trial(load_trial(bench(TRIAL + spike)), tmp_path / "run", engine="direct")
    assert not result.passed
    rows = (tmp_path / "run" / "signals.csv").read_text().splitlines()
    assert [row.split(",")[0] for row in rows[1:]] == ["0.0", "0.3", "0.6", "0.9", "1.0"]


def test_a_folder_is_claimed_by_one_run_only(tmp_path: Path) -> None:
    claimed = claim_folder(tmp_path / "run", "trial", "manifest.json")
    with pytest.raises(InputError, match="not an empty folder"):
        claim_folder(claimed, "trial", "manifest.json")


def test_default_folders_never_meet(tmp_path: Path, monkeypatch) -> None:
    monkeypatch.chdir(tmp_path)
    folders = [claim_folder(None, "trial", "manifest.json") for _ in range(3)]
    assert len(set(folders)) == 3


@needs_kits("campaigns")
def test_a_bad_case_of_a_campaign_is_found_before_the_first_runs(
    bench, write, tmp_path: Path
) -> None:
    bench()
    path = write(
        "campaign.toml", 'trials = ["trial.toml"]\n[grid]\n"boat.push" = ["0 N", "5 N", "1 kg"]\n'
    )
    with pytest.raises(InputError, match="'kg' cannot be converted"):
        seatrial.run_campaign(path, out=tmp_path / "out")
    assert not (tmp_path / "out").exists()


def test_a_rig_beside_the_trial_wins_over_a_shipped_one(write, tmp_path: Path) -> None:
    shipped = Path(__file__).parents[2] / "harness"
    for name, text in {
        "rigs/hydrone-open-loop.toml": '"20 ms"', "trials/hydrone-open-landing.toml": "",
    }.items():  # fmt: skip
        content = (shipped / name).read_text()
        write(f"harness/{name}", content.replace('"10 ms"', text) if text else content)
    trial = load_trial(str(tmp_path / "harness" / "trials" / "hydrone-open-landing.toml"))
    assert trial.rig.step_ns == 20_000_000


def test_text_with_a_carriage_return_is_read_back(write, tmp_path: Path) -> None:
    write("boat.py", BOAT.replace("""f'{self.mode}, "{k}"'""", "'a' + chr(13) + 'b'"))
    write("rig.toml", RIG)
    path = write("trial.toml", TRIAL)
    run_trial(load_trial(str(path)), tmp_path / "run", engine="direct")
    assert load_run(tmp_path / "run").signals["boat.label"][0] == "a\rb"


def test_a_folder_with_something_in_it_is_never_written_to(bench, tmp_path: Path) -> None:
    (tmp_path / "run").mkdir()
    (tmp_path / "run" / "precious").write_text("data")
    with pytest.raises(InputError, match="is not an empty folder"):
        run_trial(load_trial(bench()), tmp_path / "run", engine="direct")
    assert [p.name for p in (tmp_path / "run").iterdir()] == ["precious"]


@needs_kits("campaigns")
@pytest.mark.slow
def test_a_design_is_drawn_for_every_combination(bench, write, tmp_path: Path) -> None:
    bench()
    path = write(
        "campaign.toml",
        'trials = ["trial.toml"]\n[grid]\n"boat.mode" = ["calm", "storm"]\n'
        '[design]\nkind = "latin-hypercube"\ncount = 3\n'
        '[design.vary]\n"boat.push" = { uniform = ["0 N", "3 N"] }\n',
    )
    seatrial.run_campaign(path, out=tmp_path / "out")
    index = json.loads((tmp_path / "out" / "campaign.json").read_text())
    settings = [case["set"] for case in index["cases"]]
    assert [each["boat.mode"] for each in settings] == ["calm"] * 3 + ["storm"] * 3
    pushes = [float(each["boat.push"].removesuffix(" N")) for each in settings]
    assert pushes[:3] == pushes[3:]
    assert sorted(map(int, pushes[:3])) == [0, 1, 2]


@needs_kits("campaigns")
def test_a_key_is_drawn_or_in_the_grid(bench, write, tmp_path: Path) -> None:
    bench()
    path = write(
        "campaign.toml",
        'trials = ["trial.toml"]\n[grid]\n"boat.push" = ["0 N"]\n'
        '[design]\nkind = "sobol"\ncount = 2\n'
        '[design.vary]\n"boat.push" = { uniform = ["0 N", "3 N"] }\n',
    )
    with pytest.raises(
        InputError, match=r"campaign.toml: design: vary: boat.push is a key of grid"
    ):
        seatrial.run_campaign(path, out=tmp_path / "out")


@needs_kits("campaigns")
@pytest.mark.slow
def test_a_campaign_runs_every_combination_and_each_scaling(bench, write, tmp_path: Path) -> None:
    bench()
    path = write(
        "campaign.toml",
        'trials = ["trial.toml"]\n[grid]\n"boat.mode" = ["calm", "storm"]\n'
        '"boat.push" = ["0 N", "5 N"]\n[scale]\n"boat.trim" = [0.5, 2.0]\n',
    )
    assert len(seatrial.run_campaign(path, out=tmp_path / "out").cases) == 12
    index = json.loads((tmp_path / "out" / "campaign.json").read_text())
    assert [case["passed"] for case in index["cases"]] == [
        True,
        True,
        True,
        False,
        False,
        False,
    ] * 2
    trims = []
    for case in index["cases"]:
        manifest = json.loads((tmp_path / "out" / case["folder"] / "manifest.json").read_text())
        parameters = manifest["components"]["boat"]["parameters"]
        trims.append((parameters["mode"]["value"], parameters["trim"]["value"]))
    assert (
        trims
        == [("calm", v) for v in (1.0, 0.5, 2.0)] * 2 + [("storm", v) for v in (1.0, 0.5, 2.0)] * 2
    )
