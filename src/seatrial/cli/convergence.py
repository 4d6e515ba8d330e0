"""What the terminal shows of step halving."""

from __future__ import annotations

from rich.box import SIMPLE
from rich.markup import escape
from rich.table import Table

from ..trials.accuracy import Accuracy, by_port, order_text, spread_text
from ..trials.convergence import Convergence
from ..trials.readable import number, person_scale
from .show import console


def print_convergence(found: Convergence) -> None:
    """Print the worst output of each port, and what does not converge, differs or is exact."""
    own, half = (f"{number(step * 1e3, 9)} ms" for step in found.steps[:2])
    rows = [worst for worst in by_port(found.outputs) if worst.behaviour != "exact"]
    if rows:
        title = f"{found.trial}, estimated errors"
        table = Table(title=title, title_justify="left", box=SIMPLE, padding=(0, 1, 0, 0))
        table.add_column("output", overflow="fold")
        table.add_column("unit")
        for heading in ("order", f"at {own}", "of range", f"at {half}"):
            table.add_column(heading, justify="right")
        for worst in rows:
            table.add_row(*_row(worst))
        console.print(table)
        console.print(f"the trial's own step is {own}; of each port the worst axis is shown")
    exact = [output.signal for output in found.outputs if output.behaviour == "exact"]
    if exact:
        console.print(f"{len(exact)} outputs are exact: they differ by round-off, or not at all")
    for one in found.discrete:
        at = next(at for at in one.differs_at if at is not None)
        console.print(f"{escape(one.signal)} differs between steps, first at {number(at, 9)} s")
    wrong = sum(output.behaviour == "not converging" for output in found.outputs)
    if wrong:
        console.print(f"[red]{wrong} of {len(found.outputs)} outputs do not converge[/red]")


def _row(worst: Accuracy) -> list[str]:
    factor, unit = person_scale(worst.unit)
    name = escape(worst.signal)
    spread = spread_text(worst.orders)
    order = order_text(worst.orders[-1]) + (f" ({spread})" if spread else "")
    if worst.behaviour == "not converging":
        apart = number(worst.differences[0] * factor, 3)
        return [name, unit, f"[red]{order}[/red]", f"{apart} apart", _share(worst), "?"]
    own, half = (number(error * factor, 3) for error in worst.errors[:2])
    return [name, unit, order, own, _share(worst), half]


def _share(worst: Accuracy) -> str:
    return f"{number(100 * worst.relative, 2)} %" if worst.range else "constant"
