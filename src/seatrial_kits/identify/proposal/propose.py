"""A vehicle file from the main particulars of a body of any kind."""

from __future__ import annotations

from collections.abc import Callable, Mapping

from .particulars import Particulars, read_particulars
from .rov_file import rov_proposal
from .surface_file import surface_proposal
from .torpedo_file import torpedo_proposal
from .value import Proposal

_PROPOSALS: dict[str, Callable[[Particulars], Proposal]] = {
    "torpedo": torpedo_proposal,
    "rov": rov_proposal,
    "monohull": surface_proposal,
    "catamaran": surface_proposal,
    "trimaran": surface_proposal,
    "barge": surface_proposal,
}


def propose(kind: str, written: Mapping[str, str | None]) -> Proposal:
    """Return the file of a body by its ``written`` particulars.

    Raises InputError as `read_particulars` and the kind's own module say.
    """
    particulars = read_particulars(kind, written)
    return _PROPOSALS[kind](particulars)
