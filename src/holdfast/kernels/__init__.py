"""Compiled arithmetic: plain arrays and numbers in and out, no objects, no knowledge of files or users.

Every kernel is decorated with :func:`holdfast.kernels.compiling.compiled`. Points, directions and segments follow the
row layout of :func:`holdfast.geometry.segment.segment_rows`. Lengths are millimetres, angles radians.
"""
