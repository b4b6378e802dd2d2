"""Files of shapes. None of these costs more than the one mesh."""

from ospace.urdf.lint.rules.rule import Rule

MESH_FILES = (
    Rule(
        name="mesh-missing",
        severity="warning",
        summary="The file of a mesh is not there, or <mesh> has no filename.",
        reason="Its shape cannot be drawn; dynamics do not need it.",
        remedy="Correct the name, or give the folder that holds its package: package_dirs=[DIR].",
        example='<mesh filename="no_such.stl"/>',
    ),
    Rule(
        name="mesh-unreadable",
        severity="warning",
        summary="The file of a mesh is not a regular file, is empty or cut off, has no triangles, is of an unknown "
        "format, or may not be read.",
        reason="Its shape cannot be drawn; dynamics do not need it.",
        remedy="Export the mesh again: as STL, OBJ, DAE, PLY, glTF or OFF.",
        example="an STL of 40 bytes",
    ),
    Rule(
        name="mesh-outside",
        severity="warning",
        summary="A mesh lies outside the package of the URDF and the folders given. It is not opened. The package is "
        "the nearest folder upward with a package.xml, else the folder above that of the file.",
        reason="A file must not make a program read what it was not given.",
        remedy="Give its folder: package_dirs=[DIR].",
        example='<mesh filename="../../../etc/passwd"/>',
    ),
    Rule(
        name="mesh-remote",
        severity="warning",
        summary="A mesh is named by an address on a network, or by a scheme that is not known. It is not fetched.",
        reason="Reading a robot never uses the network.",
        remedy="Download it and name the file.",
        example='<mesh filename="https://example.org/arm.stl"/>',
    ),
    Rule(
        name="mesh-scale",
        severity="warning",
        summary="The scale of a mesh has a zero, or as an info a negative number, which mirrors it.",
        reason="A scale of zero flattens the shape; one that mirrors turns its faces inside out in some viewers.",
        remedy="Give positive numbers; mirror the mesh itself where a viewer shows nothing.",
        example='<mesh filename="arm.stl" scale="1 0 1"/>',
    ),
    Rule(
        name="mesh-not-looked-up",
        severity="info",
        summary="Meshes are named by package://, the file lies in no package of that name, and no folder was given to "
        "look them up in; or there are more than 1000 of them.",
        reason="Whether they exist is not known; dynamics do not need them.",
        remedy="Give the folder that holds the packages: package_dirs=[DIR].",
        example='<mesh filename="package://arm_description/meshes/arm.stl"/>',
    ),
)
