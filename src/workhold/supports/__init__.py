"""Three supports under the part and one clamp from above, on top of a planar fixture.

A peg resists no tipping. Three supports and a clamp that presses inside their triangle do, at any heights at
which the pegs touch. So the list of fixtures in space is a product: each planar fixture with its triples of
supports, each triple with its places of the clamp.
"""
