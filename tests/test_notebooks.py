"""Every notebook runs from top to bottom, and is kept without its outputs."""

from __future__ import annotations

from pathlib import Path

import nbformat
import pytest
from nbclient import NotebookClient
from nbformat import NotebookNode

NOTEBOOKS = sorted((Path(__file__).parents[1] / "notebooks").glob("*.ipynb"))


def executed(path: Path, folder: Path, *more: str) -> NotebookNode:
    """The notebook after all its cells, and some more, have run; an error in one raises."""
    notebook = nbformat.read(path, as_version=4)
    notebook.cells += [nbformat.v4.new_code_cell(source) for source in more]
    client = NotebookClient(notebook, timeout=300, resources={"metadata": {"path": str(folder)}})
    client.execute()
    return notebook


def mime_types(notebook: NotebookNode) -> list[str]:
    outputs = [output for cell in notebook.cells for output in cell.get("outputs", [])]
    return [kind for output in outputs for kind in output.get("data", {})]


@pytest.mark.parametrize("path", NOTEBOOKS, ids=lambda path: path.name)
def test_kept_without_outputs(path: Path) -> None:
    notebook = nbformat.read(path, as_version=4)
    nbformat.validate(notebook)
    assert set(notebook.metadata) == {"kernelspec", "language_info"}
    for cell in notebook.cells:
        assert not cell.metadata
        if cell.cell_type == "code":
            assert cell.outputs == []
            assert cell.execution_count is None


def test_the_serve_is_learned(tmp_path: Path) -> None:
    (path,) = (path for path in NOTEBOOKS if path.name == "01_serve.ipynb")
    notebook = executed(
        path, tmp_path, "print('learned at', learner.learned_at, 'of', len(records))"
    )
    outputs = [output for cell in notebook.cells for output in cell.get("outputs", [])]
    text = "".join(o.text for o in outputs if o.output_type == "stream" and o.name == "stdout")
    learned, trials = text.rsplit("learned at ", 1)[1].split(" of ")
    assert 3 < int(learned) <= int(trials) <= 60
    assert text.count("\ntrial ") + text.startswith("trial ") == int(trials)
    errors = [o.text for o in outputs if o.output_type == "stream" and o.name == "stderr"]
    assert errors == [], "no warnings"
    kinds = mime_types(notebook)
    assert kinds.count("image/png") == 7
    assert ("image/svg+xml" in kinds) or "Graphviz is not installed" in text
    pages = [o.data["text/html"] for o in outputs if "text/html" in o.get("data", {})]
    assert sum("srcdoc" in page for page in pages) == 1
    assert list(tmp_path.iterdir()) == [], "nothing is written"
