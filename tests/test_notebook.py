"""The example notebook runs from its first cell to its last, and a broken cell is an error."""

from __future__ import annotations

import os
from pathlib import Path

import ezdxf
import nbformat
import pytest
from nbclient import NotebookClient
from nbclient.exceptions import CellExecutionError
from nbformat import NotebookNode
from support.places import ROOT

NOTEBOOK = ROOT / "docs" / "example.ipynb"


def run(notebook: NotebookNode, folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Run all cells in a folder, in a kernel of this Python, with foldcut from where the tests have it."""
    paths = [str(ROOT), os.environ.get("PYTHONPATH", "")]
    monkeypatch.setenv("PYTHONPATH", os.pathsep.join(filter(None, paths)))
    monkeypatch.setenv("IPYTHONDIR", str(folder / "ipython"))
    monkeypatch.setenv("JUPYTER_PLATFORM_DIRS", "1")
    client = NotebookClient(notebook, timeout=300, kernel_name="python3", resources={"metadata": {"path": str(folder)}})
    client.execute()


# zmq and the loops of asyncio leave warnings about themselves
@pytest.mark.filterwarnings("default")
def test_the_notebook_runs_shows_the_result_and_writes_a_dxf(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    notebook = nbformat.read(NOTEBOOK, as_version=4)
    run(notebook, tmp_path, monkeypatch)
    outputs = [output for cell in notebook.cells for output in cell.get("outputs", [])]
    assert not [output for output in outputs if output.output_type == "error"]
    shown = [kind for output in outputs for kind in output.get("data", {})]
    assert "text/html" in shown
    assert "image/svg+xml" in shown
    assert {layer.dxf.name for layer in ezdxf.readfile(tmp_path / "tree.dxf").layers} >= {"CUT"}
    assert (tmp_path / "tree-guide.pdf").read_bytes().startswith(b"%PDF")


@pytest.mark.filterwarnings("default")
def test_a_broken_cell_is_an_error(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    notebook = nbformat.read(NOTEBOOK, as_version=4)
    notebook.cells = [nbformat.v4.new_code_cell('import foldcut\nfoldcut.fold("no-such-file.svg")')]
    with pytest.raises(CellExecutionError, match=r"no-such-file\.svg"):
        run(notebook, tmp_path, monkeypatch)


def test_the_notebook_is_stored_with_what_its_cells_show_but_for_the_large_page() -> None:
    notebook = nbformat.read(NOTEBOOK, as_version=4)
    nbformat.validate(notebook)
    code = [cell for cell in notebook.cells if cell.cell_type == "code"]
    assert len(code) >= 5
    assert [cell.execution_count for cell in code] == list(range(1, len(code) + 1))
    outputs = [output for cell in code for output in cell.outputs]
    assert all(cell.outputs for cell in code)
    assert not [output for output in outputs if output.output_type == "error" or "text/html" in output.get("data", {})]
    assert [output for output in outputs if "image/svg+xml" in output.get("data", {})]
    assert ", verified>" in code[0].outputs[0].text
    assert NOTEBOOK.stat().st_size < 200_000
