"""Summary of a job of sea trials: failed tests, campaigns, and changes by a pull request.

Markdown goes to the file GITHUB_STEP_SUMMARY, or to stdout where there is none; annotations of
failed criteria go to stdout as workflow commands. CAMPAIGNS are files with wildcards; each is run
here, and again at the revision BASE (or PULL_BASE), with this revision's seatrial. The status is 1
if a campaign fails, or a verdict goes from pass to fail.
"""

from __future__ import annotations

import json
import os
import re
import subprocess
import sys
from collections.abc import Iterable, Iterator
from glob import glob
from itertools import pairwise
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any
from xml.etree import ElementTree

OUT = Path("sea-trials")
WORDS = {"pass": "✓ pass", "fail": "✗ fail", "undecided": "? undecided"}


def main() -> int:
    """Write the summary, and return the exit status."""
    lines = list(tests(OUT / "junit.xml"))
    base = os.environ.get("BASE") or os.environ.get("PULL_BASE", "")
    files: list[Path] = []
    status = 0
    for word in os.environ["CAMPAIGNS"].split():
        files += map(Path, sorted(glob(word)))
        if not glob(word):
            annotate(f"no file is called {word}", None, None, "campaigns")
            status = 1
    with TemporaryDirectory() as folder:
        before = worktree(base, Path(folder) / "base") if base and files else None
        if base and files and before is None:
            annotate(f"there is no revision {base} to compare with", None, None, "base")
            status = 1
        for file in files:
            said, failed = campaign(file, before, base)
            lines += said
            status |= failed
        if before is not None:
            git("worktree", "remove", "--force", str(before))
    target = os.environ.get("GITHUB_STEP_SUMMARY")
    text = "\n".join(lines) + "\n"
    if target:
        with Path(target).open("a", encoding="utf-8") as summary:
            summary.write(text)
    else:
        sys.stdout.write(text)
    return status


def tests(junit: Path) -> Iterator[str]:
    """Yield the summary of a JUnit file, and annotate its failures."""
    if not junit.is_file():
        return
    cases = list(ElementTree.parse(junit).iter("testcase"))
    failed = [
        (case, found)
        for case in cases
        for found in [*case.findall("failure"), *case.findall("error")][:1]
    ]
    yield from ("## Sea trials", "", f"{len(cases) - len(failed)} of {len(cases)} tests pass.", "")
    rows = []
    for case, found in failed:
        text = found.text or found.get("message", "")
        said = list(annotate_test(case.get("classname", ""), case.get("name", ""), text))
        rows.append([case.get("name"), "<br>".join(said)])
    yield from table(["failed", "by"], rows)


def annotate_test(module: str, name: str, text: str) -> Iterator[str]:
    """Annotate each criterion that a failure names, or its test; yield the messages."""
    file = file_of(module)
    found = False
    lines = [*text.splitlines(), ""]
    for criterion, line in criteria_of(file):
        for said, below in pairwise(lines):
            if said.startswith(f"{criterion}: "):
                said += f"; {below.strip()}" if below.startswith("  ") else ""
                annotate(said, file, line, criterion)
                yield said
                found = True
    if not found:
        errors = [said[1:].strip() for said in lines if said.startswith("E  ")]
        said = next(filter(None, [*errors, *lines]), f"{name} failed")
        annotate(said, file, None, name)
        yield said


def file_of(module: str) -> Path | None:
    """Return the file that a JUnit file has with dots in the place of slashes."""
    for path in sorted([*Path().rglob("*.toml"), *Path().rglob("*.py")]):
        dotted = ".".join(path.with_suffix("" if path.suffix == ".py" else path.suffix).parts)
        if module == dotted or (path.suffix == ".py" and module.startswith(f"{dotted}.")):
            return path
    return None


def criteria_of(file: Path | None) -> Iterator[tuple[str, int]]:
    """Yield the names of the criteria in a trial's or a campaign's file, with their lines."""
    if file is None or file.suffix != ".toml":
        return
    for number, line in enumerate(file.read_text("utf-8").splitlines(), 1):
        if found := re.search(r"""\bname\s*=\s*(?:"([^"]*)"|'([^']*)')""", line):
            yield found[1] or found[2] or "", number


def campaign(file: Path, before: Path | None, base: str) -> tuple[list[str], bool]:
    """Run a campaign, and at the base; return its summary, and whether it failed."""
    out = OUT / "campaigns" / file.stem
    done = seatrial("run", file, "--engine", os.environ["ENGINE"], "--out", out)
    lines = [f"## {file}", ""]
    if done["status"] > 1:
        annotate(done["error"] or "the campaign could not run", file, None, file.stem)
        return [*lines, f"✗ {done['error']}", ""], True
    accepted = done["result"].get("criteria", [])
    places = dict(criteria_of(file))
    for each in accepted:
        if each["verdict"] != "pass":
            said = f"{each['check']}: {each['verdict']}: {each['detail']}"
            annotate(said, file, places.get(each["name"]), each["name"])
    if done["status"] == 1 and not accepted:
        annotate("cases fail: the campaign's report names them", file, None, file.stem)
    rows = [[c["name"], c["check"], WORDS[c["verdict"]], c["detail"]] for c in accepted]
    lines += table(["criterion", "check", "verdict", "found"], rows)
    if before is None:
        return lines, done["status"] == 1
    if not (before / file).is_file():
        return [*lines, f"{base} has no {file}: nothing to compare with.", ""], done["status"] == 1
    said, worse = comparison(file, out, before, base)
    return [*lines, *said], done["status"] == 1 or worse


def comparison(file: Path, out: Path, before: Path, base: str) -> tuple[list[str], bool]:
    """Run a campaign at the base, and compare; return Markdown, and whether a verdict got worse."""
    old = (OUT / "base" / file.stem).absolute()
    engine = os.environ["ENGINE"]
    done = seatrial("run", file, "--engine", engine, "--out", old, folder=before)
    if done["status"] > 1:
        return [f"At {base}: {done['error']}", ""], False
    page = OUT / f"{file.stem}.html"
    done = seatrial("compare", old, out, "--page", page)
    if done["status"] > 1:
        return [f"No comparison with {base}: {done['error']}", ""], False
    found = done["result"]
    worse = found["worse"]
    if worse:
        annotate(f"a verdict went from pass to fail since {base}", file, None, file.stem)
    verdict = "✗ a verdict went from pass to fail" if worse else "✓ no verdict got worse"
    lines = [f"### Compared with {base[:12]}: {verdict}", ""]
    lines += [f"- {line}" for line in found["summary"]]
    for each in found["tables"]:
        lines += ["", f"**{each['title']}**", "", *table(each["columns"], each["rows"])]
    return [*lines, ""], worse


def table(columns: list[str], rows: Iterable[list[Any]]) -> Iterator[str]:
    """Yield the lines of a table in Markdown; nothing without a row."""
    rows = list(rows)
    if not rows:
        return
    yield f"| {' | '.join(map(cell, columns))} |"
    yield f"| {' | '.join('---' for _ in columns)} |"
    for row in rows:
        yield f"| {' | '.join(map(cell, row))} |"
    yield ""


def cell(value: Any) -> str:
    """Return a value as it stands in a table."""
    text = f"{value:.4g}" if isinstance(value, float) else str(value)
    return text.replace("|", "\\|").replace("\n", " ")


def annotate(said: str, file: Path | None, line: int | None, title: str) -> None:
    """Print an error at a place of a file, as a workflow command of GitHub."""
    at = [f"file={escaped(file.as_posix())}"] if file else []
    at += [f"line={line}"] if line else []
    at.append(f"title={escaped(title)}")
    text = said.replace("%", "%25").replace("\r", "%0D").replace("\n", "%0A")
    print(f"::error {','.join(at)}::{text}")


def escaped(text: str) -> str:
    """Return a property of a workflow command."""
    for character in "%\r\n:,":
        text = text.replace(character, f"%{ord(character):02X}")
    return text


def seatrial(*arguments: object, folder: Path | None = None) -> dict[str, Any]:
    """Return the answer of a command in JSON."""
    command = [sys.executable, "-m", "seatrial", *map(str, arguments), "--json"]
    done = subprocess.run(command, cwd=folder, capture_output=True, text=True, check=False)
    try:
        answer: dict[str, Any] = json.loads(done.stdout)
    except ValueError:
        return {"status": done.returncode or 3, "error": done.stderr[-2000:], "result": {}}
    return answer


def worktree(revision: str, folder: Path) -> Path | None:
    """Check a revision out, fetched if the clone lacks it; return its folder, None without it."""
    if not git("cat-file", "-e", f"{revision}^{{commit}}"):
        git("fetch", "--quiet", "--depth=1", "origin", revision)
    return folder if git("worktree", "add", "--quiet", "--detach", str(folder), revision) else None


def git(*arguments: str) -> bool:
    """Run git, and return whether it succeeded; its messages go to stderr."""
    return not subprocess.run(["git", *arguments], stdout=sys.stderr, check=False).returncode


if __name__ == "__main__":
    sys.exit(main())
