"""seatrial: sea trials before the water.

FMI co-simulation components and a software-in-the-loop harness for marine robots. What is named
here is the Python API; ``docs/python.md`` shows it. To write components: `seatrial.model.component`
and `seatrial.model.plant`.
"""

from __future__ import annotations

import importlib
from typing import TYPE_CHECKING, Any

from .moved import find_moved

if TYPE_CHECKING:
    from .api.batch import Batch, Batches
    from .api.campaigns import CampaignResult, ask_campaign, load_campaign_result, run_campaign
    from .api.results import TrialResult, Verdict, load_result, run_trial
    from .api.simulation import Simulation
    from .errors import InputError, SeatrialError, SimulationError

__version__ = "0.2.0"

find_moved()

__all__ = [
    "Batch",
    "Batches",
    "CampaignResult",
    "InputError",
    "SeatrialError",
    "Simulation",
    "SimulationError",
    "TrialResult",
    "Verdict",
    "__version__",
    "ask_campaign",
    "load_campaign_result",
    "load_result",
    "run_campaign",
    "run_trial",
]

_MODULES = {
    "api.batch": ("Batch", "Batches"),
    "api.campaigns": ("CampaignResult", "ask_campaign", "load_campaign_result", "run_campaign"),
    "api.results": ("TrialResult", "Verdict", "load_result", "run_trial"),
    "api.simulation": ("Simulation",),
    "errors": ("InputError", "SeatrialError", "SimulationError"),
}


def __getattr__(name: str) -> Any:
    # Imported when it is asked for: the command line and every FMU import this package too.
    for module, names in _MODULES.items():
        if name in names:
            return getattr(importlib.import_module(f".{module}", __name__), name)
    raise AttributeError(f"module {__name__!r} has no attribute {name!r}")


def __dir__() -> list[str]:
    return sorted({*globals(), *__all__})
