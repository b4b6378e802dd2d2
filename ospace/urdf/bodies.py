"""Links that fixed joints hold together are one body: masses, centres and tensors, and where each link lies.

The arithmetic is ospace's own: `parity` holds Pinocchio's model against it.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, field

import numpy as np

from ospace.kernels.tree import Floats
from ospace.urdf.description import Description, Inertial, Joint, Link, Pose, Triple


@dataclass
class Body:
    """A body: the base, or what one joint carries.

    Attributes
    ----------
    link : Link
        The link at whose frame the body's frame lies.
    joint : Joint or None
        The joint that carries it; None for the base.
    parent : int
        Number of the body it hangs from; −1 for the base.
    rotation, translation : (3, 3), (3,)
        Placement of the joint in the parent body's frame. m.
    mass, centre, tensor : float, (3,), (3, 3)
        Mass, its centre in the body's frame, and the tensor about that centre. kg, m, kg m².
    size : float
        Σ m c² + |I| over its links, what rounding of the tensor is measured by. kg m².
    weighed : list of Link
        Its links that have an <inertial>.
    placed : dict of link name to rotation (3, 3) and translation (3,)
        All its links in its frame. m.
    """

    link: Link
    joint: Joint | None
    parent: int
    rotation: Floats = field(default_factory=lambda: np.eye(3))
    translation: Floats = field(default_factory=lambda: np.zeros(3))
    mass: float = 0.0
    centre: Floats = field(default_factory=lambda: np.zeros(3))
    tensor: Floats = field(default_factory=lambda: np.zeros((3, 3)))
    size: float = 0.0
    weighed: list[Link] = field(default_factory=list)
    placed: dict[str, tuple[Floats, Floats]] = field(default_factory=dict)

    @property
    def subject(self) -> str:
        """Return the name that findings use."""
        others = len(self.weighed) - 1
        return self.link.subject + (f" with {others} fixed to it" if others > 0 else "")

    def add(self, link: Link, inertial: Inertial, R: Floats, p: Floats) -> None:
        """Add the mass of a link whose frame lies at `R`, `p` in the body's."""
        turn, centre = placement(inertial.pose)
        centre, turn = R @ centre + p, R @ turn
        tensor = turn @ tensor_of(inertial) @ turn.T
        total = self.mass + inertial.mass
        apart = centre - self.centre
        if total != 0.0:
            reduced = self.mass * inertial.mass / total
            tensor = tensor + reduced * (apart @ apart * np.eye(3) - np.outer(apart, apart))
            self.centre = self.centre + inertial.mass / total * apart
        self.tensor = self.tensor + tensor
        self.mass = total
        self.size += abs(inertial.mass) * float(centre @ centre) + float(np.abs(tensor).max())
        self.weighed.append(link)


def placement(pose: Pose) -> tuple[Floats, Floats]:
    """Compute rotation and translation of a pose.

    Returns
    -------
    (3, 3), (3,)
        R = Rz(yaw) Ry(pitch) Rx(roll), and the position in m; both in the axes of the frame above.
    """
    (sx, sy, sz), (cx, cy, cz) = (tuple(map(turned, pose.rpy)) for turned in (math.sin, math.cos))
    rotation = [
        [cz * cy, cz * sy * sx - sz * cx, cz * sy * cx + sz * sx],
        [sz * cy, sz * sy * sx + cz * cx, sz * sy * cx - cz * sx],
        [-sy, cy * sx, cy * cx],
    ]
    return np.array(rotation), np.array(pose.xyz)


def quaternion_to_rpy(quaternion: tuple[float, ...]) -> Triple:
    """Compute roll, pitch and yaw of a quaternion (x, y, z, w), whose length need not be one.

    Yaw is taken after the roll is turned back: where the pitch is 90 deg and the two are one turn, they add up to it.

    Returns
    -------
    tuple of float
        Roll, pitch, yaw about fixed axes. rad.
    """
    length = math.hypot(*quaternion)
    x, y, z, w = (value / length for value in quaternion)
    roll = math.atan2(2.0 * (y * z + w * x), 1.0 - 2.0 * (x * x + y * y))
    s, c = math.sin(roll), math.cos(roll)
    level = 2.0 * s * (y * z + w * x) + c * (1.0 - 2.0 * (x * x + y * y))
    yaw = math.atan2(
        2.0 * s * (x * z + w * y) - 2.0 * c * (x * y - w * z),
        c * (1.0 - 2.0 * (x * x + z * z)) - 2.0 * s * (y * z - w * x),
    )
    return roll, math.atan2(2.0 * (w * y - x * z), level), yaw


def plane_axes(normal: Triple) -> Floats:
    """Return the directions along which a planar joint moves, and its normal, as columns in the joint's frame.

    Of the axes x, y, z, cyclic, the one after that nearest to the normal becomes the first direction, as far as it lies
    in the plane: y and z of a plane across x, z and x across y, x and y across z.

    Returns
    -------
    (3, 3)
        A rotation.
    """
    z = np.array(normal)
    x = np.eye(3)[(int(np.argmax(np.abs(z))) + 1) % 3]
    x = x - (x @ z) * z
    x /= np.linalg.norm(x)
    return np.column_stack([x, np.cross(z, x), z])


def tensor_of(inertial: Inertial) -> Floats:
    """Return the tensor of an <inertial> as a matrix.

    Returns
    -------
    (3, 3)
        About the centre of mass, in the axes of the <inertial>. kg m².
    """
    xx, xy, xz, yy, yz, zz = inertial.tensor
    return np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]])


def bodies_of(description: Description) -> list[Body]:
    """Merge the links of a description whose joints stand from the base outward.

    Returns
    -------
    list of Body
        The base first, then one for each movable joint.
    """
    return link_places(description)[0]


def link_places(description: Description) -> tuple[list[Body], dict[str, tuple[int, Floats, Floats]]]:
    """Merge links to bodies, and place each link in its body.

    Returns
    -------
    list of Body
        As `bodies_of`.
    dict of str to (int, (3, 3), (3,))
        For each link the number of its body, and its rotation and translation (m) in the body's frame.
    """
    root = description.link[description.root]
    bodies = [Body(root, None, -1)]
    at = {root.name: (0, np.eye(3), np.zeros(3))}
    for joint in description.joints:
        number, R, p = at[joint.parent]
        turn, shift = placement(joint.pose)
        turn, shift = R @ turn, R @ shift + p
        if joint.kind == "fixed":
            at[joint.child] = (number, turn, shift)
        else:
            at[joint.child] = (len(bodies), np.eye(3), np.zeros(3))
            bodies.append(Body(description.link[joint.child], joint, number, turn, shift))
    for name, (number, R, p) in at.items():
        link = description.link[name]
        bodies[number].placed[name] = R, p
        if link.inertial is not None:
            bodies[number].add(link, link.inertial, R, p)
    return bodies, at
