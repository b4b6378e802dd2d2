"""Files that may import only what is named here; the layers are contracts of import-linter in pyproject.toml."""

from pathlib import Path

import pytest
from imports import imports_of

OSPACE = Path(__file__).parents[1] / "ospace"
ORACLE = OSPACE / "dynamics" / "dense.py"
OF_THE_ORACLE = (
    *("__future__", "collections.abc", "functools", "numpy", "pinocchio"),
    *("ospace.checks", "ospace.exceptions", "ospace.kernels.tree", "ospace.model.points", "ospace.model.state"),
)
"""No module with a recursion in it; `tree` holds types."""
KERNELS = sorted(file for file in (OSPACE / "kernels").rglob("*.py") if file.parent.name != "jit")
OF_KERNELS = ("__future__", "collections.abc", "math", "numba", "numpy", "typing", "ospace.kernels")
"""Arrays and numbers: no Pinocchio, no file."""


def imported_beside(allowed, file):
    """Return what a file imports that is not allowed, nor in a package that is."""
    return [
        f"{module} {name}".strip()
        for module, name in imports_of(file)
        if not any(f"{module}.{name}.".startswith(f"{one}.") for one in allowed)
    ]


def test_the_oracle_imports_pinocchio_and_the_state_alone():
    assert imported_beside(OF_THE_ORACLE, ORACLE) == []


@pytest.mark.parametrize("file", KERNELS, ids=lambda file: file.relative_to(OSPACE).as_posix())
def test_a_kernel_imports_numbers_and_kernels_alone(file):
    assert imported_beside(OF_KERNELS, file) == []


@pytest.mark.parametrize(
    ("text", "found"),
    [
        ("from ospace.kernels import evaluation", "ospace.kernels evaluation"),
        ("def f():\n    import ospace.kernels.batch", "ospace.kernels.batch"),
        ("from ospace.model import pinocchio_pass", "ospace.model pinocchio_pass"),
        ("from ospace.kernels.treeless import x", "ospace.kernels.treeless x"),
        ("from . import workspace", ". workspace"),
        ("import ospace", "ospace"),
        (
            "if TYPE_CHECKING:\n    from ospace.dynamics.workspace import Workspace",
            "ospace.dynamics.workspace Workspace",
        ),
    ],
)
def test_an_import_beside_those_allowed_is_found_wherever_it_stands(tmp_path, text, found):
    file = tmp_path / "one.py"
    file.write_text(text + "\nfrom ospace.kernels import tree\nimport numpy.typing as npt\n", encoding="utf-8")
    assert imported_beside(OF_THE_ORACLE, file) == [found]
