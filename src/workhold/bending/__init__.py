"""How far clamps and cutters bend a part: linear elasticity on a mesh of NGSolve.

Every other room takes the part as stiff. This one meshes it, solves what the contact forces of ``statics`` do to it,
and says how far its faces move (docs/bending.md).

Glossary
--------
column : a unit load on one patch of the part's surface, which is solved once for each part.
case : a set of forces that balance, as a sum of columns.
distortion : movement of the surface that is left when the part is laid against its locators as if it were stiff.
"""
