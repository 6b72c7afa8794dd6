"""Seating: the other places where a part can rest on a fixture's pegs, and the starting poses from which
closing leads into the fixture's pose.
"""
