"""A campaign with all of its files in one piece, for workers that have none of them."""

from __future__ import annotations

import hashlib
import io
import json
import os
import tarfile
import tempfile
from collections.abc import Iterator
from contextlib import chdir
from functools import lru_cache
from itertools import product
from pathlib import Path, PurePosixPath

from seatrial.errors import InputError
from seatrial.files.vehicle_folders import FOLDERS
from seatrial.trial.files.fault_keys import is_choice
from seatrial.trial.files.trial import Trial
from seatrial.trial.records.deciding import (
    deciding_files,
    files_in,
    found_by_name,
    named_in,
    our_folders,
)
from seatrial.trial.records.program import program

from .campaign import Campaign, load_campaign

MOST_BYTES = 200_000_000


def packed(campaign: Campaign) -> bytes:
    """Return a campaign as a tar archive: the user's files around it, and which one to load.

    Of a user's campaign that is the folder that holds it and all that it needs (`needed_files`),
    or that of their ``harness``, without ``runs`` and what is hidden; of a shipped one nothing but
    the name. Raises InputError if that is more than `MOST_BYTES`.
    """
    own, here = campaign.read_from.path.resolve(), Path.cwd().resolve()
    top = _top(campaign)
    is_ours = top is None or not own.is_relative_to(top)
    name = campaign.read_from.name if top is None or is_ours else own.relative_to(top).as_posix()
    place = here.relative_to(top).as_posix() if top and here.is_relative_to(top) else "."
    stream, total = io.BytesIO(), 0
    with tarfile.open(fileobj=stream, mode="w", format=tarfile.PAX_FORMAT) as archive:
        settings = (json.dumps(dict(each)) for each in (campaign.changes, campaign.limit))
        said = (json.dumps(program()), name, place, *settings)
        _add(archive, "campaign", "\n".join(said).encode())
        for path in files_in(top) if top is not None else ():
            assert top is not None
            data = path.read_bytes()
            total += len(data)
            if total > MOST_BYTES:
                raise InputError(
                    f"{top}: the files beside the campaign have more than "
                    f"{MOST_BYTES // 1_000_000} MB: put it and what it needs in a folder apart"
                )
            _add(archive, str(PurePosixPath("files", path.relative_to(top).as_posix())), data)
    return stream.getvalue()


def unpacked(data: bytes) -> tuple[Campaign, Path]:
    """Return the campaign of an archive, and the folder to be in while it runs; once per process.

    Raises InputError, also if another seatrial has packed it, or one with other libraries
    (`program`).
    """
    return _unpacked(hashlib.sha256(data).hexdigest(), data)


_folders: list[tempfile.TemporaryDirectory[str]] = []
"""Of this process; they go when it ends."""


@lru_cache(maxsize=4)
def _unpacked(_sha256: str, data: bytes) -> tuple[Campaign, Path]:
    _folders.append(tempfile.TemporaryDirectory(prefix="seatrial-campaign-"))
    folder = Path(_folders[-1].name)
    unpack_folder(data, folder)
    packer, name, place, changes, limit = (folder / "campaign").read_text("utf-8").split("\n")
    _refuse_other(json.loads(packer))
    top = folder / "files"
    home = top / place
    home.mkdir(parents=True, exist_ok=True)
    with chdir(home):
        path = str(top / name) if name.endswith(".toml") else name
        return load_campaign(path, json.loads(changes), json.loads(limit)), home


def _refuse_other(packer: dict[str, str]) -> None:
    """Raise InputError if this program is not the one that has packed a campaign."""
    here = program()
    for name in dict.fromkeys([*packer, *here]):
        if (there := packer.get(name, "none")) != (own := here.get(name, "none")):
            raise InputError(f"a worker has {name} {own}, and the campaign is of {there}")


def pack_folder(folder: Path) -> bytes:
    """Return a run folder as a tar archive."""
    stream = io.BytesIO()
    with tarfile.open(fileobj=stream, mode="w:gz", dereference=True) as archive:
        archive.add(folder, folder.name)
    return stream.getvalue()


def unpack_folder(data: bytes, below: Path) -> None:
    """Put an archive's files and folders ``below``, with the permissions of files made here.

    Raises InputError for a member that is neither, or leads elsewhere. (`tarfile` has filters for
    members since Python 3.11.4 only.)
    """
    with tarfile.open(fileobj=io.BytesIO(data)) as archive:
        for one in archive:
            inside = PurePosixPath(one.name)
            content = archive.extractfile(one) if one.isfile() else None
            if inside.is_absolute() or ".." in inside.parts or not (content or one.isdir()):
                raise InputError(f"an archive has {one.name!r}, and not files and folders alone")
            place = below / inside
            (place.parent if content else place).mkdir(parents=True, exist_ok=True)
            if content:
                place.write_bytes(content.read())


def _top(campaign: Campaign) -> Path | None:
    """Return the folder that has all of a user's files; None if there are none."""
    files = needed_files(campaign)
    if not files:
        return None
    common = Path(os.path.commonpath([p if p.is_dir() else p.parent for p in files]))
    within = [parent for parent in (common, *common.parents) if parent.name == "harness"]
    return within[-1].parent if within else common


def _add(archive: tarfile.TarFile, name: str, data: bytes) -> None:
    entry = tarfile.TarInfo(name)
    entry.size = len(data)
    archive.addfile(entry, io.BytesIO(data))


def needed_files(campaign: Campaign) -> list[Path]:
    """Return a user's files and folders that a campaign needs, for another machine.

    Those that decide its cases (`files_of`), but not those named by an absolute path, which
    is the same wherever it is read; with the current folder where a vehicle or profile is found by
    its name below that.
    """
    found = {
        path: None
        for trial in campaign.trials
        for path in files_of(campaign, trial, is_absolute_too=False)
    }
    here, ours = Path.cwd().resolve(), our_folders()
    for trial in campaign.trials:
        for kind, name, path in found_by_name(trial.rig):
            is_below = path.parent in (here / kind, here / FOLDERS / name)
            if is_below and not name.endswith(".toml") and not any(map(path.is_relative_to, ours)):
                found[here] = None
    return list(found)


def files_of(campaign: Campaign, trial: Trial, *, is_absolute_too: bool = True) -> list[Path]:
    """Return the user's files that decide the cases of one of a campaign's trials, and folders.

    The campaign, and what decides the trial by all choices that cases make (`deciding_files`),
    without the campaign's other trials.
    """
    others = {each.read_from.path.resolve() for each in campaign.trials if each is not trial}
    above = [campaign.read_from.path, *named_in(campaign.changes, Path.cwd(), is_absolute_too)]
    chosen = _by_choices(campaign, trial)
    return deciding_files(chosen, above, others, is_absolute_too=is_absolute_too)


def _by_choices(campaign: Campaign, trial: Trial) -> Iterator[Trial]:
    """Yield a trial with each combination of choices that the campaign's cases make."""
    blocks = [block for block in campaign.cases().blocks if block.base.name == trial.name]
    for block in blocks:
        values = {key: each for key, each in block.grid.items() if is_choice(key)}
        drawn = {tuple((k, v) for k, v in row.items() if is_choice(k)) for row in block.rows}
        for picked in product(*values.values()):
            for row in sorted(drawn):
                changes = dict(zip(values, picked, strict=True)) | dict(row)
                yield block.base.changed(changes, block.where) if changes else block.base
