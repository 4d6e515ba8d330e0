"""The pytest plugin: fixtures, the mark ``trial``, and TOML trials as tests.

Nothing else of this package is imported before a test needs it.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from pathlib import Path
from typing import TYPE_CHECKING, Any

import pytest

if TYPE_CHECKING:
    from .bench import Bench
    from .trial_run import TrialRun

_FAILED = pytest.StashKey[bool]()
_HOLDERS = pytest.StashKey[list[Any]]()
_MARK = (
    "trial(name, *, set=None, engine='direct', limit=None, vehicles=None, autopilots=None, "
    "seeds=None): "
    "run a trial of seatrial; a list runs the test once for each"
)


def pytest_addoption(parser: pytest.Parser) -> None:
    """Add the options."""
    group = parser.getgroup("seatrial")
    group.addoption(
        "--seatrial", action="store_true", help="collect trials and campaigns in TOML as tests"
    )
    group.addoption(
        "--seatrial-engine",
        choices=("direct", "fmu", "native"),
        default="direct",
        help="engine of those: components in process, or each as an FMU (default: direct)",
    )
    group.addoption(
        "--seatrial-limit",
        metavar="KEY=VALUE",
        action="append",
        default=[],
        help="end a run beyond it, which fails its test: wall='60 s', memory='1 GB', call='10 s'",
    )
    group.addoption(
        "--seatrial-runs",
        metavar="DIR",
        default="runs",
        help="where failing trials leave their run folders, from rootdir (default: runs)",
    )


def pytest_configure(config: pytest.Config) -> None:
    """Register the mark."""
    config.addinivalue_line("markers", _MARK)


def pytest_collect_file(file_path: Path, parent: pytest.Collector) -> pytest.Collector | None:
    """Collect a trial or a campaign, if that was asked for."""
    if file_path.suffix != ".toml" or not parent.config.getoption("--seatrial"):
        return None
    from .trial_items import TrialFile, is_trial_file

    if not is_trial_file(file_path):
        return None
    collector: pytest.Collector = TrialFile.from_parent(parent, path=file_path)
    return collector


def pytest_generate_tests(metafunc: pytest.Metafunc) -> None:
    """Run a test of several trials, vehicles, autopilots or seeds once for each."""
    marks = list(metafunc.definition.iter_markers("trial"))
    if "trial" not in metafunc.fixturenames or not marks:
        return
    from .marked import variants

    found = variants(marks)
    if len(found) > 1:
        ids = [variant.id for variant in found]
        metafunc.parametrize("trial", found, indirect=True, ids=ids)


@pytest.hookimpl(wrapper=True)
def pytest_runtest_makereport(item: pytest.Item, call: pytest.CallInfo[None]) -> Iterator[None]:
    """Note a failure, and add to its report what simulations of the test have to say."""
    report = yield
    if report.failed:  # type: ignore[attr-defined]
        item.stash[_FAILED] = True
    if call.when == "call":
        for holder in item.stash.get(_HOLDERS, []):
            sections = holder.report_sections(failed=report.failed)  # type: ignore[attr-defined]
            report.sections += sections  # type: ignore[attr-defined]
            item.user_properties += holder.properties
            report.user_properties = item.user_properties  # type: ignore[attr-defined]
    return report


@pytest.fixture
def trial(request: pytest.FixtureRequest) -> Iterator[TrialRun]:
    """The trial that the mark names, run: `seatrial.testing.trial_run.TrialRun`."""
    from .marked import variants
    from .trial_run import TrialRun, limited, run_folder

    marks = list(request.node.iter_markers("trial"))
    if not marks:
        raise pytest.UsageError("the fixture 'trial' needs @pytest.mark.trial(NAME)")
    variant = getattr(request, "param", None) or variants(marks)[0]
    folder = run_folder(request.config, request.node.nodeid)
    loaded = limited(variant.loaded(request.path.parent), request.config)
    run = TrialRun.of(loaded, folder, variant.engine)
    request.node.stash.setdefault(_HOLDERS, []).append(run)
    yield run
    run.leave(keep=request.node.stash.get(_FAILED, False))


@pytest.fixture
def simulation(request: pytest.FixtureRequest) -> Iterator[Callable[..., Bench]]:
    """A function that makes simulations of a rig, closed when the test is over."""
    from .bench import Bench

    made: list[Bench] = []

    def make(rig: str | Path, **settings: Any) -> Bench:
        beside = request.path.parent / rig
        bench = Bench(
            beside if str(rig).endswith(".toml") and beside.is_file() else rig, **settings
        )
        made.append(bench)
        request.node.stash.setdefault(_HOLDERS, []).append(bench)
        return bench

    yield make
    for bench in reversed(made):
        bench.close()


@pytest.fixture
def sketch(
    request: pytest.FixtureRequest, simulation: Callable[..., Bench], tmp_path: Path
) -> Callable[..., Any]:
    """A function that runs an Arduino sketch alone, and returns its board."""
    from ..plugins import service

    def run(path: str | Path, **settings: Any) -> Any:
        rig = service("arduino.sketch_rig")(request.path.parent / path, tmp_path, settings)
        return simulation(rig).board("board")

    return run


@pytest.fixture
def assert_holds(request: pytest.FixtureRequest) -> Callable[..., None]:
    """``assert_holds(condition, during=...)`` of the test's trial, or its one simulation."""

    def holds(condition: str, during: Any = None) -> None:
        __tracebackhide__ = True
        holders = request.node.stash.get(_HOLDERS, [])
        if len(holders) != 1:
            raise pytest.UsageError(
                f"assert_holds needs one trial or simulation, the test has {len(holders)}: "
                "call its method"
            )
        holders[0].assert_holds(condition, during=during)

    return holds
