"""Reports: whole, self-contained, and safe with any text."""

from __future__ import annotations

import base64
import json
import re
from html.parser import HTMLParser
from pathlib import Path

import numpy as np
import plotly
import pytest

from seatrial.errors import InputError
from seatrial.trial.reports.plotly_js import plotly_js
from seatrial.trial.reports.plots import MAX_POINTS, Line, Panel, decimate, time_figure
from seatrial.trial.reports.report import points_of_a_line, write_report
from seatrial.trial.reports.templates import packed
from seatrial_kits.campaigns.results.campaign_report import write_campaign_report, write_case_report
from seatrial_kits.live.stage import viewer_js

from .conftest import PADS, unpacked, write_run_folder

VOID = {"meta", "br", "link", "img", "hr", "input"}
REFERENCES = {"src", "href", "action", "data", "poster", "srcset", "formaction", "xlink:href"}
EVIL = '<script>alert("x")</script>'
DURATIONS = {
    "steps": 1, "mean_s": 0.1, "p50_at_most_s": 0.1, "p99_at_most_s": 0.1, "longest_s": 0.1,
    "longest_at_s": 0.0, "bins": [1],
}  # fmt: skip


class Page(HTMLParser):
    """A page taken apart: tags must nest; texts, figures and references are kept."""

    def __init__(self, path):
        super().__init__(convert_charrefs=True)
        self.open, self.references, self.figures, self.tags = [], [], [], []
        self.data = []
        self.text = self.style = ""
        self.feed(path.read_text(encoding="utf-8"))
        self.close()
        assert self.open == []

    def handle_starttag(self, tag, attrs):
        self.tags.append(tag)
        self.references += [value for name, value in attrs if name in REFERENCES]
        assert not any(name.startswith("on") for name, _ in attrs)
        if tag not in VOID:
            self.open.append((tag, dict(attrs).get("type")))

    def handle_endtag(self, tag):
        assert self.open.pop()[0] == tag

    def handle_data(self, data):
        inside = self.open[-1] if self.open else ("", None)
        if inside == ("script", "text/x-figure"):
            self.figures.append(json.loads(unpacked(data)))
        elif inside == ("script", "application/json"):
            self.data.append(json.loads(data))
        elif inside[0] == "style":
            self.style += data
        elif inside[0] != "script":
            self.text += " ".join(data.split()) + " "

    def figure_text(self):
        return json.dumps(self.figures)

    def titles(self):
        notes = [note for f in self.figures for note in f["layout"].get("annotations", [])]
        return [re.sub("<.*?>", "", note["text"]) for note in notes]


def numbers(array):
    """Return the numbers that Plotly's JSON holds as base64 or as a list."""
    if isinstance(array, dict):
        return np.frombuffer(base64.b64decode(array["bdata"]), array["dtype"])
    return np.array(array, dtype=float)


def trace(page, name):
    [found] = [t for f in page.figures for t in f["data"] if t.get("name") == name]
    return found


def assert_self_contained(page):
    assert not [r for r in page.references if re.match(r"[a-z]*:|//", r or "")]
    assert "url(" not in page.style
    assert "@import" not in page.style
    assert not {"link", "iframe", "img", "object", "embed"} & set(page.tags)
    # Two scripts of code: Plotly and what draws the figures.
    assert page.tags.count("script") == 2 + len(page.figures) + len(page.data)


# ---------------------------------------------------------------------- a run


def test_a_report_is_one_page_with_everything(write_run):
    folder = write_run(extra={"downwash.height": ("m", np.ones(201))})
    path = write_report(folder)
    assert path == folder / "report.html"
    page = Page(path)
    assert_self_contained(page)
    for heading in (
        "Hydrone, landing, transversal pad",
        "✗ FAILED",
        "✓ passed",
        "worst 10.9 deg at 20 s, limit 10 deg",
        "downwash.force",
        "Motion of hull",
        "Velocities of hull",
        "Track from above",
        "The deck from above",
        "Forces and moments",
        "Other signals of downwash",
        "[Timm2026], table 5",
        "stated",
        "1.1, 17.59, 17.59",
        "real_time_factor",
    ):
        assert heading in page.text
    manifest = json.loads((folder / "manifest.json").read_text())
    titles = " ".join(page.titles())
    for signal in manifest["signals"]:
        assert signal in page.text
        assert signal in titles or signal.rpartition(".")[0] in titles


def test_velocities_stand_in_three_columns_and_rotors_are_no_motion(write_run):
    more = {f"hull.{name}.{axis}": ("m/s", np.ones(201)) for name in "abcd" for axis in "xyz"}
    rotors = {f"hull.rotor_speed.r{i}": ("rad/s", np.ones(201)) for i in range(1, 5)}
    page = Page(write_report(write_run(extra=more | rotors)))
    titles = [[a["text"] for a in f["layout"].get("annotations", [])] for f in page.figures]
    [velocities] = [i for i, shown in enumerate(titles) if any("hull.d.z" in t for t in shown)]
    assert all(any(signal in t for t in titles[velocities]) for signal in more)
    layout = page.figures[velocities]["layout"]
    columns = {tuple(axis["domain"]) for name, axis in layout.items() if name.startswith("xaxis")}
    assert len(columns) == 3
    [rest] = [i for i, shown in enumerate(titles) if any("hull.rotor_speed" in t for t in shown)]
    assert rest > velocities


def test_angles_are_in_degrees_with_their_limits(write_run):
    page = Page(write_report(write_run()))
    roll = numbers(trace(page, "phi")["y"])
    assert roll[-1] == pytest.approx(10.865027, abs=1e-5)
    limits = [
        trace["y"][0]
        for figure in page.figures
        for trace in figure["data"]
        if trace.get("name") == "limit of roll stays below 10 degrees"
    ]
    assert limits == pytest.approx([10.0, -10.0])
    assert "hull.attitude.phi, deg" in page.titles()
    assert "hull.rates.p, deg/s" in page.titles()
    assert "start_attitude .psi 30 deg" in " ".join(page.text.split())


@pytest.mark.parametrize(
    ("scenario", "verdict"), [("nominal", "passed"), ("transversal", "FAILED")]
)
def test_the_pad_is_marked_by_its_verdict(write_run, scenario, verdict):
    page = Page(write_report(write_run(scenario=scenario)))
    pad = trace(page, "downwash")
    assert (pad["x"], pad["y"]) == ([PADS[scenario][1]], [PADS[scenario][0]])
    assert pad["text"] == [verdict]


def test_a_rig_without_a_craft(write_run):
    components = {"tank": {"fmu": "tank", "sha256": "4" * 64, "step": 0.01, "parameters": {}}}
    signals = {name: {"unit": "1", "description": ""} for name in ("tank.level", "tank.log")}
    folder = write_run(
        changes={"components": components, "connections": [], "signals": signals, "criteria": []}
    )
    (folder / "signals.csv").write_text("time,tank.level,tank.log\n0.0,1.0,idle\n0.1,2.0,full\n")
    (folder / "verdicts.json").write_text("[]")
    page = Page(write_report(folder))
    assert_self_contained(page)
    assert "Other signals of tank" in page.text
    assert "The trial has no criteria" in page.text
    assert "NO CRITERIA" in page.text
    assert "idle" in page.text
    assert "full" in page.text
    assert page.titles() == ["tank.level"]
    assert "deck" not in page.text


@pytest.mark.slow
def test_a_model_with_thousands_of_signals_and_parameters_has_a_page_that_opens(write_run):
    parameters = {
        f"gain[{k}]": {"value": 1.0, "unit": "1", "from": "", "source": "", "mark": ""}
        for k in range(3000)
    }
    plant = {"fmu": "plant", "sha256": "4" * 64, "step": 0.01, "parameters": parameters}
    names = [f"plant.x[{k}]" for k in range(3000)] + [f"plant.pipe.f[{k}]" for k in range(2000)]
    signals = {name: {"unit": "N", "description": ""} for name in names}
    folder = write_run(
        changes={
            "components": {"plant": plant},
            "connections": [],
            "signals": signals,
            "criteria": [],
        }
    )
    row = ",".join(map(str, range(len(names))))
    (folder / "signals.csv").write_text(f"time,{','.join(names)}\n0.0,{row}\n0.1,{row}\n")
    (folder / "verdicts.json").write_text("[]")
    page = Page(write_report(folder))
    assert_self_contained(page)
    drawn = sum(len(figure["data"]) for figure in page.figures)
    assert drawn == 2 * 500
    assert "and 4000 more signals, see signals.csv" in page.text
    assert "and 2500 more, see manifest.json" in page.text


def test_ships_in_the_plane_show_no_heave(write_run):
    ship = {"fmu": "ship", "sha256": "4" * 64, "step": 0.01, "parameters": {}}
    names = [f"{one}.position.{axis}" for one in ("port", "twin") for axis in "xyz"]
    signals = {name: {"unit": "m", "description": ""} for name in names}
    folder = write_run(
        changes={
            "components": {"port": ship, "twin": ship},
            "connections": [],
            "signals": signals,
            "criteria": [],
        }
    )
    rows = ["time," + ",".join(names), "0,0,0,0,0,0,0", "0.1,1,0,0,1,2,0"]
    (folder / "signals.csv").write_text("\n".join(rows) + "\n")
    (folder / "verdicts.json").write_text("[]")
    titles = Page(write_report(folder)).titles()
    assert [t.partition(",")[0] for t in titles if t.startswith("position.")] == [
        "position.x",
        "position.y",
    ]
    (folder / "signals.csv").write_text(f"{rows[0]}\n{rows[1]}\n")
    titles = Page(write_report(folder)).titles()
    assert sum(t.startswith("position.") for t in titles) == 3


def test_headings_that_go_round_are_drawn_in_one_piece(write_run):
    ship = {"fmu": "ship", "sha256": "4" * 64, "step": 0.01, "parameters": {}}
    names = ["ship.attitude.phi", "ship.attitude.psi", "ship.other"]
    signals = {name: {"unit": "rad", "description": ""} for name in names}
    folder = write_run(
        changes={
            "components": {"ship": ship},
            "connections": [],
            "signals": signals,
            "criteria": [],
        }
    )
    rows = ["time," + ",".join(names), "0,0.1,3.1,3.1", "0.1,-0.1,-3.1,nan", "0.2,0,3.0,-3.1"]
    (folder / "signals.csv").write_text("\n".join(rows) + "\n")
    (folder / "verdicts.json").write_text("[]")
    page = Page(write_report(folder))
    assert "ship.attitude.psi (turns counted), deg" in page.titles()
    assert "ship.attitude.phi, deg" in page.titles()
    assert "ship.other, deg" in page.titles()
    psi = np.radians(numbers(trace(page, "psi")["y"]))
    assert psi == pytest.approx([3.1, 2 * np.pi - 3.1, 3.0])


def test_nothing_written_by_others_becomes_markup(write_run):
    name = f"box{EVIL}"
    folder = write_run(
        extra={
            f"{name}.x": ("m", np.ones(201)),
            f"{name}.note": (EVIL, [EVIL] * 201),
            f"{name}.force.x": ("N", np.ones(201)),
            f"{name}.force.y": ("N", np.ones(201)),
        },
        changes={
            "trial": {"name": EVIL, "title": EVIL, "file": EVIL, "sha256": EVIL},
            "error": EVIL,
            "status": "failed",
            "events": [{"at": EVIL, "set": {EVIL: EVIL}}, EVIL],
            **dict.fromkeys(("engine", "algorithm", "variant", "seed"), EVIL),
            "choices": {EVIL: EVIL},
            "plots": [{"title": EVIL, "signals": [f"{name}.x"]}],
            "connections": [[EVIL, f"{name}.u"]],
            "components": {
                name: {
                    "fmu": EVIL,
                    "sha256": EVIL,
                    "step": 0.01,
                    "parameters": {
                        EVIL: {
                            "value": EVIL,
                            "unit": EVIL,
                            "from": EVIL,
                            "source": EVIL,
                            "mark": EVIL,
                        }
                    },
                }
            },
        },
    )
    verdict = {"name": EVIL, "check": EVIL, "passed": False, "detail": EVIL, "unit": EVIL}
    verdicts = [{**verdict, "worst": 1.0, "time": 0.0, "limits": [[f"{name}.x", 1.0, EVIL]]}]
    (folder / "verdicts.json").write_text(json.dumps(verdicts))
    timing = {"wall_s": {EVIL: EVIL}, EVIL: EVIL, "step_times": {EVIL: DURATIONS}}
    (folder / "timing.json").write_text(json.dumps(timing))
    path = write_report(folder)
    page = Page(path)
    assert_self_contained(page)
    assert page.text.count(EVIL) > 15
    assert "<script" not in page.figure_text()
    assert "&lt;script&gt;" in page.figure_text()


@pytest.mark.parametrize("status", ["failed", "running"])
def test_a_run_that_did_not_end_well(write_run, status):
    folder = write_run(changes={"status": status, "error": "hull: output z is nan at t = 3.1 s"})
    for name in ("verdicts.json", "timing.json"):
        (folder / name).unlink()
    path = folder / "signals.csv"
    path.write_bytes(path.read_bytes()[:-7])
    page = Page(write_report(folder))
    assert "✗ FAILED" in page.text
    assert "output z is nan" in page.text
    assert "verdicts.json is missing" in page.text
    assert "the last line of signals.csv is cut" in page.text
    assert "The run was not evaluated" in page.text


def test_an_empty_record(write_run):
    folder = write_run()
    path = folder / "signals.csv"
    path.write_text(path.read_text().splitlines()[0] + "\n")
    assert "nothing recorded" in Page(write_report(folder)).text


def test_a_run_without_a_record(write_run):
    folder = write_run(changes={"status": "failed", "error": "hull: no start"})
    (folder / "signals.csv").unlink()
    assert "hull: no start" in Page(write_report(folder)).text


def test_events_are_listed_and_drawn(write_run):
    events = [{"at": "12 s", "set": {"hull.current": [1, 0, 0]}, "override": {}, "release": []}]
    page = Page(write_report(write_run(changes={"events": events})))
    assert "1 12 s hull.current = [1, 0, 0]" in " ".join(page.text.split())
    layouts = [figure["layout"] for figure in page.figures if "shapes" in figure["layout"]]
    assert any(shape["x0"] == 12 for layout in layouts for shape in layout["shapes"])
    flags = [flag for layout in layouts for flag in layout["annotations"] if flag["text"] == "1"]
    assert flags
    assert {(flag["x"], flag["hovertext"]) for flag in flags} == {
        (12, "1: hull.current = [1, 0, 0]")
    }


def test_a_fault_is_shaded_as_long_as_it_lasts(write_run):
    faults = [
        {"what": "off", "where": "hull", "at": "12 s", "for": "500 ms"},
        {"what": "off", "where": "hull", "at": "13 s", "for": None},
    ]
    page = Page(write_report(write_run(changes={"faults": faults})))
    assert "1 12 s 500 ms what = off, where = hull" in " ".join(page.text.split())
    shades = [
        (shape["x0"], shape["x1"])
        for figure in page.figures
        for shape in figure["layout"].get("shapes", [])
        if shape["type"] == "rect" and "yref" in shape and "domain" in shape["yref"]
    ]
    assert set(shades) == {(12, 12.5)}


def test_same_run_same_page(write_run):
    one, other = write_report(write_run("a")), write_report(write_run("b"))
    assert one.read_bytes() == other.read_bytes()


def test_not_a_run(tmp_path):
    with pytest.raises(InputError, match="not a run folder"):
        write_report(tmp_path)


# ---------------------------------------------------------------------- long records


def test_decimation_keeps_every_extreme():
    time = np.arange(1_000_000) * 0.01
    values = np.sin(time)
    values[654_321], values[123_456] = 9.0, -9.0
    values[500_000] = np.nan
    short_time, short = decimate(time, values)
    assert len(short) <= MAX_POINTS
    assert (np.nanmax(short), np.nanmin(short)) == (9.0, -9.0)
    assert (short_time[0], short_time[-1]) == (time[0], time[-1])
    assert (np.diff(short_time) > 0).all()


def test_short_records_are_drawn_whole():
    time = np.arange(MAX_POINTS, dtype=float)
    assert decimate(time, time)[0] is time


def test_a_gap_stays_a_gap():
    values = np.full(10 * MAX_POINTS, np.nan)
    assert np.isnan(decimate(np.arange(len(values), dtype=float), values)[1]).all()


def test_columns_of_different_length():
    time = np.arange(3.0)
    panel = Panel("a.b", "m", [Line("a.b", time)])
    figure = time_figure(time, [[panel, panel], [panel]])
    assert len(figure.data) == 3


# ---------------------------------------------------------------------- a campaign


@pytest.fixture
def campaign(tmp_path):
    cases = []
    for phase in ("landing", "takeoff"):
        for scenario in PADS:
            folder = tmp_path / f"{phase}-{scenario}"
            write_run_folder(folder, phase, scenario)
            verdicts = json.loads((folder / "verdicts.json").read_text())
            cases.append(
                {
                    "name": f"{phase}, pad {scenario}",
                    "folder": folder.name,
                    "set": {"downwash.pad": scenario},
                    "passed": all(verdict["passed"] for verdict in verdicts),
                    "verdicts": verdicts,
                    "status": "complete",
                }
            )
    write_campaign(tmp_path, cases)
    return tmp_path, cases


def write_campaign(folder, cases, name="pads"):
    (folder / "campaign.json").write_text(json.dumps({"name": name, "cases": cases}))


def test_a_campaign_has_every_case_and_pad(campaign):
    folder, cases = campaign
    write_report(folder / cases[0]["folder"])
    page = Page(write_campaign_report(folder))
    assert_self_contained(page)
    assert page.references == ["landing-nominal/report.html", "plotly.js"]
    for case in cases:
        assert case["name"] in page.text
        assert case["set"]["downwash.pad"] in page.text
    for text in ("8 cases", "✓ 3 passed", "✗ 5 failed", "✗ 14.3 deg", "✓ 2.15 s"):
        assert text in page.text
    [deck] = page.figures
    pads = {(t["xaxis"], t["x"][0], t["y"][0]): t["text"][0] for t in deck["data"] if "text" in t}
    assert len(pads) == 8
    assert pads["x", 0.0, 0.319] == "passed"
    assert pads["x2", 0.0, 0.319] == "FAILED"
    assert {"landing", "takeoff"} <= set(page.titles())
    first = cases[0]["name"]  # the one with a report: its point leads there
    assert page.data == [{"links": {first: "landing-nominal/report.html"}, "rerun": ""}]
    led_to = [t["meta"]["cases"][0] for t in deck["data"] if "text" in t]
    assert sorted(led_to) == sorted(case["name"] for case in cases)


def test_cases_at_one_pad_are_counted(campaign):
    folder, cases = campaign
    again = {**cases[0], "name": "heavier", "passed": False, "set": {"hull.mass times": 1.2}}
    write_campaign(folder, [*cases, again])
    page = Page(write_campaign_report(folder))
    marks = [t["text"][0] for t in page.figures[0]["data"] if "text" in t]
    assert "1 of 2 passed" in marks
    assert "hull.mass times" in page.text


def test_a_case_without_a_run(campaign):
    folder, cases = campaign
    lost = {**cases[0], "folder": "lost", "passed": False, "verdicts": [], "status": "failed"}
    write_campaign(folder, [lost])
    page = Page(write_campaign_report(folder))
    assert "no readable run in lost" in page.text
    assert "run failed" in page.text
    assert page.figures == []


def test_names_in_a_campaign_are_escaped(campaign):
    folder, cases = campaign
    evil = {**cases[0], "name": EVIL, "set": {EVIL: EVIL}, "status": EVIL}
    write_campaign(folder, [evil], name=EVIL)
    page = Page(write_campaign_report(folder))
    assert_self_contained(page)
    assert page.text.count(EVIL) >= 4


def test_not_a_campaign(tmp_path):
    with pytest.raises(InputError, match="not a campaign folder"):
        write_campaign_report(tmp_path)
    (tmp_path / "campaign.json").write_text('{"name": "x"}')
    with pytest.raises(InputError, match="cases: this key is missing"):
        write_campaign_report(tmp_path)


# ---------------------------------------------------------------------- size and order


def test_a_long_run_with_many_signals_stays_small():
    time, count = np.linspace(0.0, 600.0, 60_001), 90
    noise = np.random.default_rng(1).standard_normal((count, len(time)))
    panels = [Panel(f"thrust {i}", "N", [Line("thrust", noise[i])]) for i in range(count)]
    figure = time_figure(time, [panels], most_points=points_of_a_line(count))
    page = packed(figure.json()) + plotly_js() + viewer_js()
    assert len(page) < 3.2e6  # 0.2 MB for a recording and the tables


def test_plots_come_before_the_tables_of_connections(write_run):
    text = Page(write_report(write_run())).text
    order = ["Verdicts", "Motion of hull", "Parameters", "What was simulated"]
    assert sorted(order, key=text.index) == order


def test_the_page_carries_the_library_whole(write_run):
    page = write_report(write_run()).read_text(encoding="utf-8")
    carried = re.search(r'<script>window.packedPlotly = "(.*?)";</script>', page)[1]
    library = Path(plotly.__file__).with_name("package_data") / "plotly.min.js"
    assert unpacked(carried) == library.read_bytes()


def test_pages_of_a_campaign_share_the_library(campaign):
    folder, cases = campaign
    pages = [write_case_report(folder / cases[0]["folder"]), write_campaign_report(folder)]
    library = (folder / "plotly.js").read_text("ascii")
    assert library == f'window.packedPlotly = "{plotly_js()}";\n'
    for page in pages:
        assert page.stat().st_size < 0.5e6
        (address,) = re.findall(r'<script src="([^"]*)"', page.read_text("utf-8"))
        assert (page.parent / address).resolve() == (folder / "plotly.js").resolve()


def test_a_deck_of_unknown_size_shows_its_points_alone(write_run) -> None:
    """Views are the component's, the outline is of its vehicle's file."""
    known, unknown = write_run(), write_run(name="other")
    path = unknown / "manifest.json"
    manifest = json.loads(path.read_text("utf-8"))
    del manifest["components"]["downwash"]["outline"]
    manifest["components"]["downwash"]["fmu"] = "somebody_elses.fmu"
    path.write_text(json.dumps(manifest))
    decks = [Page(write_report(folder)).figures[0]["layout"] for folder in (known, unknown)]
    assert [len(deck.get("shapes", [])) for deck in decks] == [1, 0]
    assert decks[0]["shapes"][0]["y1"] == pytest.approx(0.638)
