"""From a URDF to a Pinocchio model, and what is odd about it."""
