"""Simulation: forward dynamics on the manifold, a certificate for every run, and targets to grasp."""

from ospace.simulation.actuation import Actuation, CommandLike, ControllerLike
from ospace.simulation.certificate import Certificate, Conserved
from ospace.simulation.errors import SimulationError
from ospace.simulation.grasp import Grasp, grasp, release
from ospace.simulation.sensor_noise import Noise
from ospace.simulation.simulate import simulate
from ospace.simulation.target import rigid_body, tumbling
from ospace.simulation.trajectory import Excess, Trajectory

__all__ = [
    "Actuation",
    "Certificate",
    "CommandLike",
    "Conserved",
    "ControllerLike",
    "Excess",
    "Grasp",
    "Noise",
    "SimulationError",
    "Trajectory",
    "grasp",
    "release",
    "rigid_body",
    "simulate",
    "tumbling",
]
