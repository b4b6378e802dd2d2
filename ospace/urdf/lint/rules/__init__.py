"""Every kind of finding: code, severity, reason and remedy; the one source of ``--explain`` and of docs/findings.md."""

from ospace.urdf.lint.rules.elements_and_numbers import ELEMENTS_AND_NUMBERS
from ospace.urdf.lint.rules.inertias import INERTIAS
from ospace.urdf.lint.rules.joints_and_base import JOINTS_AND_BASE
from ospace.urdf.lint.rules.magnitudes import MAGNITUDES
from ospace.urdf.lint.rules.mesh_files import MESH_FILES
from ospace.urdf.lint.rules.refusals import FILES, STRUCTURE
from ospace.urdf.lint.rules.rule import Rule, Severity
from ospace.urdf.lint.rules.sampled_states import SAMPLED_STATES

GROUPS = {
    "Files": FILES,
    "Structure": STRUCTURE,
    "Elements and numbers": ELEMENTS_AND_NUMBERS,
    "Inertia": INERTIAS,
    "Joints and base": JOINTS_AND_BASE,
    "Plausibility": MAGNITUDES,
    "Meshes": MESH_FILES,
    "Dynamics": SAMPLED_STATES,
}
RULES = {code.name: code for group in GROUPS.values() for code in group}

__all__ = ["GROUPS", "RULES", "Rule", "Severity"]
