"""Compilation of kernels, their cache, and their access to memory: machinery, apart from mathematics."""
