"""Docstrings, stubs, documents."""

import doctest
import inspect
import json
import os
import re
import subprocess
import sys
from pathlib import Path

import dapple
import pytest

ROOT = Path(__file__).resolve().parents[2]


def test_docstring_examples_are_true() -> None:
    found = doctest.testmod(dapple)
    assert found.attempted > 0 and found.failed == 0


def test_everything_public_has_a_docstring() -> None:
    for name in dapple.__all__:
        thing = getattr(dapple, name)
        if inspect.isclass(thing) or inspect.isfunction(thing):
            assert thing.__doc__, name
    for name, member in inspect.getmembers(dapple.Scene, inspect.isfunction):
        assert name.startswith("_") or member.__doc__, name


def test_types_are_right() -> None:
    pytest.importorskip("mypy")
    found = subprocess.run(
        [sys.executable, "-m", "mypy", "--strict", "--cache-dir", os.devnull, "-p", "dapple"],
        capture_output=True,
        text=True,
        check=False,
    )
    assert found.returncode == 0, found.stdout


def test_the_documents_examples_run(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    text = (ROOT / "docs" / "python.md").read_text(encoding="utf-8")
    examples = re.findall(r"```python\n(.*?)```", text, re.DOTALL)
    assert examples
    for example in examples:
        exec(compile(example, "docs/python.md", "exec"), {})
    assert (tmp_path / "tree.exr").exists()


@pytest.mark.parametrize("path", sorted((ROOT / "docs" / "notebooks").glob("*.ipynb")), ids=str)
def test_notebooks_run(path: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    matplotlib = pytest.importorskip("matplotlib")
    matplotlib.use("Agg")
    monkeypatch.chdir(tmp_path)
    names: dict[str, object] = {}
    for cell in json.loads(path.read_text(encoding="utf-8"))["cells"]:
        if cell["cell_type"] == "code":
            source = "".join(cell["source"])
            exec(compile(source, path.name, "exec"), names)
