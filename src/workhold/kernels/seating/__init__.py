"""Kernels of seating: what pegs can do with a part besides holding it in a fixture's pose."""
