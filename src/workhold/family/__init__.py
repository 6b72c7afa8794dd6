"""Families of parts: which set-ups hold many parts, and what each fewer set-up costs.

Glossary
--------
family : several parts that are to be held in one toolkit; each of them is a member.
pattern : the places of the pegs relative to each other, without faces, pose and opening. In a vise these are
    the offsets within each jaw and the row difference between the jaws. On a plate these are the offsets of
    the locators, with each clamp's direction, line and, where it has one, hole. On a fence the locator's row
    takes the place of the offsets. Moving all pegs by whole lattice steps gives the same pattern. A pattern
    holds a part when a fixture of the part, as listed or after half a turn of everything, has it.
    Between flat jaws, which have no pegs, it is the height of the parallels and the place of the work stop.
words : the whole numbers, W to a pattern, in which patterns are written; equal for equal patterns.
identity : the words of a pattern; patterns are sorted by them.
loss : the first ranking figure of a fixture divided by the best value that the part has in the toolkit, or
    the inverse where more is better: 1 or more. A location error counts as the effective one
    (``statics.effective_error``), which is higher where the part is turned. A pattern's loss on a part is the
    least among the part's fixtures that have the pattern.
bound : the largest loss that is accepted. At a bound, a pattern stands for the set of those members that it
    holds with no larger loss.
cover : some patterns that together hold all members within a bound.
curve : for each number of set-ups, the smallest possible value of the worst loss among the members.
set-up : a pattern standing in holes, with all members that it is to hold.
holding : how one member lies in a set-up: one of its fixtures, moved to the holes of the set-up.
half turn of everything : fixture, pegs and toolkit turned by 180 degrees about z.
"""
