"""Seating: what else the pegs of a fixture can do with the part, and from where closing the vise leads into its pose."""
