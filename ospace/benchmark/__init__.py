"""The comparison that `ospace bench` runs: ours and Pinocchio's way to the same quantity, side by side."""
