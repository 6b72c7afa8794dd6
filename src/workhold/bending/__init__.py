"""How far clamps and cutters bend a part: linear elasticity on a mesh of NGSolve.

Every other package treats the part as rigid. This one meshes it, computes its displacement under the contact
forces of ``statics``, and reports how far its faces move (docs/bending.md).

Glossary
--------
column : a unit load on one patch of the part's surface; it is solved once per part.
case : a set of forces that balance, as a sum of columns.
distortion : movement of the surface that remains after a rigid motion has laid the part against its locators.
"""
