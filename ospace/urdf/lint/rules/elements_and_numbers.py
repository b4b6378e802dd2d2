"""Elements and numbers that do not say what they seem to."""

from ospace.urdf.lint.rules.rule import Rule

ELEMENTS_AND_NUMBERS = (
    Rule(
        name="number-unreadable",
        severity="error",
        summary="A number of a joint is missing or none: nan, 1e400, 0x10, '12 kg', a decimal comma, too few or too "
        "many. A warning in <safety_controller> and <calibration>, which are not used.",
        reason="A reader that guesses puts the joint, and all that hangs from it, somewhere else.",
        remedy="Write plain finite decimal numbers, as many as are due, with a point and without units.",
        example='<origin xyz="0,3 0 0"/>',
    ),
    Rule(
        name="number-spaces",
        severity="warning",
        summary="White space surrounds a number; it is read as meant. For lists of numbers an info only.",
        reason="Pinocchio's parser takes such a number for zero, or drops the element around it: a tensor or a mass "
        "disappears with nothing but a line on standard error.",
        remedy="Remove the white space.",
        example='<inertia ixx="0.010 " …/>',
        fixable=True,
    ),
    Rule(
        name="number-range",
        severity="error",
        summary="A mass, length or inertia has a size of more than 1e12, or an inertia is not zero and smaller than "
        "1e-100, or a mass than 1e-15, or a number is too small for floating point.",
        reason="Products of such numbers leave the range of floating point: inertias become infinite or lose all "
        "digits.",
        remedy="Use kg, m and kg m², and write 0 for nothing. 1e12 kg is a mountain, 1e-15 kg a bacterium.",
        example='<mass value="1e300"/>',
    ),
    Rule(
        name="two-orientations",
        severity="error",
        summary="An <origin> has both rpy and quat_xyzw.",
        reason="Which one places the body is not known; Pinocchio's parser rejects the file.",
        remedy="Keep one.",
        example='<origin rpy="0 0 0" quat_xyzw="0 0 0.6 0.8"/>',
    ),
    Rule(
        name="quaternion-not-unit",
        severity="warning",
        summary="The length of a quaternion differs from one by more than 1e-3. It is divided by its length.",
        reason="A reader that does not do so scales what it turns. Pinocchio's parser does.",
        remedy="Divide it by its length.",
        example='<origin quat_xyzw="1 0 0 1"/>',
        fixable=True,
    ),
    Rule(
        name="quaternion-ignored",
        severity="warning",
        summary="An <origin> has quat_xyzw in a file of URDF 1.0, which knows none. It is not used.",
        reason="Pinocchio's parser ignores it too, and nothing is turned.",
        remedy='Declare the version, <robot version="1.1">, or write the orientation as rpy.',
        example='<robot name="r"> and <origin quat_xyzw="0 0 0.6 0.8"/>',
    ),
    Rule(
        name="unknown-version",
        severity="warning",
        summary="<robot> declares a version other than 1.0, 1.1 and 1.2. The file is read as 1.2.",
        reason="What such a version means by its elements is not known; Pinocchio's parser rejects the file.",
        remedy="Declare the version that the file is written in.",
        example='<robot name="r" version="2.0">',
    ),
    Rule(
        name="duplicate-element",
        severity="error",
        summary="An element that may stand once stands twice, as <inertial> in a link or <origin> in a joint.",
        reason="Readers take the first or the last: half the mass, or another placement.",
        remedy="Keep one.",
        example="<link><inertial/><inertial/></link>",
    ),
    Rule(
        name="unknown-element",
        severity="warning",
        summary="An element of the robot has in it one that URDF does not know there; an info in a robot, link or "
        "joint where its name is far from any that URDF has, an error where it adds a link, joint or inertial, "
        "or includes another file. To name a link or joint, as groups of an SRDF do, adds none.",
        reason="Readers ignore it: a misspelt <inertail> leaves a link without mass, a <Link>, or one in a "
        "<group>, is not part of the robot.",
        remedy="Correct its name or its place. <gazebo>, <sensor>, <contact>, <transmission>, <ros2_control> and "
        "elements of a namespace of their own are left alone, but for what they say of dynamics (dynamics-not-used).",
        example="<inertail>…</inertail>",
    ),
    Rule(
        name="unknown-attribute",
        severity="warning",
        summary="An element has an attribute that URDF does not know there. An info where its name is far from any "
        "that URDF has and the element places, weighs, moves and limits nothing, and of iyx, izx, izy that equal "
        "ixy, ixz, iyz.",
        reason="Readers ignore it and take the default: a misspelt xyz leaves a link at its parent's origin.",
        remedy="Correct its name or its place.",
        example='<origin xzy="0 0 1"/>',
    ),
    Rule(
        name="dynamics-not-used",
        severity="warning",
        summary="An element that URDF leaves to other programs speaks of dynamics: rotor inertia in a <transmission>, "
        "a <loop_joint>, a <constraint>, a joint or damping in <gazebo>, a spring. An info for a gear's ratio alone.",
        reason="The robot is the tree of links without it, and moves otherwise than the file says. A ratio of 1 and "
        "other values of 0 change nothing, and are ignored.",
        remedy="Nothing, if it is meant so: loops stay open, rotors add no inertia, springs do not pull. A rotor's "
        "inertia times the square of its gear is model.armature of a model given to SpaceRobot.from_model.",
        example="<transmission>…<rotor_inertia value='1e-4'/>",
    ),
    Rule(
        name="stray-text",
        severity="warning",
        summary="Text stands in an element; URDF has all that it says in attributes.",
        reason="Readers ignore it and take the default: <origin>0 0 1</origin> moves nothing.",
        remedy="Write it as an attribute, as in <origin xyz='0 0 1'/>, or as a comment.",
        example="<origin>0 0 1</origin>",
    ),
    Rule(
        name="visual-unreadable",
        severity="warning",
        summary="A <visual>, <collision> or <material> cannot be read.",
        reason="It is left out. Dynamics do not need it, but inertias are then not compared with the shape.",
        remedy="Write plain finite numbers.",
        example='<color rgba="red"/>',
    ),
    Rule(
        name="no-robot-name",
        severity="warning",
        summary="<robot> has no name; the robot is called as its file.",
        reason="URDF demands it, and Pinocchio's parser rejects the file.",
        remedy='Give it one: <robot name="chaser">.',
        example="<robot>",
    ),
    Rule(
        name="default-namespace",
        severity="warning",
        summary="<robot> has a default namespace, as xmlns='http://drake.mit.edu'. It is ignored.",
        reason="URDF is in no namespace: readers that know namespaces find no <robot> in the file.",
        remedy="Remove xmlns=…; a prefix, as xmlns:drake=…, may stay.",
        example='<robot name="r" xmlns="http://drake.mit.edu">',
    ),
    Rule(
        name="undeclared-prefix",
        severity="info",
        summary="Names have a prefix that is not declared. What bears one is taken for an element or attribute of "
        "another program.",
        reason="Readers that know namespaces reject the file.",
        remedy="Declare it in <robot>: xmlns:sensor='…'.",
        example="<gazebo><sensor:camera/></gazebo>",
    ),
    Rule(
        name="declaration-late",
        severity="warning",
        summary="Blank lines stand before the XML declaration. It is read as if they did not.",
        reason="It is not well-formed XML, and most readers reject it.",
        remedy="Remove what stands before <?xml.",
        example='a blank line before <?xml version="1.0"?>',
        fixable=True,
    ),
    Rule(
        name="xacro-left-over",
        severity="warning",
        summary="A call or value of xacro is left in a <visual>, <collision> or <material>, which is left out.",
        reason="Neither link nor joint nor inertial can come of it, so dynamics do not need it; inertias are not "
        "compared with the shape.",
        remedy="Expand the file with its macros, or delete it.",
        example='<visual><xacro:shape/></visual>, <mesh filename="$(find arm)/hand.stl"/>',
    ),
    Rule(
        name="xacro-warning",
        severity="warning",
        summary="xacro warned while it expanded the file. An info where that cannot change the robot: an old name of a "
        "function, or a property with the name of a constant.",
        reason="A pattern of file names that matches none, or an attribute that is not used, can mean that a part of "
        "the robot is missing.",
        remedy="As the message says.",
        example='<xacro:include filename="parts_*.xacro"/>',
    ),
    Rule(
        name="original-differs",
        severity="error",
        summary="Pinocchio reads another robot from the file as it stands: a mass, centre, inertia, placement, axis, "
        "limit, damping or friction differs, and no finding says why.",
        reason="One of the two readers has lost something.",
        remedy="Look at what is named in the file; please report it, as no such file is known.",
        example="none is known",
    ),
    Rule(
        name="original-rejected",
        severity="info",
        summary="Pinocchio's own parser rejects the file, for a reason that no finding gives.",
        reason="ospace has read it all the same; its reading is then not compared with Pinocchio's.",
        remedy="As the message says.",
        example="<visual><geometry><cone/></geometry></visual> is one of them",
    ),
    Rule(
        name="parser-error",
        severity="error",
        summary="Pinocchio's parser complained on standard error and built a model all the same.",
        reason="It may not have read what it complained of.",
        remedy="Correct the element.",
        example="none is known: ospace gives the parser only what it has read itself",
    ),
)
