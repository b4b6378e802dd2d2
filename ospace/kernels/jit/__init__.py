"""How kernels are compiled and kept, and how they reach memory: machinery, apart from mathematics."""
