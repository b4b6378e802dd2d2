"""One robot of several parts: buses, arms, payloads, each a URDF or a body in a few words."""
