"""The notebooks of the examples run, and print what the committed ones show."""

from __future__ import annotations

from pathlib import Path

import nbformat
import pytest

import notebooks


@pytest.mark.parametrize("path", sorted(notebooks.FOLDER.glob("*.ipynb")), ids=lambda path: path.stem)
def test_a_notebook_prints_what_it_shows(path: Path) -> None:
    shown = nbformat.read(path, as_version=4)
    found = notebooks.executed(path)
    assert notebooks.printed(found) == notebooks.printed(shown), "python python/tests/notebooks.py writes them again"
    pictures = [sum("image/png" in output.get("data", {}) for cell in notebook.cells for output in cell.get("outputs", [])) for notebook in (shown, found)]
    assert pictures[0] == pictures[1] > 0


def test_there_are_notebooks() -> None:
    assert {path.stem for path in notebooks.FOLDER.glob("*.ipynb")} == {"hardware", "printer", "shapers"}
