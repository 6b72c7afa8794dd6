"""Tolerances and other numbers that decide: what counts as parallel, as one point, as touching.

Each is defined only here, with what it measures and why it has its value. Lengths are in mm and angles in
radians unless said otherwise. Roundings counted by hand for a proof stand beside their formulas instead, and
so do numbers that only limit the amount of work. ``workhold.verification.tolerances`` is a separate copy of
those that the verification needs, on purpose.
"""

from __future__ import annotations

# == Part of the claim: the table of docs/belief.md has a row for each ==

# No unit, the cross product of directions: parallel faces of a drawing are so only to rounding.
PARALLEL = 1e-9
# mm. Arcs with centres this near are concentric: their normals meet in one point.
SAME_CENTER = 1e-9
# mm. Lengths that agree to this are a coincidence, beside which general formulas divide zero by zero: the
# rounding of coordinates. Chords beside it are those of a part in which they agree.
EXACT = 1e-11
# Radians, and a share of L. Where the lengths of part and lattice allow contacts only with normals this near
# to parallel, to one line, or to one point, they are so: nearer than what LEAST_SEAT asks of them.
DEPENDENT = 3e-7
# mm. Right pegs may stand nearer than the smallest gap by this much: rounding of a gap that is met exactly.
GAP_SLACK = 1e-9
# mm. The body of a clamp may enter the part by this much: it touches it at the tip, and slots as wide as a
# clamp are drawn with seven digits.
BODY_SLACK = 1e-7
# mm. A contact this near to the end of its feature is at the end; past a tangent joint it may be by as
# much. A contact margin or the distance from a keep-out zone, which a user asks for with "at least", is met
# when missed by at most this.
END_SLACK = 1e-9
# mm and no unit. Ends this near, with normals this near, are a tangent joint: bulges are written with few
# digits.
JOINT = 1e-6
TANGENT = 1e-5
# mm. A piece of an offset may come nearer to the outline than the radius by this much, and shorter ones are
# dropped: what cutting leaves over. The outline itself is held to TOUCHING, which is coarser, because its
# coordinates are a user's.
CLEARANCE = 1e-9
# mm. A concave arc whose radius exceeds a peg's by no more than this is a corner that the peg fills: it
# touches the arc from end to end, and no place on it is its contact. The digits of a bulge leave so much of
# equal radii.
FILLED = 5e-7
# No unit. The smallest entry of the null vector exceeds this (model: condition 4): 0 when three normals meet
# in one point.
LEAST_CLOSURE = 1e-9
# No unit. The clamping force exceeds this (model: condition 5): 0 at an exact double root, where the rounding
# of a drawing makes it up to 1e-7 or so.
LEAST_CLAMPING = 1e-6
# No unit. With two clamps each pushes with more than this part of the force on its face, for a clamp that
# grazes an arc pushes with nothing; and the wrenches of the locators have a larger determinant than the
# second: with less the pose is a double root, which a rounded drawing leaves at 1e-7 or so.
LEAST_PUSH = 1e-6
LEAST_SEAT = 1e-6
# No unit. No peg is pressed with more than so many times the force of a clamp. With one clamp, and in a vise,
# the least clamping force implies it: shares are below 1.
MOST_FORCE = 1e6
# No unit. A locator's force per unit of a clamp's this near to zero is zero: exact zeros are the rule in a
# square pose. A clamp whose least such force, as a share of all, is above it holds the part without the
# other.
NO_REACTION = 1e-9
# No unit. The sizes of the four minors sum to more than this: with less, the lines of action meet in one
# point or are parallel up to the rounding of the drawing, and the wrenches do not span the space.
LEAST_SPAN = 1e-7
# Radians. Orientations nearer than this are one pose.
SAME_POSE = 1e-6
# mm. Places nearer than this are one: a contact at a joint is found from both faces, off by the rounding of
# each.
SAME_PLACE = 1e-6
# mm. Straight pieces of the hull shorter than this are none that a part can lie on.
LEAST_HULL_EDGE = 1e-6
# mm. An arc nowhere farther from its chord is a line, and neighbouring arcs nowhere farther from one circle
# are one: less than a drawing can mean.
READING = 1e-6
# No unit. A bulge below this in size is a line: it departs from its chord by a millionth of it, less than a
# drawing can mean; the radius is above 125,000 chords, and figures in mm about its centre would lose
# their last digits.
STRAIGHT = 2e-6

# == Reading and joining: what an outline is ==

# mm. A curve, or a chain of chords and arcs, that is nowhere farther from a line or an arc is one in
# disguise: less than machines hold. The departure counts in the tolerance of the faces all the same.
DISGUISE = 1e-3
# mm. Vertices of chords nearer than this to a line or an arc are drawn on it: the digits of a file.
DRAWN_ON = 1e-5
# A share of the radius. The cubics by which programs write quarter circles are this far off at most (2.73e-4,
# and what is left of it with other handles).
AS_ARC = 3e-4
# Radians. Where a curve's direction jumps by more it has a corner.
CORNER = 1e-3
# A share. Where a curve's curvature jumps by more, one line or arc of a disguise may end.
CURVATURE_JUMP = 0.01

# mm. Segments shorter than this have no direction worth the name.
SHORTEST = 1e-7
# mm. Points nearer than this touch: the rounding of a drawing with seven digits.
TOUCHING = 1e-7
# A share of the extent. Tangent neighbours meet again so near to their joint; that is no crossing.
MEETS_AGAIN = 1e-5
# No unit and mm. Neighbours whose directions agree so (sum of the components' differences), and whose lines,
# centres and radii do, continue the same line or circle: as PARALLEL and TOUCHING, since a face is what a peg
# cannot distinguish.
SAME_DIRECTION = 1e-9
SAME_CARRIER = 1e-7
# Radians. Arcs of one face that lack less than this of half a turn of half sweep are a whole circle: rounding
# of bulges.
WHOLE = 1e-9
# mm. Ends nearer than this are the same point: the rounding of computed arc ends and of placed blocks.
SAME_POINT = 1e-9
# mm. Points and radii that agree to this after a rotation are the same: the part's own symmetry, as its
# drawing has it.
SAME_AFTER_TURN = 1e-6
# Radians and mm. Poses of fixtures that agree to this after such a rotation are the same: a pose that follows
# from several contacts is off by more than the outline is.
SAME_IMAGE = 4e-6
# A share. Axes whose scales or right angle differ by less keep circles circular, and radii of an ellipse that
# differ by less are those of a circle: files have seven digits.
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

# mm. Ends of features are moved out by this much for the search, far more than rounding: what is found past
# an end is discarded when the contacts are examined, by END_SLACK.
LOOSE = 1e-6
# A share. Forces under one of two clamps that doubles may have off by more are computed in balls: half of
# what verification allows.
FORCES_OFF = 5e-8
# Degrees. The end of a range of angles counts, to within this: the rounding of an angle written with ten
# decimals, and more. A verification allows 1e-6 degrees, because it knows the pose only as it is written.
ANGLE_SLACK = 1e-7
# Degrees. Cells this near to a range of angles are searched too: wider than ANGLE_SLACK, so that the edge of
# a cell never decides what the end of the range is to decide.
ANGLE_HAIR = 1e-5
# No unit. A fixture may fall short of the margin to reach by this much and still be examined: margins count
# to 9 decimals.
MARGIN_SLACK = 2e-9

# == Sliding pairs ==

# No unit, 1 - cosine. A chord square to its parallel lines, to within rounding of this cosine (9e-8 rad), has
# one line of action for both contacts: it leaves the others no share.
SQUARE = 4e-15
# A share of the part's size. Lengths that agree to this are equal where equality changes the algebra: coarser
# than EXACT, since the algebra bounds no rounding.
COINCIDENT = 1e-9

# == Algebra ==

# A share of the part's size. Refined poses meet every contact to this.
MET = 1e-10
# No unit. At a double solution the Jacobian vanishes: its determinant is the clamping force times the span of
# the wrenches, so nothing clamps there. Rounding moves such a pose by some 1e-8, and leaves a determinant of
# that order.
DOUBLE = 1e-7
# A share of the part's size. Starting values may miss a contact by this much: Newton's method brings them to
# MET.
NEARLY_MET = 0.02
# No unit. Newton's method does not divide by a determinant below this.
SINGULAR = 1e-13
# Radians, and a share of the part's size. Refined poses may be off by this much at least: rounding of the
# last steps.
POSE_REACH = 1e-11
# A share of the part's size. Rounding of the misfit of a sliding pair.
MISFIT_ROUNDING = 1e-14
# Radians. Orientations of sliding pairs may be off by the first at least, which is rounding, and by the
# second at most.
LEAST_SLIDING_REACH, MOST_SLIDING_REACH = 1e-12, 1e-3
# Pitches. Rows this near to the reach of a feature are looked at.
ROW_SLACK = 1e-9
# No unit. A line that rises by less over its length is level, and meets no horizontal in one point.
RISES = 1e-12
# mm and radians. Bounds of distances and directions between features are widened by this much, far more than
# rounding.
WEDGE_SLACK = 1e-6
# A share of the largest coefficient. A polynomial this much outside its bounds in a sector may still have a
# root there.
SECTOR_SLACK = 1e-9
# No unit. A root this near to the unit circle may be real: coefficients are off by some 1e-14, which moves
# roots that are alone by as little, and the fourfold ones of symmetric parts by up to 1e-3. Newton's method
# decides.
NEAR_CIRCLE = 1e-2
# A share. Outermost coefficients below this part of the largest are taken for rounding, and trimmed: where
# features are parallel, concentric or equal, degrees are lower. On the unit circle that changes the
# polynomial by no more than rounding.
VANISHING = 1e-13
# Diameters of the part. Arcs of a larger radius spread the coefficients so far that small ones are not
# rounding.
NEARLY_STRAIGHT = 3.0
# A share. Polynomials with smaller outermost coefficients than this part of the largest are solved in ball
# arithmetic.
ILL_CONDITIONED = 1e-6
# A share. Where a polynomial is below the first part of its largest coefficient, or the second of its terms,
# roots crowd.
CROWDED, NOISE = 1e-10, 1e-11
# A share of the part's size, squared. A pair of arcs that nearly slides crowds up to four roots within its
# misfit, two pairs up to eight. Rounding by 1e-14 scatters four within some 3e-4, eight within 2e-2: misfits
# whose product is below this are looked at in balls.
NEARLY_SLIDING = 1e-3
# A share. A polynomial smaller than this part of its terms vanishes identically.
IDENTICALLY_ZERO = 1e-12
# No unit. Roots in balls are isolated and then refined to this.
REFINED = 1e-12

# == Files ==

# A share. A chord of an SVG arc this near the diameter is a half circle: its sweep cannot be found from the
# chord.
HALF_CIRCLE = 1e-14
# mm. Departures of a solid from its outline below this are rounding of the CAD program.
DEPARTS = 1e-4
# mm. A face of a solid may reach this far out of the silhouette: the rounding of files that give few digits.
OVERHANG = 1e-3
# A share. Areas that differ by less are the same; with free-form borders the library integrates only so well.
SAME_AREA, FREE_AREA = 1e-7, 1e-3
# A share. The volume of a solid and that of its layers may differ by so much; free-form faces are integrated
# roughly.
SAME_VOLUME, FREE_VOLUME = 1e-5, 1e-2
# Radians. A face of a solid whose normal is off by less lies as it was meant to: 0.01 µm over 100 mm.
ALIGNED = 1e-7
# mm. Heights of a solid's faces closer than this are the same.
SAME_HEIGHT = 1e-5
# mm. Gaps between the edges of a border that are rounding and not worth a word.
EDGE_GAP = 1e-6
# mm. The two ends of an arc of a program may differ by so much in their distance from its centre: coordinates
# that are written with two digits, which controls let pass as well.
ARC_RADII = 0.02

# == Statics ==

# A share. A force this small beside the largest is none.
NO_FORCE = 1e-9
# No unit. Planes with a determinant below this have no common corner, and a corner may be outside by the
# second.
FLAT = 1e-12
OUTSIDE = 1e-9

# == What stands first (docs/quality.md says why) ==

# Degrees. An angle as written that is nearer to a whole quarter turn is that: poses are known to far less.
WRITTEN_ANGLE = 1e-6
# No unit. Each step of the effective location error above the best is by a tenth: so many tenths more, as a
# fraction, which is counted exactly.
STEP_TENTHS = 11, 10

# == What is warned of, and what counts against a fixture (docs/quality.md says why) ==

# mm. A contact nearer than this to an edge: edges are commonly broken by some tenths of a millimetre.
NEAR_EDGE = 1.0
# mm. A part whose centre of area is less inside the triangle of its supports tips at a touch: the centre of
# gravity is not known better than that, and broken edges of pads and part take some tenths of a millimetre.
STEADY = 0.5
# No unit. Below this closure margin the weakest contact has less than a twelfth of the even share, a quarter.
WEAK_CLOSURE = 0.02
# No unit. A peg that pushes with more than so many times the jaw force wedges the part and marks its face.
STRONG_PEG = 3.0
# Times the sum of the tolerances of peg and face: with a larger location error the contacts guide badly.
LARGE_LOCATION_ERROR = 5.0
# The same, and the closure margin, past which it is no fixture for a workshop: the part lies anywhere, or
# one peg holds less than a hundredth of the even share.
UNFIT_LOCATION_ERROR = 50.0
UNFIT_CLOSURE = 0.0025
# Degrees. A part turned by less lies square: 0.02 mm over 100 mm.
SQUARE_TILT = 0.01
# A share. Straight faces in one direction make it the part's main one when no other has this much of their
# length.
MAIN_DIRECTION = 0.99
# A share of the part's diameter: a touched face is small below it, by its length or radius.
SMALL_FACE = 0.1
# No unit. A peg that pushes with more than so many times the jaw force asks for care.
GENTLE_PEG = 1.5
# MPa. Young's modulus and the shear modulus of the hardened steel that pins are of.
ELASTIC_MODULUS, SHEAR_MODULUS = 210_000.0, 81_000.0
# N. What bending is stated for where nobody says how hard the jaws press.
STATED_FORCE = 1000.0
# MPa. A pin that is bent harder may stay bent, where the toolkit says nothing else: a third of the yield of a pin
# of the softest core that ASME B18.8.5M allows, HRC 47. That is HV 471 (ASTM E140, table 1), and HV 471 yields at
# 2.876 x 471 - 90.7 = 1264 MPa (E. J. Pavlina, C. J. Van Tyne, J. Mater. Eng. Perform. 17, 2008, 888-893).
PIN_STRESS_LIMIT = 421.0
# mm. Pins that give way may move a point of the part so far, where the toolkit says nothing else: half of the
# general tolerance of short lengths, +-0.1 mm (ISO 2768-1, class m, up to 6 mm).
PIN_MOVEMENT_LIMIT = 0.05
# Diameters that a dowel sits in its hole at least.
DOWEL_DEPTH = 1.5
# Diameters that a dowel stands out where nobody asks for more.
DOWEL_STANDOUT = 2.0
# Points against a fixture: so many for ten times the location error, and for a tilt, a peg that is not
# gentle, a small face.
POINTS_PER_DECADE = 20
TILTED_POINTS, STRONG_POINTS, SMALL_FACE_POINTS = 9, 4, 2
# No unit. Figures are rounded to so many decimals before they are compared with these numbers, and with each
# other: rounding must not make equal fixtures differ.
FIGURE_DECIMALS = 9
