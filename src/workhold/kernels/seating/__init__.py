"""Kernels of seating: what pegs can do with a part besides pair it in a fixture's pose."""
