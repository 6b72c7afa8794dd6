"""The Workhold workbench: what it does with documents (fixture, solid), and its window (commands, panel).

FreeCAD's own Python never imports workhold, whose libraries it does not have. The command ``workhold`` of an
environment that has it runs as a child process (child).
"""
