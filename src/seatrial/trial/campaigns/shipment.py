"""A campaign with all of its files in one piece, for workers that have none of them."""

from __future__ import annotations

import hashlib
import io
import json
import os
import tarfile
import tempfile
from contextlib import chdir
from functools import lru_cache
from pathlib import Path, PurePosixPath

from ...errors import InputError
from ..records.deciding import files_in
from ..records.program import program
from .campaign import Campaign, load_campaign
from .needed import needed_files

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
    with tarfile.open(fileobj=io.BytesIO(data)) as archive:
        archive.extractall(folder, filter="data")
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
    with tarfile.open(fileobj=stream, mode="w:gz") as archive:
        archive.add(folder, folder.name)
    return stream.getvalue()


def unpack_folder(data: bytes, below: Path) -> None:
    """Put a packed run folder ``below``, with the permissions of files made here."""

    def member(one: tarfile.TarInfo, path: str) -> tarfile.TarInfo:
        return tarfile.data_filter(one, path).replace(mode=None)  # type: ignore[arg-type]

    with tarfile.open(fileobj=io.BytesIO(data)) as archive:
        archive.extractall(below, filter=member)


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
