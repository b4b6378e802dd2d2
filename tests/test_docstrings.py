"""Docstrings: they open with what a name does or is, and those of the public surface have their sections."""

import ast
import dataclasses
import importlib
import inspect
import re
import textwrap
from pathlib import Path

import pytest

import ospace

PACKAGE = Path(ospace.__file__).parent
SURFACE = ("ospace", "ospace.models", "ospace.analysis", "ospace.control", "ospace.simulation", "ospace.scenario")
SURFACE += (
    "ospace.bridge.mujoco",
    "ospace.bridge.drake",
    "ospace.bridge.spart",
    "ospace.scenario.log",
    "ospace.urdf.composition",
    "ospace.visual",
)
OPENS_WRONG = re.compile(r"(What|How|Where|Whether|Which|Why|When|Who)\b")


def documented():
    """Yield each docstring of the package, by its place."""
    for file in sorted(PACKAGE.rglob("*.py")):
        path = file.relative_to(PACKAGE)
        for node in ast.walk(ast.parse(file.read_text())):
            if isinstance(node, (ast.Module, ast.FunctionDef, ast.ClassDef)) and ast.get_docstring(node):
                yield f"{path}:{getattr(node, 'name', '')}", ast.get_docstring(node)


def surface():
    """Yield the functions, classes and methods that users call, by their names."""
    seen = set()
    for module in map(importlib.import_module, SURFACE):
        names = getattr(module, "__all__", None) or [name for name in vars(module) if name[0] != "_"]
        for name in names:
            value = getattr(module, name)
            home = getattr(value, "__module__", "")
            if home.startswith("ospace" if hasattr(module, "__all__") else module.__name__) and id(value) not in seen:
                seen.add(id(value))
                yield f"{module.__name__}.{name}", value
                if inspect.isclass(value):
                    yield from methods(f"{module.__name__}.{name}", value)


def methods(owner, cls):
    for name, value in vars(cls).items():
        if isinstance(value, (classmethod, staticmethod)):
            value = value.__func__
        overrides = any(hasattr(base, name) for base in cls.__mro__[1:])  # it does what the base says
        if name[0] != "_" and inspect.isfunction(value) and not overrides:
            yield f"{owner}.{name}", value


def raises(function):
    """Return whether a function's own body raises an error of ospace."""
    tree = ast.parse(textwrap.dedent(inspect.getsource(function)))
    for node in ast.walk(tree):
        if isinstance(node, ast.Raise) and isinstance(node.exc, ast.Call) and isinstance(node.exc.func, ast.Name):
            error = function.__globals__.get(node.exc.func.id, Exception)
            if inspect.isclass(error) and issubclass(error, ospace.OspaceError):
                return True
    return False


def missing(value):
    """Return the sections that the docstring of a function or class lacks."""
    text = inspect.getdoc(value) or ""
    sections = set(re.findall(r"^(\w+)\n-+$", text, re.MULTILINE))
    if inspect.isclass(value):
        if issubclass(value, Exception):
            return set()
        own = [value.__dict__[name] for name in ("__init__", "__post_init__") if name in value.__dict__]
        own = [one for one in own if one.__module__ == value.__module__ and one.__code__.co_filename[0] != "<"]
        takes = any(len(inspect.signature(one).parameters) > 1 for one in own)
        if dataclasses.is_dataclass(value):
            takes = bool(inspect.get_annotations(value))
        needed = set() if not takes or sections & {"Parameters", "Attributes"} else {"Parameters"}
        return needed | ({"Raises"} - sections if any(map(raises, own)) else set())
    signature = inspect.signature(value)
    needed = {"Parameters"} if set(signature.parameters) - {"self", "cls"} else set()
    if signature.return_annotation not in ("None", None, "Never"):
        needed |= {"Yields"} if inspect.isgeneratorfunction(value) else {"Returns"}
    return (needed | ({"Raises"} if raises(value) else set())) - sections


PUBLIC = {name: value for name, value in surface() if not name.startswith("ospace.scenario.schema")}


def test_the_public_surface_is_found():
    assert len(PUBLIC) > 80
    assert {"ospace.SpaceRobot.from_urdf", "ospace.simulate", "ospace.control.PoseTask"} <= set(PUBLIC)


def test_docstrings_open_with_a_verb_or_a_noun():
    assert {place: text.splitlines()[0] for place, text in documented() if OPENS_WRONG.match(text)} == {}


@pytest.mark.parametrize("name", PUBLIC)
def test_a_public_name_has_its_sections(name):
    value = PUBLIC[name]
    assert inspect.getdoc(value), name
    assert missing(value) == set()
