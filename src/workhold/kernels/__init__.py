"""Compiled arithmetic: plain arrays and numbers in and out, no objects, no knowledge of files or users.

Every kernel is decorated with :func:`workhold.kernels.base.compiling.compiled`. Points, directions and
segments follow the row layout of :func:`workhold.geometry.segment.make_segment_rows`. Lengths are in
millimetres, angles in radians.
"""
