"""Simulation: forward dynamics on the manifold, a certificate for every run, and targets to grasp."""

from ospace.exceptions import SimulationError
from ospace.simulation.actuation import Actuation, Command, Controller
from ospace.simulation.certificate import Certificate, Conserved
from ospace.simulation.grasp import Grasp, grasp, release
from ospace.simulation.measurement import Noise
from ospace.simulation.simulate import simulate
from ospace.simulation.target import rigid_body, tumbling
from ospace.simulation.trajectory import Excess, Trajectory

__all__ = [
    "Actuation",
    "Certificate",
    "Command",
    "Conserved",
    "Controller",
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
