"""Docstrings, stubs, documents."""

import doctest
import inspect
import json
import os
import re
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path

import dapple
import numpy as np
import pytest
from dapple import _native, _options

ROOT = Path(__file__).resolve().parents[2]


def public_objects() -> Iterator[tuple[str, object]]:
    """Everything that callers see, with what classes of the package define themselves."""
    yield "dapple", dapple
    for name in dapple.__all__:
        thing = getattr(dapple, name)
        if name.startswith("_"):
            continue
        yield name, thing
        if inspect.isclass(thing):
            for key, member in vars(thing).items():
                if not key.startswith("_") and (callable(member) or isinstance(member, (property, classmethod))):
                    yield f"{name}.{key}", getattr(member, "__func__", member)


@pytest.mark.parametrize(("name", "thing"), [pytest.param(*x, id=x[0]) for x in public_objects()])
def test_docstring_examples_are_true(
    name: str, thing: object, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    if name.endswith("to_xarray"):
        pytest.importorskip("xarray")
    monkeypatch.chdir(tmp_path)
    text = inspect.getdoc(thing) or ""
    test = doctest.DocTestParser().get_doctest(text, {"dapple": dapple, "np": np}, name, None, 0)
    assert test.examples, f"{name} has no example"
    report: list[str] = []
    doctest.DocTestRunner(optionflags=doctest.ELLIPSIS).run(test, out=report.append)
    assert not report, "".join(report)


def test_type_hints_name_every_option() -> None:
    """The typed keyword arguments are the engine's, but for those that have arguments of their own."""
    separate = {"period_x", "period_z"}
    for hints, engine in (
        (_options.OcclusionOptions, _native.OcclusionOptions),
        (_options.QueryOptions, _native.IrradianceOptions),
        (_options.MeasureOptions, _native.PointOptions),
        (_options.RenderOptions, _native.RenderOptions),
        (_options.BakeOptions, _native.BakeOptions),
    ):
        names = {n.removeprefix("set_") for n in dir(engine) if not n.startswith("_")}
        assert hints.__optional_keys__ == names - separate


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
