"""Recursion against oracle: states, quantities, table, report."""
