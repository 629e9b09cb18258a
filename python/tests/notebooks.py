"""Execute the notebooks of the examples: ``python python/tests/notebooks.py`` writes their outputs and pictures again."""

from __future__ import annotations

from pathlib import Path
from typing import Any, List

import nbformat
from nbclient import NotebookClient

FOLDER = Path(__file__).parents[2] / "examples" / "notebooks"
#: Longest time of a cell in s; the longest one simulates Verilog.
TIMEOUT_S = 300


def executed(path: Path) -> Any:
    """Return the notebook with the outputs of a new run in its folder.

    Raises
    ------
    nbclient.exceptions.CellExecutionError
        If a cell raises an exception.
    """
    notebook = nbformat.read(path, as_version=4)
    NotebookClient(notebook, timeout=TIMEOUT_S, record_timing=False, resources={"metadata": {"path": str(FOLDER)}}).execute()
    # The version of this Python would change the file at each update.
    notebook.metadata.language_info = {"name": "python"}
    return notebook


def printed(notebook: Any) -> List[str]:
    """Return what each cell of code prints, without pictures and warnings."""
    cells = [cell for cell in notebook.cells if cell.cell_type == "code"]
    return ["".join(output.text for output in cell.outputs if output.get("name") == "stdout") for cell in cells]


if __name__ == "__main__":
    for path in sorted(FOLDER.glob("*.ipynb")):
        print(path.name)
        nbformat.write(executed(path), path)
