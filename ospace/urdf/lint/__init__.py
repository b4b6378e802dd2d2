"""Findings on a model, by the rules that explain them."""
