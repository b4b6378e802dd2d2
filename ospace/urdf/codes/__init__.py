"""Every kind of finding: code, severity, reason and remedy; the one source of ``--explain`` and of docs/findings.md."""

from ospace.urdf.codes.code import Code, Severity
from ospace.urdf.codes.dynamics import DYNAMICS
from ospace.urdf.codes.inertias import INERTIAS
from ospace.urdf.codes.joints import JOINTS
from ospace.urdf.codes.meshes import MESHES
from ospace.urdf.codes.plausibility import PLAUSIBILITY
from ospace.urdf.codes.unreadable import FILES, STRUCTURE
from ospace.urdf.codes.values import VALUES

GROUPS = {
    "Files": FILES,
    "Structure": STRUCTURE,
    "Elements and numbers": VALUES,
    "Inertia": INERTIAS,
    "Joints and base": JOINTS,
    "Plausibility": PLAUSIBILITY,
    "Meshes": MESHES,
    "Dynamics": DYNAMICS,
}
CODES = {code.name: code for group in GROUPS.values() for code in group}

__all__ = ["CODES", "GROUPS", "Code", "Severity"]
