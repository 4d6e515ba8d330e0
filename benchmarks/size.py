"""Sizes of the core, the kits and an installation: lines, files, packages, what a run loads.

``python -m benchmarks.size`` prints it; run it before and after a change.
"""

from __future__ import annotations

import re
import subprocess
import sys
import tempfile
from collections import Counter
from collections.abc import Iterable
from importlib.metadata import Distribution, distribution
from pathlib import Path

from packaging.requirements import Requirement

ROOT = Path(__file__).parents[1]
SOURCE = ROOT / "src"
LOADED = """
import sys
from seatrial.trial.running.run import run_trial
from seatrial.trial.files.trial import load_trial
run_trial(load_trial("hydrone-landing"), sys.argv[1] + "/run", engine="direct")
ours = ("seatrial", "seatrial_kits")
print(*[m.__file__ for n, m in sys.modules.items() if n.split(".")[0] in ours
        and m.__file__], sep="\\n")
"""


def lines(files: Iterable[Path]) -> int:
    return sum(path.read_text("utf-8").count("\n") for path in files)


def sources(folder: Path) -> list[Path]:
    return [path for path in folder.rglob("*.py") if "templates" not in path.parts]


def requirements(extras: tuple[str, ...]) -> dict[str, Distribution]:
    """Return the distributions that an installation with these extras has, by name."""
    found: dict[str, Distribution] = {}
    pending = [("seatrial", extras)]
    while pending:
        name, wanted = pending.pop()
        key = re.sub(r"[-_.]+", "-", name).lower()
        if key in found and not wanted:
            continue
        found[key] = distribution(name)
        for text in found[key].requires or ():
            one = Requirement(text)
            if one.marker is None or any(one.marker.evaluate({"extra": e}) for e in ("", *wanted)):
                pending.append((one.name, tuple(sorted(one.extras))))
    return found


def megabytes(one: Distribution) -> float:
    places = [Path(str(one.locate_file(file))) for file in one.files or ()]
    return sum(place.stat().st_size for place in places if place.is_file()) / 1e6


def main() -> None:
    core = sources(SOURCE / "seatrial")
    print(f"core: {lines(core)} lines in {len(core)} files")
    kits = sorted(path.parent for path in (SOURCE / "seatrial_kits").glob("*/kit.toml"))
    for kit in kits:
        own = sources(kit)
        print(f"  kit {kit.name}: {lines(own)} lines in {len(own)} files")
    whole = sources(SOURCE)
    print(f"whole: {lines(whole)} lines in {len(whole)} files")
    folder, count = Counter(path.parent for path in whole).most_common(1)[0]
    print(f"largest folder: {folder.relative_to(ROOT)}, {count} files")
    base = requirements(())
    size = sum(megabytes(one) for name, one in base.items() if name != "seatrial")
    print(f"installed: {len(base) - 1} packages, {size:.0f} MB")
    with tempfile.TemporaryDirectory() as out:
        command = [sys.executable, "-c", LOADED, out]
        done = subprocess.run(command, check=True, capture_output=True, text=True)
    loaded = [Path(line) for line in done.stdout.splitlines() if line.endswith(".py")]
    print(f"hydrone-landing loads {len(loaded)} modules of {lines(loaded)} lines")


if __name__ == "__main__":
    main()
