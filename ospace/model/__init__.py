"""The robot, its states and its points: objects with meaning, whose input is checked here."""
