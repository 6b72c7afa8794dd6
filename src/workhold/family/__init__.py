"""Families of parts: which peg patterns hold many parts, and what each fewer set-up costs.

Glossary
--------
family : several parts that are to be held in one toolkit; each of them is a member.
pattern : the places of the pegs relative to each other, without faces, pose and opening. In a vise these are
    the offsets within each jaw and the row difference between the jaws. On a plate these are the offsets of
    the locators, with each clamp's direction, line and, where it has one, hole. On a fence the locator's row
    takes the place of the offsets. Moving all pegs by whole lattice steps gives the same pattern. A pattern
    holds a part when a fixture of the part, as listed or after half a turn of everything, has it.
loss : the first ranking figure of a fixture over the best that the part has in the toolkit, or the inverse
    where more is better: 1 or more. A location error counts as the effective one (``statics.effective_error``),
    which is higher where the part is turned. A pattern's loss on a part is the least among the part's fixtures that
    have it.
bound : the largest loss that is accepted. At a bound a pattern is the set of the members that it holds within
    it.
cover : some patterns that together hold all members within a bound.
curve : the least worst loss among the members for each number of set-ups.
set-up : a pattern standing in holes, with all members that it is to hold.
holding : how one member lies in a set-up: one of its fixtures, moved to the holes of the set-up.
"""
