"""The installed stubs have the docstrings of the compiled module, which editors show."""

import ast
import importlib
import inspect
from pathlib import Path

import pytest

import kinopt

PACKAGE = Path(kinopt.__file__).parent
STUBS = PACKAGE / "_kinopt"


def definitions(stub):
    """Classes, functions and members of a stub file, with their names from the module on."""
    for node in ast.parse(stub.read_text(encoding="utf-8")).body:
        if isinstance(node, (ast.ClassDef, ast.FunctionDef)):
            yield node.name, node
        for member in node.body if isinstance(node, ast.ClassDef) else []:
            if isinstance(member, ast.FunctionDef):
                yield f"{node.name}.{member.name}", member


@pytest.mark.skipif(not STUBS.exists() and (PACKAGE.parent / "Cargo.toml").exists(), reason="sources, not a package")
def test_stubs_have_the_docstrings_of_the_module():
    compared = 0
    for name in ("__init__", "animation", "io", "retargeting", "skinning", "tasks"):
        stub = STUBS / f"{name}.pyi"
        module = importlib.import_module(f"kinopt._kinopt.{name}".removesuffix(".__init__"))
        documented = {}
        for path, node in definitions(stub):
            documented[path] = documented.get(path) or ast.get_docstring(node)
        for path, docstring in documented.items():
            owner, _, member = path.rpartition(".")
            if member.startswith("_"):
                continue
            thing = getattr(getattr(module, owner) if owner else module, member)
            assert docstring == inspect.getdoc(thing) and docstring, f"{stub.name}: {path}"
            compared += 1
    assert compared > 700
