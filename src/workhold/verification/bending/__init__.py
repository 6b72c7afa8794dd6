"""How far a file says that fixtures bend their part, computed anew; of the room ``bending`` nothing is used.

Loads are put on the mesh all at once and solved directly, with three other corners held. Movements are read
from the field, and stresses from its gradient inside the elements. Numbers that define the figures, such as
the width of a peg's strip, are repeated here on purpose.
"""
