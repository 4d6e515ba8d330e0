"""Pages as a person meets them: in a real browser."""

from __future__ import annotations

import json
import re
import shutil
import socket
import time
import tomllib
from collections.abc import Iterator
from pathlib import Path
from typing import Any
from urllib.parse import urlsplit

import pytest

from seatrial.trial.records.run_folder import load_run
from seatrial.trial.reports.figure import DARK
from seatrial.trial.reports.report import write_report
from seatrial_kits.live.stage import played

from .browser import WAIT_MS, chromium, opened, other_site, served

pytestmark = pytest.mark.interop

LANDING = ("run", "hydrone-landing", "--engine", "direct", "--live", "--no-report", "--out", "run")
HOSTILE = '<img src=x onerror="window.hacked=1"><script>window.hacked=1</script>'


@pytest.fixture(scope="module")
def browser() -> Iterator[Any]:
    with chromium() as found:
        yield found


def _time(page: Any) -> float:
    return float(page.locator(".state").first.get_attribute("data-time"))


def _later(page: Any, than: float, within: float = 60.0) -> float:
    """Return the run's time once it is later than another."""
    until = time.monotonic() + within
    while (now := _time(page)) <= than:
        assert time.monotonic() < until, f"still {now} s"
        page.wait_for_timeout(100)
    return now


def _choose(page: Any, label: str, value: str) -> None:
    """Choose from a menu that is searched by typing."""
    menu = page.get_by_label(label, exact=True).first
    menu.click()
    menu.fill(value)
    page.get_by_role("option", name=value, exact=True).first.click()


def test_a_record_is_played_back(browser, hydrone: Path, tmp_path: Path) -> None:
    with served(tmp_path, "play", str(hydrone)) as command:
        page = opened(browser, command.address)
        page.get_by_text("A drone lands off centre").wait_for()
        page.get_by_role("button", name="Play").wait_for()  # it has come to the end of the record
        sight = {"x": 0, "y": 200, "width": 480, "height": 400}  # left of the panel
        before = page.screenshot(clip=sight)
        page.get_by_text("to start").click()
        page.get_by_text("north -0.0 m").or_(page.get_by_text("north 0.0 m")).first.wait_for()
        page.wait_for_timeout(1500)
        assert page.screenshot(clip=sight) != before  # the drone is up again
        assert page.locator("svg.map polyline").count() >= 1
        assert page.locator("[data-verdict]").count() == 5
        assert not page.problems
        page.close()
    assert command.process.returncode == 0


@pytest.mark.long
def test_the_token_leaves_the_address_and_other_sites_stay_out(browser, hydrone, tmp_path) -> None:
    with served(tmp_path, "play", str(hydrone)) as command, other_site() as other:
        context = browser.new_context()
        page = context.new_page()
        page.set_default_timeout(WAIT_MS)
        page.goto(command.address)
        page.locator("canvas").first.wait_for()
        bare = f"http://127.0.0.1:{urlsplit(command.address).port}/"
        assert page.url == bare
        assert page.evaluate("document.cookie") == ""  # no script sees it
        page.reload()
        page.locator("canvas").first.wait_for()
        assert page.url == bare
        stranger = context.new_page()  # same cookies
        stranger.goto(other)
        answer = stranger.evaluate(
            """(url) => new Promise((done) => {
                const socket = new WebSocket(url);
                socket.onopen = () => done("open");
                socket.onerror = () => done("refused");
            })""",
            bare.replace("http:", "ws:"),
        )
        assert answer == "refused"
        context.close()
        command.end()
        assert [line for line in command.lines if "page: refused 1 requests" in line]
        command.lines.clear()
    assert command.process.returncode == 0


def test_time_stands_still_and_goes_on_and_a_second_viewer_only_looks(browser, tmp_path) -> None:
    with served(tmp_path, *LANDING, "--set", "stop=600 s") as command:
        first = opened(browser, command.address)
        _later(first, 0.0)
        first.get_by_role("button", name="Pause").click()
        first.get_by_role("button", name="Go on").wait_for()
        first.wait_for_timeout(1500)
        stands = _time(first)
        first.wait_for_timeout(1500)
        assert _time(first) == stands
        first.get_by_role("button", name="Single step").click()
        assert _later(first, stands) == pytest.approx(stands + 0.01)

        second = opened(browser, command.address)
        second.get_by_text("2 viewers, viewer 0 has the helm").wait_for()
        second.get_by_role("button", name="Go on").click()
        second.get_by_text("viewer 0 has the helm").last.wait_for()
        second.wait_for_timeout(1000)
        assert _time(first) == pytest.approx(stands + 0.01)
        first.get_by_role("button", name="Let go of the helm").click()
        first.get_by_text("nobody has the helm").wait_for()
        second.get_by_role("button", name="Go on").click()
        _later(second, stands + 0.5)
        assert not first.problems + second.problems
        first.close()
        second.close()


def test_hands_change_what_happens_and_are_kept_as_a_trial(browser, tmp_path: Path) -> None:
    with served(tmp_path, *LANDING, "--set", "stop=600 s") as command:
        page = opened(browser, command.address)
        _later(page, 0.0)
        _choose(page, "times real time", "10")
        key = "autopilot.keeper.station.north"
        _choose(page, "port", key)
        field = page.get_by_label(f"{key}, m", exact=True)
        field.fill("5")
        field.press("Enter")
        page.get_by_text("Faults", exact=True).click()
        _choose(page, "what", "bias")
        _choose(page, "where", "vehicle.compass.heading")
        written = page.get_by_text("settings", exact=True).locator("xpath=following::input[1]")
        written.fill("value = 20 deg")
        written.press("Enter")
        page.get_by_role("button", name="Inject").click()
        page.get_by_role("button", name="End: bias on vehicle.compass.heading").wait_for()
        changed = _later(page, _time(page) + 30.0)
        assert not page.problems
        page.close()
        command.end()
    run = load_run(tmp_path / "run")
    assert run.manifest["status"] == "stopped"
    assert run.time[-1] >= changed
    assert run.signals["vehicle.hull.position.x"][-1] > 2.0  # it goes to its new station
    assert run.signals["vehicle.hull.attitude.psi"][-1] < -0.1  # as a compass 20 deg off makes it
    made = tomllib.loads((tmp_path / "run" / "by-hand.toml").read_text("utf-8"))
    assert made["events"][0]["set"] == {key: "5.0 m"}
    assert made["faults"][0]["where"] == "vehicle.compass.heading"


def test_the_server_ends_with_the_run(browser, tmp_path: Path) -> None:
    with served(tmp_path, *LANDING, "--set", "stop=2 s") as command:
        page = opened(browser, command.address)
        command.process.wait(60)
        port = urlsplit(command.address).port
        with socket.socket() as end, pytest.raises(ConnectionRefusedError):
            end.connect(("127.0.0.1", port))
        page.close()


def test_a_restart_takes_another_seed_at_the_same_address(browser, tmp_path: Path) -> None:
    with served(tmp_path, *LANDING, "--set", "stop=600 s") as command:
        page = opened(browser, command.address)
        before = _later(page, 3.0)
        page.get_by_text("Begin anew", exact=True).click()
        page.get_by_label("seed", exact=True).fill("7")
        page.get_by_label("seed", exact=True).press("Enter")
        page.get_by_role("button", name="Restart").click()
        until = time.monotonic() + 60.0
        while _time(page) >= before:
            assert time.monotonic() < until
            page.wait_for_timeout(200)
        _later(page, 0.5)
        page.close()
    seeds = [load_run(tmp_path / name).manifest["seed"] for name in ("run", "run-2")]
    assert seeds == [1, 7]


def test_hostile_names_are_text(browser, hydrone: Path, tmp_path: Path) -> None:
    run = shutil.copytree(hydrone, tmp_path / "run")
    text = (run / "manifest.json").read_text("utf-8")
    manifest = json.loads(text)
    manifest["trial"] |= {"title": f"title {HOSTILE}", "name": f"name {HOSTILE}"}
    manifest["criteria"][0]["name"] = f"criterion {HOSTILE}"
    manifest["events"] = [{"at": "1 s", "set": {f"x.{HOSTILE}": f"{HOSTILE}"}}]
    manifest["signals"][f"vehicle.hull.{HOSTILE}"] = {
        "unit": HOSTILE, "type": "Real", "description": HOSTILE,
    }  # fmt: skip
    (run / "manifest.json").write_text(json.dumps(manifest), "utf-8")
    with served(tmp_path, "play", "run") as command:
        page = opened(browser, command.address)
        page.get_by_text("title <img src=x").wait_for()
        page.get_by_text("criterion <img src=x").wait_for()
        _choose(page, "signal", f"vehicle.hull.{HOSTILE}")
        page.get_by_text("Events", exact=True).click()
        page.get_by_text(re.compile("x.<img")).first.wait_for()
        page.wait_for_timeout(1000)
        assert page.evaluate("window.hacked") is None
        page.close()


def test_a_pilot_is_steered_by_hand(browser, tmp_path: Path) -> None:
    """Its mode is manual as long as the box is set."""
    course = ("run", "hydrone-course-square", *LANDING[2:], "--set", "stop=600 s")
    with served(tmp_path, *course) as command:
        page = opened(browser, command.address)
        _later(page, 0.0)
        page.get_by_text("Steer autopilot.pilot.guidance", exact=True).click()
        page.get_by_label("by hand").check()
        page.mouse.click(60, 400)  # the scene has the focus
        for _ in range(12):  # five are full ahead: a busy machine may merge some
            page.keyboard.press("w")
            page.wait_for_timeout(300)
        _later(page, _time(page) + 4.0)
        below = "xpath=following::*[@role='slider'][1]"
        thumb = page.get_by_text("surge", exact=True).locator(below).bounding_box()
        middle = thumb["x"] + thumb["width"] / 2, thumb["y"] + thumb["height"] / 2
        page.mouse.move(*middle)
        page.mouse.down()
        page.mouse.move(middle[0] - 400, middle[1], steps=8)  # over its end: full astern
        page.mouse.up()
        _later(page, _time(page) + 8.0)
        page.get_by_label("by hand").uncheck()
        _later(page, _time(page) + 0.5)
        assert not page.problems
        page.close()
        command.end()
    made = tomllib.loads((tmp_path / "run" / "by-hand.toml").read_text("utf-8"))
    events = [row["set"] for row in made["events"]]
    modes = [row[key] for row in events for key in row if key.endswith("guidance.mode")]
    assert modes == ["manual", "auto"]
    surge = [row[key][0] for row in events for key in row if key.endswith("guidance.manual")]
    assert max(surge) == pytest.approx(1.0)
    assert surge[-1] == 0.0
    run = load_run(tmp_path / "run")
    direct = run.signals["autopilot.pilot.guidance.direct.surge"]
    assert (direct.min(), direct.max()) == pytest.approx((-1.0, 1.0))
    ahead = run.signals["vehicle.hull.velocity.u"]
    assert ahead[direct == 1.0].max() > 0.1
    assert ahead[direct == -1.0].min() < -0.1
    assert direct[-1] == 0.0


def test_a_report_plays_its_run_offline(browser, hydrone: Path, tmp_path: Path) -> None:
    """From the file alone: no network, no other file."""
    report = shutil.copy(write_report(hydrone, play=played), tmp_path / "report.html")
    context = browser.new_context(offline=True, color_scheme="dark")
    page = context.new_page()
    problems: list[str] = []
    page.on("pageerror", lambda error: problems.append(str(error)))
    page.goto(Path(report).as_uri())
    page.locator(".figure .main-svg").first.wait_for(timeout=WAIT_MS)
    colour = "document.querySelector('.figure').layout.font.color"
    assert page.evaluate(colour) == DARK["#1d2730"]
    assert page.locator("svg.rig .box").count() == 9
    page.get_by_role("button", name="Play the run").click()
    inside = page.frame_locator(".stage iframe")
    inside.locator("canvas").first.wait_for(timeout=WAIT_MS)
    page.wait_for_timeout(2000)
    place = page.locator(".stage iframe").bounding_box()
    before = page.screenshot(clip=place)
    page.wait_for_timeout(1500)
    assert page.screenshot(clip=place) != before
    page.evaluate("dispatchEvent(new Event('beforeprint'))")  # paper is white
    assert page.evaluate(colour) == "#1d2730"
    assert not problems
    context.close()
