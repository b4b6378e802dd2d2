"""The public quantities of the paper, and the oracle they are checked against."""
