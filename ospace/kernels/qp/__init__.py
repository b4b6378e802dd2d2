"""The quadratic program of one control cycle."""
