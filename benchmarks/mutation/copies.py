"""A copy of the checkout that mutants are made in, and tests in a process forked for each."""

from __future__ import annotations

import contextlib
import importlib
import os
import resource
import shutil
import signal
import subprocess
import sys
from collections.abc import Callable, Iterator
from pathlib import Path

from .operators import Mutant

ROOT = Path(__file__).parents[2]
BUILD = ROOT / "build" / "mutation"
COPY = BUILD / "copy"
KITS = ("drone", "fitted", "panels", "sailing", "ships", "underwater", "videoray")
"""Kits with equations."""
PACKAGES = (
    *(f"seatrial.{name}" for name in ("physics", "devices", "control")),
    *(f"seatrial_kits.{name}" for name in KITS),
)
"""Where mutants are made."""
LIBRARIES = ("casadi", "hypothesis", "lxml.etree", "pint", "pydantic", "pytest", "scipy.optimize")
LOG = BUILD / "tests.log"
"""What the tests printed that ran last."""


def copied() -> None:
    """Make the copy anew, of what git does not ignore: the working tree is never changed."""
    shutil.rmtree(COPY, ignore_errors=True)
    listed = ("git", "ls-files", "-z", "--cached", "--others", "--exclude-standard")
    for name in subprocess.check_output(listed, cwd=ROOT, text=True).split("\0"):
        if name and (ROOT / name).is_file():
            (COPY / name).parent.mkdir(parents=True, exist_ok=True)
            shutil.copy2(ROOT / name, COPY / name)


def begin() -> None:
    """Import and make, of the copy, what tests have in common and no mutant can change."""
    os.chdir(COPY)
    sys.path[:0] = [str(COPY / "src"), str(COPY)]
    os.environ["PYTHONPATH"] = str(COPY / "src")
    for name in LIBRARIES:
        importlib.import_module(name)
    from seatrial.fmi.building.bundle import bundled
    from seatrial.fmi.components.source import shipped_sources
    from seatrial.model.units import unit

    unit("furlong")
    bundled(shipped_sources()["marine-craft"])
    early = [name for name in sys.modules if name.startswith(PACKAGES)]
    if early:
        raise RuntimeError(f"imported before a mutant is made: {', '.join(early)}")


@contextlib.contextmanager
def mutated(mutant: Mutant) -> Iterator[None]:
    """Change a file of the copy for a while; its time tells compiled modules of it apart."""
    path = COPY / mutant.path
    source, times = path.read_bytes(), path.stat()
    path.write_bytes(mutant.applied(source))
    try:
        yield
    finally:
        path.write_bytes(source)
        os.utime(path, ns=(times.st_atime_ns, times.st_mtime_ns))


def tests(files: list[str], seed: int) -> int:
    """Run test files in their order up to the first failure; return pytest's status."""
    import pytest

    options = ("-x", "--tb=short", "-n0", "-m", "not interop and not long", "-o", "addopts=")
    plain = ("--import-mode=importlib", "-p", "no:cacheprovider", f"--hypothesis-seed={seed}")
    return int(pytest.main(["-q", *options, *plain, *files]))


def forked(action: Callable[[], int], limit: int) -> tuple[int, float]:
    """Return the status of ``action`` in a copy of this process, and its seconds of processor.

    What `begin` has imported and made is there at once. Beyond ``limit`` seconds of processor, or
    ten times as long by the clock, a signal ends it: its number, negative, is the status.
    """
    pid = os.fork()
    if pid == 0:
        os.setsid()
        resource.setrlimit(resource.RLIMIT_CPU, (limit, limit))
        signal.alarm(10 * limit)
        log = os.open(LOG, os.O_WRONLY | os.O_CREAT | os.O_TRUNC)
        os.dup2(log, 1)
        os.dup2(log, 2)
        status = 70
        with contextlib.suppress(BaseException):
            status = action()
        sys.stdout.flush()
        os._exit(status)
    _, status, used = os.wait4(pid, 0)
    with contextlib.suppress(ProcessLookupError):
        os.killpg(pid, signal.SIGKILL)  # what it left running
    return os.waitstatus_to_exitcode(status), used.ru_utime + used.ru_stime
