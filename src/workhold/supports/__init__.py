"""Three supports under the part and one clamp from above, on top of a planar fixture.

Pegs do not resist tipping. Three supports and a clamp that presses inside their triangle do, whatever the
heights at which the pegs touch. So the list of fixtures in space is a product: each planar fixture with each
of its triples of supports, and each triple with each place of the clamp.
"""
