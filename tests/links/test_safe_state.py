"""Safe states of several FMUs in one process, each of which has a copy of the package."""

from __future__ import annotations

import importlib.util
import os
import sys
from types import ModuleType

import pytest

from seatrial.links import safe_state

pytestmark = pytest.mark.skipif(sys.platform == "win32", reason="descriptors between processes")


def copy(number: int) -> ModuleType:
    """Return a copy of the module, as another FMU has it."""
    specification = importlib.util.spec_from_file_location(
        f"seatrial.links.copy{number}", safe_state.__file__
    )
    assert specification is not None
    assert specification.loader is not None
    module = importlib.util.module_from_spec(specification)
    specification.loader.exec_module(module)
    return module


def test_what_one_fmu_releases_is_its_own() -> None:
    from seatrial.links.safe_state_keeper import SafeStates

    states, (ours, theirs) = SafeStates(), os.pipe()
    pid = os.fork()
    if not pid:
        os.environ[safe_state.ENVIRONMENT] = str(states.left_to_child())
        held = [copy(n).hold(f"port{n}", "there", theirs, b"%d" % n) for n in range(3)]
        held[1].release()
        os._exit(0)
    os.waitpid(pid, 0)
    assert states.of_ended() == [f"sent the safe state of port{n} to there" for n in (0, 2)]
    assert os.read(ours, 100) == b"02"
    states.close()
    os.close(ours)
    os.close(theirs)
