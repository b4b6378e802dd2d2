"""Reasons to refuse a file as a whole: it is not a URDF, or its links do not form a tree."""

from functools import partial

from ospace.urdf.lint.rules.rule import Rule

_refused = partial(Rule, severity="error", unreadable=True)

FILES = (
    _refused(
        name="no-file",
        summary="There is no file of that name.",
        reason="Nothing can be read.",
        remedy="Give the path of a URDF file, or the name of a robot that comes with ospace.",
        example="ospace check no_such.urdf",
    ),
    _refused(
        name="no-regular-file",
        summary="The path is a folder, a FIFO, a socket or a device.",
        reason="Reading a FIFO or a device may wait for ever, or never end.",
        remedy="Give a regular file.",
        example="ospace check /dev/zero",
    ),
    _refused(
        name="unreadable-file",
        summary="The operating system does not let the file be read.",
        reason="Nothing can be read.",
        remedy="Look at its permissions, and at the disk.",
        example="chmod 0 robot.urdf",
    ),
    _refused(
        name="too-large",
        summary="The file has more bytes than are read: 20,000,000 by default.",
        reason="A URDF of thousands of links has some megabytes; more is a mistake, or meant to exhaust memory.",
        remedy="Take meshes and logs out of the file, or raise the limit: limits=Limits(bytes=N).",
        example="a URDF with a 100 MB comment",
    ),
    _refused(
        name="not-text",
        summary="The file is not text: compressed, binary, with a NUL byte; or not in the encoding that it declares, "
        "UTF-8 where it declares none; or it declares one that is not read.",
        reason="A letter read as another gives a link another name, and a byte that is skipped may be a digit.",
        remedy="Decompress it, declare its encoding, as <?xml version='1.0' encoding='ISO-8859-1'?>, or convert it: "
        "iconv -f UTF-32 -t UTF-8 in.urdf > out.urdf. A byte order mark may stay.",
        example="robot.urdf.gz",
    ),
    _refused(
        name="doctype",
        summary="The file has a document type declaration.",
        reason="URDF has none; its entities can expand one kilobyte into gigabytes, or include other files.",
        remedy="Remove the <!DOCTYPE …> declaration.",
        example="<!DOCTYPE robot [<!ENTITY mass '2'>]>",
    ),
    _refused(
        name="not-xml",
        summary="The file is not well-formed XML.",
        reason="What a reader makes of it depends on the reader.",
        remedy="Correct it at the line named; a file that ends too early was not written to its end.",
        example='<robot name="r"><link name="base">',
    ),
    _refused(
        name="too-deep",
        summary="XML elements are nested more than 100 deep.",
        reason="A URDF needs six levels; a hundred thousand overflow the stack of a reader.",
        remedy="Look for an element that is not closed, or raise the limit: limits=Limits(depth=N).",
        example="<a><a><a>…",
    ),
    _refused(
        name="too-many-attributes",
        summary="An element has more than 64 attributes.",
        reason="The richest element of URDF has six.",
        remedy="Remove what is not URDF, or raise the limit: limits=Limits(attributes=N).",
        example='<link name="base" a0="" a1="" a2="" …/>',
    ),
    _refused(
        name="too-long-attribute",
        summary="An attribute has more than 10,000 characters.",
        reason="No name or number is that long.",
        remedy="Remove what is not URDF, or raise the limit: limits=Limits(text=N).",
        example='<link name="aaaaaaaa…"/>',
    ),
    _refused(
        name="too-many-nodes",
        summary="The file has more than 200,000 elements, attributes and comments.",
        reason="Each costs some hundred bytes of memory, whatever it holds.",
        remedy="Remove what is not URDF, or raise the limit: limits=Limits(nodes=N).",
        example="<a/><a/><a/>…",
    ),
    _refused(
        name="not-urdf",
        summary="The root element is not <robot>: SDF, MJCF, HTML, COLLADA or something else.",
        reason="Nothing of it can be read as a robot.",
        remedy="Give a URDF; SDF and MJCF have converters.",
        example='<sdf version="1.6"><model name="m"/></sdf>',
    ),
    _refused(
        name="xacro",
        summary="A xacro is left to be expanded: an element of xacro, or ${…} or $(…) in an attribute, where links, "
        "joints or inertials could come of it.",
        reason="Links and numbers are still to be computed.",
        remedy="Expand it with its macros, as is done where the name ends in .xacro; or delete what is left over.",
        example='<mass value="${m}"/>',
    ),
    _refused(
        name="xacro-failed",
        summary="A xacro cannot be expanded: a macro, argument, property or file that is not there, or an expression "
        "that cannot be computed.",
        reason="Links and numbers are computed by its macros.",
        remedy="As the message says. Arguments are given as name:=value, or from_urdf(…, xacro_args={'name': '1'}).",
        example="<xacro:no_such_macro/>",
    ),
    _refused(
        name="xacro-package",
        summary="$(find package) of a xacro names a package that is not in the folders given.",
        reason="Macros and numbers lie in it. No list of installed packages is looked at.",
        remedy="Give the folder that holds the package: package_dirs=[DIR].",
        example='<xacro:include filename="$(find gripper_description)/urdf/gripper.xacro"/>',
    ),
    _refused(
        name="xacro-outside",
        summary="A xacro reads a file outside its own package and the folders given, or does what no robot needs, as "
        "writing a file or starting a program.",
        reason="The expressions of a xacro are Python: who sends one could read or change anything.",
        remedy="Give the folder with package_dirs=[DIR] where the file may read it; else look at what the file wants.",
        example="${xacro.load_yaml('/etc/passwd')}",
    ),
    _refused(
        name="xacro-exhausted",
        summary="Expanding a xacro takes more than 30 s, 1 GB or the bytes of a file, or its macros call themselves "
        "without end.",
        reason="The largest robots take seconds and some ten megabytes; a macro that doubles itself takes all.",
        remedy="Look for a macro that calls itself, or raise the limit: limits=Limits(seconds=N), "
        "limits=Limits(memory=N).",
        example='<xacro:macro name="m"><xacro:m/></xacro:macro><xacro:m/>',
    ),
    _refused(
        name="second-robot",
        summary="A <robot> stands inside <robot>.",
        reason="Which of the two is meant is ambiguous; readers ignore the inner one.",
        remedy="Keep one robot a file.",
        example='<robot name="a"><robot name="b"/></robot>',
    ),
)

STRUCTURE = (
    _refused(
        name="no-links",
        summary="<robot> has no <link>.",
        reason="A robot needs at least its base.",
        remedy="Give it a link with an <inertial>.",
        example='<robot name="r"/>',
    ),
    _refused(
        name="too-many-links",
        summary="The robot has more than 2000 links, or a chain of more than 2000 joints.",
        reason="Readers go down the tree by recursion, and their stack ends near 3,700 links.",
        remedy="Merge links that are fixed to each other, or raise the limit: limits=Limits(links=N). The "
        "length of a chain cannot be raised.",
        example='<link name="l0"/><link name="l1"/>…<link name="l2000"/>',
    ),
    _refused(
        name="too-many-dof",
        summary="The robot has more than 150 degrees of freedom, the base's six included.",
        reason="Pinocchio's working memory takes 64 nv³ bytes: 216 MB at 150, 64 GB at 1000. What the memory of the "
        "machine cannot hold is refused whatever the limit.",
        remedy="Fix joints that do not matter, or raise the limit: limits=Limits(dof=N).",
        example="150 links in a chain of revolute joints",
    ),
    _refused(
        name="unnamed",
        summary="A link or joint has no name.",
        reason="Joints name their links, and results name joints.",
        remedy="Give it a name that no other of its kind has.",
        example="<link/>",
    ),
    _refused(
        name="duplicate-name",
        summary="Two links, or two joints, have the same name.",
        reason="Which one a joint means is ambiguous.",
        remedy="Rename one of them.",
        example='<link name="arm"/><link name="arm"/>',
    ),
    _refused(
        name="joint-ends",
        summary="A joint has no <parent link=…> or no <child link=…>.",
        reason="It joins nothing.",
        remedy="Name both links.",
        example='<joint name="hinge" type="fixed"><parent link="base"/></joint>',
    ),
    _refused(
        name="unknown-link",
        summary="A joint names a link that does not exist.",
        reason="It joins nothing.",
        remedy="Correct the name, or add the link.",
        example='<child link="amr"/>',
    ),
    _refused(
        name="second-parent",
        summary="A link is the child of two joints of the same parent.",
        reason="Which of the two is meant is ambiguous. Pinocchio's reader keeps one and says nothing of the other.",
        remedy="Remove one of the two joints. Joints of different parents close a loop, which is read (loop-open).",
        example='two joints from "base" to "arm"',
    ),
    _refused(
        name="loop",
        summary="Links hang from themselves, and from no root.",
        reason="A URDF is a tree. Pinocchio's reader leaves such links out, or never comes back.",
        remedy="Cut the loop at one joint, or choose the base: root='LINK'.",
        example="a is the parent of b, and b of a",
    ),
    _refused(
        name="two-roots",
        summary="More than one link is the child of no joint, or only of one that is not read, as <drake:joint>.",
        reason="The base would be one of them, and the mass of what hangs from the other would be lost.",
        remedy="Join the others to the tree, by a fixed joint where nothing moves; or read one alone: root='LINK'.",
        example='<link name="base"/><link name="forgotten"/>',
    ),
    _refused(
        name="several-bodies",
        summary="Several bodies float freely, each on a floating joint of one link without mass.",
        reason="A robot has one base. The others would be bodies of their own, as a target is.",
        remedy="Read each alone: root='LINK'.",
        example="chaser and target, each on a floating joint of 'world'",
    ),
    _refused(
        name="planar-base",
        summary="The robot slides on a planar joint of a link without mass: its base moves in a plane.",
        reason="The base of ospace floats freely, with six degrees of freedom.",
        remedy="Make the joint floating: a motion that begins in the plane stays in it. Or read what hangs from it: "
        "root='LINK'.",
        example='<joint name="table" type="planar"><parent link="world"/><child link="bus"/></joint>',
    ),
    _refused(
        name="rejected",
        summary="Pinocchio builds no model of what was read.",
        reason="Its message says why.",
        remedy="As the message says; please report it, as ospace means to find the reason first.",
        example="none is known",
    ),
    _refused(
        name="parity",
        summary="Pinocchio's model is not what the file says: a mass, centre, inertia, joint, axis or limit differs.",
        reason="Every result would belong to another robot.",
        remedy="Please report it with the file: no such file is known.",
        example="none is known",
    ),
)
