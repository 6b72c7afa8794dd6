"""The numbers that decide: what counts as parallel, as one point, as touching, as met.

Each stands here once, with what it measures and why it is what it is, and is imported by whoever asks. Lengths are in mm and
angles in radians unless said otherwise. Roundings counted by hand for a proof stand beside their formulas instead, and so do
numbers that only say how much work is done. ``workhold.verification.rules`` is a copy of what it needs, on purpose.
"""

from __future__ import annotations

# == Part of the claim: the table of docs/belief.md has a row for each ==

# No unit, the cross product of directions: parallel faces of a drawing are so only to rounding.
PARALLEL = 1e-9
# mm. Arcs with centres this near are concentric: their normals meet in one point.
SAME_CENTER = 1e-9
# mm. Lengths that agree to this are a coincidence, beside which general formulas divide zero by zero: the rounding of
# coordinates. Chords beside it are those of a part in which they agree.
EXACT = 1e-11
# mm. Right pegs may stand nearer than the smallest gap by this much: rounding of a gap that is met exactly.
GAP_SLACK = 1e-9
# mm. A contact this near to the end of its feature is at the end; beyond a tangent joint it may be by as much.
END_SLACK = 1e-9
# mm and no unit. Ends this near, with normals this near, are a tangent joint: bulges are written with few digits.
JOINT = 1e-6
TANGENT = 1e-5
# mm. A piece of an offset may come nearer to the outline than the radius by this much, and shorter ones are dropped: what
# cutting leaves over. The outline itself is held to TOUCHING, which is coarser, because its coordinates are a user's.
CLEARANCE = 1e-9
# No unit. The smallest entry of the null vector exceeds this (model: condition 4): 0 when three normals meet in one point.
LEAST_CLOSURE = 1e-9
# No unit. The clamping force exceeds this (model: condition 5): 0 at an exact double root, where the rounding of a drawing
# makes it up to 1e-7 or so.
LEAST_CLAMPING = 1e-6
# No unit. The sizes of the four minors sum to more than this: with less, the lines of action meet in one point or are
# parallel up to the rounding of the drawing, and the wrenches do not span the space.
LEAST_SPAN = 1e-7
# Radians. Orientations nearer than this are one pose.
SAME_POSE = 1e-6
# mm. Places nearer than this are one: a contact at a joint is found from both faces, off by the rounding of each.
SAME_PLACE = 1e-6

# == Reading and joining: what an outline is ==

# No unit. A bulge below this in size is a line: the smallest sagitta a drawing could mean.
STRAIGHT = 1e-12
# mm. Segments shorter than this have no direction worth the name.
SHORTEST = 1e-7
# mm. Points nearer than this touch: the rounding of a drawing with seven digits.
TOUCHING = 1e-7
# A share of the extent. Tangent neighbours meet again so near to their joint; that is no crossing.
MEETS_AGAIN = 1e-5
# No unit and mm. Neighbours whose directions agree so (sum of the components' differences), and whose lines, centres and
# radii do, continue the same line or circle: as PARALLEL and TOUCHING, since a face is what a peg cannot tell apart.
SAME_DIRECTION = 1e-9
SAME_CARRIER = 1e-7
# Radians. Arcs of one face that lack less than this of half a turn of half sweep are a whole circle: rounding of bulges.
WHOLE = 1e-9
# mm. Ends nearer than this are the same point: the rounding of computed arc ends and of placed blocks.
SAME_POINT = 1e-9
# mm. Points and radii that agree to this after a rotation are the same: the part's own symmetry, as its drawing has it.
SAME_AFTER_TURN = 1e-6
# A share. Axes whose scales or right angle differ by less keep circles circular, and radii of an ellipse that differ by less
# are those of a circle: files have seven digits.
CIRCULAR = 1e-7
# No unit. Components of a unit vector below this are rounding.
TILT = 1e-9
# mm. Heights (z) of a flat drawing differ by no more: rounding.
LEVEL = 1e-6
# mm. A peg's centre in a file and its hole differ by no more, or the file contradicts itself.
AGREEMENT = 1e-6
# mm. Diameters of dowels this close are the same size.
SAME_SIZE = 1e-6

# == Search and listing ==

# mm. Ends of features are moved out by this much for the search, far more than rounding: what is found past an end is
# discarded when the contacts are examined, by END_SLACK.
LOOSE = 1e-6
# Degrees. The end of a range of angles counts, to within this: the rounding of an angle written with ten decimals, and more.
# A verification allows 1e-6 degrees, because it knows the pose only as it is written.
ANGLE_SLACK = 1e-7
# Degrees. Cells this near to a range of angles are searched too: wider than ANGLE_SLACK, so that the edge of a cell never
# decides what the end of the range is to decide.
ANGLE_HAIR = 1e-5
# No unit. A fixture may fall short of the margin to reach by this much and still be examined: margins count to 9 decimals.
MARGIN_SLACK = 2e-9

# == Sliding pairs ==

# No unit, 1 - cosine. A chord square to its parallel lines, to within rounding of this cosine (9e-8 rad), has one line of
# action for both contacts: it leaves the others no share.
SQUARE = 4e-15
# A share of the part's size. Lengths that agree to this are equal where equality changes the algebra: coarser than EXACT,
# since the algebra bounds no rounding.
COINCIDENT = 1e-9

# == Statics ==

# A share. A force this small beside the largest is none.
NO_FORCE = 1e-9
# No unit. Planes with a determinant below this have no common corner, and a corner may be outside by the second.
FLAT = 1e-12
OUTSIDE = 1e-9
