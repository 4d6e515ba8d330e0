"""Limits of other tools: what of an SSP package they reject, ignore or take otherwise."""

from __future__ import annotations

import tomllib
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from seatrial.errors import InputError, unknown
from seatrial.fmi.files.xmlfile import read_xml

from . import rules
from .documents import NAMESPACES, where
from .notes import Notes
from .package import open_package

TOOLS = ("omsimulator", "libcosim", "ecos", "fmpy", "fmucontainer")

Finder = Callable[[Any], Iterator[Any]]
"""Yields the elements of a description that a fact is about."""


@dataclass(frozen=True)
class Fact:
    """How tools take what ``finder`` finds: {tool: what it does}."""

    finder: Finder
    rejected: dict[str, str]
    changed: dict[str, str]


@dataclass(frozen=True)
class Finding:
    """One thing that a tool does with a package."""

    tool: str
    rejects: bool
    where: str
    text: str


def _facts() -> Iterator[Fact]:
    text = Path(__file__).with_name("tools.toml").read_text("utf-8")
    for row in tomllib.loads(text)["facts"]:
        rule = getattr(rules, row["rule"])
        finder = rule(*row["of"]) if "of" in row else rule
        yield Fact(finder, _by_tool(row.get("rejected", {})), _by_tool(row.get("changed", {})))


def _by_tool(said: dict[str, str]) -> dict[str, str]:
    return {tool: text for tools, text in said.items() for tool in tools.split()}


FACTS = tuple(_facts())


def takes_systems(tool: str) -> bool:
    """Say if one of `TOOLS` takes systems inside systems. Raises InputError for another name."""
    if tool not in TOOLS:
        raise InputError(unknown("tool", tool, TOOLS))
    return not any(tool in f.rejected for f in FACTS if f.finder is rules.inner_systems)


def findings(path: Path) -> list[Finding]:
    """Return what the tools do with the package at ``path``, in the order of `TOOLS`.

    Raises InputError for what is no package or no XML.
    """
    package = open_package(path, path.name, Notes())
    label = package.shown(package.description)
    root = read_xml(package.description, label, lambda prefix, _line: NAMESPACES.get(prefix))
    root.getroottree().docinfo.URL = label
    view = rules.View(root, package.folder)
    found = []
    for fact in FACTS:
        elements = list(fact.finder(view))
        if not elements:
            continue
        more = f" (and {len(elements) - 1} more)" if len(elements) > 1 else ""
        for rejects, said in ((True, fact.rejected), (False, fact.changed)):
            for tool, text in said.items():
                found.append(Finding(tool, rejects, where(elements[0]), text + more))
    return sorted(found, key=lambda one: (TOOLS.index(one.tool), not one.rejects))
