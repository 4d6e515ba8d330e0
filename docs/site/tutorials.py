"""Tutorials run for the site: each notebook in an empty folder, its outputs on its page.

The notebooks in the repository have no outputs. What they write does not get into ``docs``.
"""

from __future__ import annotations

from pathlib import Path
from tempfile import TemporaryDirectory

import nbformat
from jupyter_client.manager import AsyncKernelManager
from mkdocs.config.defaults import MkDocsConfig
from mkdocs.plugins import event_priority
from mkdocs.structure.files import Files
from nbclient import NotebookClient

EXECUTED = Path("build/tutorials")
SECONDS_PER_CELL = 300


@event_priority(-100)  # after mkdocs-jupyter, whose own kind of file forgets an earlier path
def on_files(files: Files, config: MkDocsConfig) -> Files:
    """Put the executed notebook in the place of each."""
    EXECUTED.mkdir(parents=True, exist_ok=True)
    for file in files:
        if file.src_uri.endswith(".ipynb"):
            book = executed(Path(str(file.abs_src_path)))
            file.abs_src_path = str((EXECUTED / file.name).with_suffix(".ipynb").resolve())
            nbformat.write(book, file.abs_src_path)
    return files


def executed(path: Path) -> nbformat.NotebookNode:
    """Return a notebook with its outputs. Raises CellExecutionError where a cell fails."""
    book = nbformat.read(path, 4)
    with TemporaryDirectory() as folder, TemporaryDirectory() as sockets:
        # By sockets in a folder: no port is opened.
        kernel = AsyncKernelManager(kernel_name="python3", transport="ipc", ip=f"{sockets}/k")
        resources = {"metadata": {"path": folder}}
        NotebookClient(book, km=kernel, timeout=SECONDS_PER_CELL, resources=resources).execute()
    return book
