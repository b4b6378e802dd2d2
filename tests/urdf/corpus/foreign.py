"""What elements of other programs say of dynamics."""

from __future__ import annotations

from urdf.corpus.parts import ARM, variant

SHOULDER = '<transmission name="t"><joint name="hinge"/><actuator name="m">{}</actuator></transmission>'
GAZEBO = "<gazebo>{}</gazebo>"
for name, element in {
    "rotor inertia": SHOULDER.format('<rotor_inertia value="1e-4"/>'),
    "rotor inertia of a namespace": SHOULDER.format('<d:rotor_inertia xmlns:d="http://example.org/d" value="1e-4"/>'),
    "loop joint": '<loop_joint name="closing" type="spherical"><link1 link="base"/><link2 link="arm"/></loop_joint>',
    "constraint": '<constraint name="closing" predecessor="base" successor="arm"/>',
    "constraint of a namespace": '<d:ball_constraint xmlns:d="http://example.org/d"/>',
    "spring": '<spring from="base" to="arm"/>',
    "joint in gazebo": GAZEBO.format(
        '<joint name="closing" type="revolute"><parent>arm</parent><child>base</child></joint>'
    ),
    "joint in a model in gazebo": GAZEBO.format(
        "<model><joint name='j'><child>a</child><parent>b</parent></joint></model>"
    ),
    "spring in gazebo": GAZEBO.format("<springStiffness>3</springStiffness>"),
    "mass in gazebo": GAZEBO.format("<link name='fuel'><inertial><mass>3</mass></inertial></link>"),
    "friction in gazebo": GAZEBO.format("<dynamics><friction>0.1</friction></dynamics>"),
    "added mass in gazebo": GAZEBO.format("<mass>3</mass>"),
    "rotor inertia in one word": SHOULDER.format("<motorinertia>1e-4</motorinertia>"),
    "friction of a gear": SHOULDER.format("<coulomb_friction>0.2</coulomb_friction>"),
    "slosh": '<fuel_slosh mass="3" frequency="0.1"/>',
    "damping in gazebo": GAZEBO.format("<dampingFactor>0.1</dampingFactor>"),
}.items():
    variant(f"{name} is not used", ARM.replace("</robot>", f"{element}</robot>"), 0, "dynamics-not-used")
for name, element in {
    "gear": SHOULDER.format("<mechanicalReduction>50</mechanicalReduction>"),
    "gear as attribute": SHOULDER.format('<leftActuator mechanicalReduction="-50"/>'),
    "gear of ros2_control": "<ros2_control><param name='mechanical_reduction'>9</param></ros2_control>",
    "gear in one word": SHOULDER.format("<gearratio>50</gearratio>"),
}.items():
    variant(
        f"{name} alone changes nothing", ARM.replace("</robot>", f"{element}</robot>"), 0, infos=["dynamics-not-used"]
    )
variant(
    "gear of a rotor is not used",
    ARM.replace("</robot>", SHOULDER.format("<rotor_inertia value='1e-4'/><gear_ratio>50</gear_ratio>") + "</robot>"),
    0,
    "dynamics-not-used",
)
for name, element in {
    "gear of one": SHOULDER.format("<mechanicalReduction>1</mechanicalReduction>"),
    "no rotor inertia": SHOULDER.format('<rotor_inertia value="0"/>'),
    "joint named in a plugin": GAZEBO.format("<plugin><joint>hinge</joint></plugin>"),
    "switch of gazebo": GAZEBO.format(
        "<implicitSpringDamper>true</implicitSpringDamper><springReference>1</springReference>"
    ),
    "solver of gazebo": GAZEBO.format("<physics><constraints/></physics>"),
    "stiffness of a contact": "<contact><stiffness value='30000'/><damping value='1000'/></contact>",
    "friction of a surface": GAZEBO.format("<collision><surface><friction><ode/></friction></surface></collision>"),
    "coefficients of gazebo's surface": GAZEBO.format("<mu1>0.2</mu1><kp>1e6</kp><maxVel>1</maxVel>"),
    "loop rate of a sensor": "<sensor><loop_rate>10</loop_rate><stiffness>3</stiffness></sensor>",
}.items():
    variant(f"{name} is no dynamics", ARM.replace("</robot>", f"{element}</robot>"), 0)
variant(
    "inertia scaled by a contact",
    ARM.replace("</link>", "<contact><inertia_scaling value='3'/></contact></link>", 1),
    0,
    "dynamics-not-used",
)
variant("spring in a joint", ARM.replace("</joint>", "<spring stiffness='3'/></joint>"), 0, "dynamics-not-used")
for name, part in {
    "pose": "<pose>0 0 1 0 0 0</pose>",
    "origin of a namespace": '<d:origin xmlns:d="http://example.org/d" xyz="0 0 1"/>',
    "placement": '<placement xyz="0 0 1"/>',
}.items():
    variant(f"{name} in a joint", ARM.replace("</joint>", f"{part}</joint>"), 0, "unknown-element")
variant("unit of a robot", ARM.replace("<robot ", '<robot units="mm" ', 1), 0, "unknown-attribute")
