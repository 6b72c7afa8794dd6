"""Seating: where else a part can rest on a fixture's pegs, and from where closing leads into its pose."""
