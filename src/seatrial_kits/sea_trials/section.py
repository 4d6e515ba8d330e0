"""Sections of a run's report: figures and drawings of its manoeuvre."""

from __future__ import annotations

from collections.abc import Iterator

from seatrial.errors import InputError
from seatrial.trial.records.run_folder import Run

_COMPONENT = "manoeuvre"


def manoeuvre(run: Run) -> Iterator[tuple[str, str]]:
    """Yield titles and figures of the manoeuvre of a run, if it was begun.

    A record that does not hold its figures says why, in their place.
    """
    if all(entry["fmu"] != _COMPONENT for entry in run.manifest["components"].values()):
        return
    # Every report asks: those of other runs go without SciPy.
    from .curves import drawings
    from .drawing import table
    from .evaluation import figures_of
    from .run_record import done_in, has_manoeuvre

    if not has_manoeuvre(run):
        return

    try:
        done = done_in(run)
        found = figures_of(done)
    except InputError as error:
        yield "Manoeuvre", table([("no figures", "–", str(error))]).json()
        return
    for title, figure in drawings(done, found):
        yield title, figure.json()
