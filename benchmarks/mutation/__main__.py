"""Mutation check: how many small changes of equations make a test fail.

``make mutate COUNT=600 SEED=1`` draws lines of the folders `SCOPE` evenly, changes each in one
way (`operators`), and runs the test files of `TESTS` that execute it, the fastest first, up to the
first failure. These files are found by coverage, recorded once. Killed mutants stay so when the
command runs again; survivors run again when a test file has changed. All is kept below
``build/mutation``.

mutmut and cosmic-ray do not serve: neither swaps axes, indices or sine and cosine, mutmut reads
the calls of every function through trampolines, which expressions of CasADi do not survive, and
cosmic-ray runs one command of tests for all mutants and changes the working tree.
"""

from __future__ import annotations

import argparse
import ast
import hashlib
import json
import random
from collections import Counter
from pathlib import Path

import coverage
from scipy.stats import binomtest

from .copies import BUILD, COPY, KITS, LOG, PACKAGES, begin, copied, forked, mutated, tests
from .operators import Mutant, mutants

SCOPE = tuple(f"src/{name.replace('.', '/')}" for name in PACKAGES)
TESTS = tuple(
    f"tests/{name}"
    for name in (
        *("base", "control", "craft", "devices", "environment", "sea"),
        *(f"kits/{kit}" for kit in KITS),
    )
)
SLOWEST = 180
"""Seconds of processor beyond which a test file is left out."""
FIRST = 4
"""Test files that a mutant meets before the others are read."""
KILLED = ("killed", "timeout")


def modules() -> list[Path]:
    """Return the files of the scope, in the copy."""
    return sorted(path for folder in SCOPE for path in (COPY / folder).rglob("*.py"))


def drawn(count: int, seed: int) -> list[Mutant]:
    """Return ``count`` mutants of the scope: lines drawn evenly, one mutant of each."""
    by_line: dict[tuple[str, int], list[Mutant]] = {}
    for path in modules():
        for mutant in mutants(path.read_bytes(), path.relative_to(COPY).as_posix()):
            by_line.setdefault((mutant.path, mutant.line), []).append(mutant)
    draw = random.Random(seed)
    lines = draw.sample(sorted(by_line), min(count, len(by_line)))
    return [draw.choice(by_line[line]) for line in lines]


def digest(*texts: bytes) -> str:
    """Return a hash of files' texts."""
    return hashlib.sha256(b"".join(texts)).hexdigest()[:16]


def remembered(path: Path) -> dict[str, dict]:
    """Return the last record of each key of a file with a JSON object a line."""
    lines = path.read_text("utf-8").splitlines() if path.is_file() else []
    return {record["key"]: record for record in map(json.loads, lines)}


def remember(path: Path, record: dict) -> dict:
    """Add a record to such a file."""
    with path.open("a", encoding="utf-8") as file:
        file.write(json.dumps(record) + "\n")
    return record


def executed(name: str, seed: int) -> dict:
    """Return status and seconds of a test file, and the lines of the scope that it executes."""
    data = BUILD / "coverage.data"

    def action() -> int:
        sources = [str(COPY / folder) for folder in SCOPE]
        measured = coverage.Coverage(data_file=str(data), source=sources)
        measured.start()
        status = tests([name], seed)
        measured.stop()
        measured.save()
        return status

    data.unlink(missing_ok=True)
    status, seconds = forked(action, SLOWEST)
    read = coverage.CoverageData(str(data))
    read.read()
    lines = {
        Path(each).relative_to(COPY).as_posix(): sorted(read.lines(each) or ())
        for each in read.measured_files()
    }
    return {"status": status, "seconds": round(seconds, 1), "lines": lines}


def covered(seed: int) -> dict[str, dict]:
    """Return what `executed` does by test file, of those that pass; keep what was recorded."""
    path, found = BUILD / "coverage.jsonl", {}
    known = remembered(path)
    now = {each.relative_to(COPY).as_posix(): digest(each.read_bytes()) for each in modules()}
    files = sorted(each for folder in TESTS for each in (COPY / folder).rglob("test_*.py"))
    for number, file in enumerate(files, 1):
        name = file.relative_to(COPY).as_posix()
        key = f"{name} {digest(file.read_bytes())}"
        record = known.get(key)
        if record is None or any(now.get(each) != was for each, was in record["sources"].items()):
            record = executed(name, seed)
            record |= {"key": key, "sources": {each: now[each] for each in record["lines"]}}
            remember(path, record)
            said = f"{record['seconds']:.0f} s, status {record['status']}"
            print(f"{number}/{len(files)} {name}: {said}", flush=True)
        found[name] = record
    left = [name for name, each in found.items() if each["status"]]
    if left:
        print("left out (no test of the file runs, or one fails or is too slow):", *left)
    return {name: each for name, each in found.items() if name not in left}


def statement(source: bytes, line: int) -> set[int]:
    """Return the lines of the innermost statement at a line: coverage counts one of them."""
    spans = [
        range(node.lineno, (node.end_lineno or 0) + 1)
        for node in ast.walk(ast.parse(source))
        if isinstance(node, ast.stmt) and node.lineno <= line <= (node.end_lineno or 0)
    ]
    return set(min(spans, key=len))


def costs(each: dict, path: str) -> float:
    """Return the seconds of a test file over the share of the module ``path`` in what it runs."""
    return each["seconds"] * sum(map(len, each["lines"].values())) / len(each["lines"][path])


def evaluated(mutant: Mutant, by_file: dict[str, dict], seed: int) -> dict:
    """Return what the tests made of a mutant."""
    at = statement((COPY / mutant.path).read_bytes(), mutant.line)
    files = [name for name, each in by_file.items() if at & set(each["lines"].get(mutant.path, ()))]
    files.sort(key=lambda name: costs(by_file[name], mutant.path))
    if not files:
        return {"outcome": "not executed"}
    limit = 30 + 3 * round(sum(by_file[name]["seconds"] for name in files))

    def action() -> int:
        return tests(files[:FIRST], seed) or (tests(files[FIRST:], seed) if files[FIRST:] else 0)

    with mutated(mutant):
        status, seconds = forked(action, limit)
    outcome = "survived" if status == 0 else "killed" if status > 0 else "timeout"
    failed = [
        line for line in LOG.read_text("utf-8", "replace").splitlines() if line.startswith("FAILED")
    ]
    return {"outcome": outcome, "by": " ".join(failed)[:200], "seconds": round(seconds, 1)}


def main() -> None:
    """Draw mutants, evaluate those that are not yet, print the score and the survivors."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("--count", type=int, required=True, help="number of mutants")
    parser.add_argument("--seed", type=int, required=True, help="seed of the draw")
    chosen = parser.parse_args()
    copied()
    begin()
    by_file = covered(chosen.seed)
    suite = digest(*(each["key"].encode() for each in by_file.values()))
    path, outcomes, survivors = BUILD / "results.jsonl", Counter(), []
    known, sample = remembered(path), drawn(chosen.count, chosen.seed)
    for number, mutant in enumerate(sample, 1):
        source = (COPY / mutant.path).read_bytes()
        key = f"{mutant.path} {digest(source)} {mutant.start} {mutant.end} {mutant.text}"
        record = known.get(key, {})
        if record.get("outcome") not in KILLED and record.get("suite") != suite:
            record = evaluated(mutant, by_file, chosen.seed)
            remember(path, {"key": key, "suite": suite, **record})
        outcomes[record["outcome"]] += 1
        print(f"{number}/{len(sample)} {mutant.path}:{mutant.line} {record['outcome']}", flush=True)
        if record["outcome"] not in KILLED:
            survivors.append(f"{mutant.path}:{mutant.line} {mutant.operator}")
            survivors[-1] += f", {record['outcome']}\n{mutant.diff(source)}\n"
    killed, count = sum(outcomes[each] for each in KILLED), len(sample)
    low, high = binomtest(killed, count).proportion_ci(method="wilson")
    print("\nSurvivors:\n", *survivors, sep="\n")
    print(
        f"killed {killed} of {count} {dict(outcomes)}: {killed / count:.1%}, with 95 % confidence"
    )
    print(f"{low:.1%} to {high:.1%} (Wilson's interval)")


if __name__ == "__main__":
    main()
