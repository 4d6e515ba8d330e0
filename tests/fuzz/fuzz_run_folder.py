"""Folders of runs and campaigns that somebody else made: reports, comparison, records, Python."""

from __future__ import annotations

import contextlib
import json
import shutil
import tempfile
from functools import cache
from pathlib import Path

from seatrial.api.results import load_result
from seatrial.errors import InputError
from seatrial.trial.records.compare import compare
from seatrial.trial.reports.report import write_report
from seatrial_kits.campaigns.api import CampaignResult
from seatrial_kits.campaigns.results.campaign_report import write_campaign_report

from ..trials.conftest import write_run_folder
from .documents import changed

FILES = ("manifest.json", "verdicts.json", "timing.json", "convergence.json", "campaign.json")
_PARAMETER = {"unit": "m", "from": "", "source": "", "mark": ""}
_VIEWS = {
    "landing-point": {"place": "pad", "phase": "phase"},
    "waypoints": {"count": "count", "place": "place"},
    "wind": {"velocity": "velocity"},
    "line": {"north": "velocity", "east": "velocity", "down": "velocity"},
}
_DURATIONS = {
    "steps": 2, "total_s": 0.1, "mean_s": 0.05, "p50_at_most_s": 0.05, "p99_at_most_s": 0.05,
    "longest_s": 0.06, "longest_at_s": 1.0, "bins": [0, 0, 2],
}  # fmt: skip
_OUTPUT = {
    "signal": "hull.position.x", "unit": "m", "behaviour": "converges", "range": 1.0,
    "differences": [0.1, 0.05], "orders": [1.0], "errors": [0.2, 0.1, 0.05],
}  # fmt: skip


@cache
def _template() -> Path:
    """Return a folder of a campaign with one run that has everything a report draws."""
    folder = Path(tempfile.mkdtemp(prefix="fuzz-"))
    run = write_run_folder(folder / "case")
    lines = (run / "signals.csv").read_text().splitlines()[:4]
    wind = ["air.velocity.north,air.velocity.east", "1,2", "1,2", "1,2"]
    rows = [f"{line},{more}\n" for line, more in zip(lines, wind, strict=True)]
    (run / "signals.csv").write_text("".join(rows))
    manifest = json.loads((run / "manifest.json").read_text())
    values = {"count": 1, "place_1.north": 1.0, "place_1.east": 2.0, "pad.x": 0.1, "pad.y": 0.2}
    manifest["components"]["air"] = {
        "fmu": "air",
        "sha256": "4" * 64,
        "step": 0.01,
        "parameters": {name: {"value": v, **_PARAMETER} for name, v in values.items()},
        "views": _VIEWS,
        "outline": {"length": 1.0, "beam": 0.5},
    }
    for axis in ("north", "east"):
        manifest["signals"][f"air.velocity.{axis}"] = {
            "unit": "m/s", "type": "Real", "description": "",
        }  # fmt: skip
    manifest["plots"] = [{"title": "x", "signals": ["hull.position.x"]}]
    manifest["events"] = [{"at": "12 s", "set": {"hull.current": [1, 0, 0]}}]
    convergence = {
        "trial": "t", "steps": [0.01, 0.005, 0.0025], "folders": [".", "a", "b"],
        "outputs": [_OUTPUT, {**_OUTPUT, "behaviour": "not converging", "errors": []}],
        "discrete": [{"signal": "hull.n", "differs_at": [0.1, None]}],
        "components": ["hull"],
    }  # fmt: skip
    verdicts = json.loads((run / "verdicts.json").read_text())
    case = {
        "name": "case", "folder": "case", "trial": "t", "set": {"hull.mass": 1.0}, "passed": True,
        "status": "complete", "verdicts": verdicts,
    }  # fmt: skip
    pacing = dict.fromkeys(("overruns", "slack", "wake_ups"), _DURATIONS)
    timing = {"wall_s": {"run": 1.0}, "step_times": {"hull": _DURATIONS}, "pacing": pacing}
    written = {
        "case/manifest.json": manifest,
        "case/timing.json": timing,
        "case/convergence.json": convergence,
        "campaign.json": {"name": "c", "title": "", "cases": [case, {**case, "name": "other"}]},
    }
    for name, content in written.items():
        (folder / name).write_text(json.dumps(content))
    return folder


def one(data: bytes) -> None:
    """Change a file of a folder, or write it anew, and let everything read the folder."""
    which, data = (data[0], data[1:]) if data else (0, b"")
    with tempfile.TemporaryDirectory() as temporary:
        folder = Path(temporary, "campaign")
        shutil.copytree(_template(), folder)
        run = folder / "case"
        name = (*FILES, "signals.csv")[which % 6]
        file = folder / name if name == "campaign.json" else run / name
        if which >= 192:
            file.write_bytes(data)
        elif name == "signals.csv":
            content = bytearray(file.read_bytes())
            for place, byte in zip(data[::3], data[1::3], strict=False):
                content[(place * 7) % len(content)] = byte
            file.write_bytes(content)
        else:
            file.write_text(json.dumps(changed(json.loads(file.read_text()), data)))
        for read in (_report, _compare, _python, _campaign):
            with contextlib.suppress(InputError):
                read(folder, run)


def _report(_folder: Path, run: Path) -> None:
    write_report(run)


def _compare(_folder: Path, run: Path) -> None:
    found = compare(run, _template() / "case")
    assert found.table()
    assert found.summary


def _python(_folder: Path, run: Path) -> None:
    result = load_result(run)
    assert repr(result)
    assert result.passed in (True, False)
    for name in result.signals:
        assert result.signals[name] is not None


def _campaign(folder: Path, _run: Path) -> None:
    assert repr(CampaignResult(folder))
    write_campaign_report(folder)
