"""Names that rigs inside a rig show, in a trial: each replaced by the path of what it means."""

from __future__ import annotations

from dataclasses import replace

from ...errors import InputError
from ...sim.faults import components_of
from ...sim.recorder import matching, output_names
from ...system.joining import Resolver
from ...system.paths import split_path
from ...system.system import System
from ..criteria.criteria import Criterion
from .trial import Trial


def by_path(trial: Trial, system: System) -> Trial:
    """Return the trial with the signals that it reads by their paths, as they are recorded.

    Criteria, plots, records and ``real_time`` may write ``vehicle.motion.position.x`` for
    ``vehicle.hull.position.x``. Other names stay as they are. Raises InputError for what a rig
    inside does not show.
    """
    naming, file = _Naming(system), trial.file
    where = str(trial.read_from.path)
    criteria = tuple((name, naming.criterion(c, f"{where}: {name}")) for name, c in trial.criteria)
    figures = tuple(naming.one(figure, where) for figure in trial.figures)
    if not trial.rig.top.inner:
        return replace(trial, criteria=criteria, figures=figures)
    plots = [
        entry.model_copy(update={"signals": [naming.one(s, where) for s in entry.signals]})
        for entry in file.plots
    ]
    patterns = [p for each in file.record.signals for p in naming.pattern(each, where)]
    record = file.record.model_copy(update={"signals": patterns})
    real_time = file.real_time
    if real_time is not None:
        signals = {"factor": real_time.factor, "paused": real_time.paused}
        found = {k: naming.one(s, where) for k, s in signals.items() if isinstance(s, str)}
        real_time = real_time.model_copy(update=found)
    changes = {"plots": plots, "record": record, "real_time": real_time}
    changed = file.model_copy(update=changes)
    return replace(trial, file=changed, criteria=criteria, figures=figures)


def named_components(trial: Trial, system: System) -> set[str]:
    """Return the components that a trial of signals by path names, in whatever it says.

    The pattern ``*`` names none.
    """
    file, where = trial.file, str(trial.read_from.path)
    signals = {signal for _, criterion in trial.criteria for signal in criterion.signals}
    signals |= {signal for plot in file.plots for signal in plot.signals} | {*trial.figures}
    patterns = [pattern for pattern in file.record.signals if pattern != "*"]
    signals |= set(matching(output_names(system), patterns))
    if file.real_time is not None:
        signals |= {s for s in (file.real_time.factor, file.real_time.paused) if isinstance(s, str)}
    keys = {event.key for event in trial.events()} | {setting.key for setting in trial.settings()}
    keys |= {key for key, _, _ in trial.scales}
    located = [system.located(name, where) for name in signals | keys]
    faulty = {c for entry in file.faults for c in components_of(system, entry, where)}
    return {part.name for places in located for part, _ in places} | faulty


class _Naming:
    """Finds outputs by what is written."""

    def __init__(self, system: System) -> None:
        self._system = system
        self._outputs = frozenset(output_names(system))
        self._resolver = Resolver(system.parts, system.rig.top)

    def one(self, written: str, where: str) -> str:
        """Return the path of the output that a name means, or the name if it means none."""
        inner = written.partition(".")[0] in self._system.rig.top.inner
        if written in self._outputs or not inner:
            return written
        names = [f"{part.name}.{port}" for part, port in self._system.located(written, where)]
        return names[0] if len(names) == 1 and names[0] in self._outputs else written

    def criterion(self, criterion: Criterion, where: str) -> Criterion:
        """Return a criterion of outputs by path."""
        texts = {name for name, kinds in criterion.kinds.items() if "text" in kinds}
        named = {n: self._text_of_terminal(n) if n in texts else n for n in criterion.signals}
        return criterion.renamed({n: self.one(found, where) for n, found in named.items()})

    def _text_of_terminal(self, name: str) -> str:
        """Return the one output of a component's terminal, such as a UART: or the name itself."""
        if name in self._outputs:
            return name
        component, port = split_path(self._system.parts, name)
        part = self._system.parts.get(component)
        terminal = None if part is None else part.instance.terminals.get(port)
        if part is None or terminal is None:
            return name
        members = {f"{component}.{member}" for member in terminal.members.values()}
        found = sorted(members & self._outputs)
        return found[0] if len(found) == 1 else name

    def pattern(self, written: str, where: str) -> list[str]:
        """Return the patterns of paths for one of shown names: a name, or ``name.*``."""
        name = written.removesuffix(".*")
        if any(mark in name for mark in "*?["):
            return [written]
        try:
            group = self._resolver.anywhere(name, where)
        except InputError:
            return [self.one(written, where)] if name == written else [written]
        scalars = [
            f"{end.component}.{v.name}" for end in group.ends for v in self._resolver.variables(end)
        ]
        found = [scalar for scalar in scalars if scalar in self._outputs]
        return found or [written]
