"""The tutorials: notebooks that run as they stand, and show plots."""

from __future__ import annotations

import asyncio
from pathlib import Path

import nbformat
import pytest
from jupyter_client.manager import AsyncKernelManager
from nbclient import NotebookClient

TUTORIALS = sorted((Path(__file__).parents[2] / "docs" / "tutorials").glob("*.ipynb"))
PLOTS = {"1-landing": 2, "2-own-hull": 1, "3-sweep": 1, "4-fmu": 1}
SHOWN = {
    "1-landing": "BROKEN roll stays below 10 degrees",
    "2-own-hull": "holds  it stops by itself",
    "3-sweep": "hydrone-open-landing, pad [0.0, 0.1, -0.2]    True",
    "4-fmu": "Steering.fmu",
}


def test_they_are_all_known() -> None:
    assert [path.stem for path in TUTORIALS] == list(PLOTS) == list(SHOWN)


@pytest.mark.parametrize("path", TUTORIALS, ids=lambda path: path.stem)
def test_they_are_kept_without_outputs(path: Path) -> None:
    """Outputs change with every run, and nobody would compare them."""
    book = nbformat.read(path, 4)
    nbformat.validate(book)
    code = [cell for cell in book.cells if cell.cell_type == "code"]
    assert not any(cell.outputs or cell.execution_count for cell in code)


@pytest.mark.interop
@pytest.mark.parametrize("path", TUTORIALS, ids=lambda path: path.stem)
def test_they_run(path: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    for variable in ("IPYTHONDIR", "MPLCONFIGDIR", "JUPYTER_CONFIG_DIR", "JUPYTER_RUNTIME_DIR"):
        monkeypatch.setenv(variable, str(tmp_path / variable))
    folder = tmp_path / "tutorial"
    folder.mkdir()
    book = nbformat.read(path, 4)
    # By sockets in a folder: no port is opened.
    kernel = AsyncKernelManager(kernel_name="python3", transport="ipc", ip=str(tmp_path / "k"))
    client = NotebookClient(
        book, km=kernel, timeout=300, resources={"metadata": {"path": str(folder)}}
    )
    asyncio.run(client.async_execute())
    outputs = [output for cell in book.cells for output in cell.get("outputs", [])]
    data = [output.get("data", {}) for output in outputs]
    assert sum("image/png" in shown for shown in data) == PLOTS[path.stem]
    text = "".join(o.get("text", "") for o in outputs) + "".join(
        shown.get("text/plain", "") for shown in data
    )
    assert SHOWN[path.stem] in text
    assert not [output for output in outputs if output.get("name") == "stderr"]
