"""Output for users of Python from a workpiece, a fixture or a result: pictures, papers and tables.

Methods of the model's classes import from here; the command line writes its papers here too.

- ``papers``: pictures, the setup sheet of a fixture, its set-up for a CAM system and its list of pins.
- ``assembly``: the bodies of a set-up in files, and in build123d and CadQuery.
- ``data``: plain data for JSON, and all fixtures as a table of pandas or Arrow.
- ``figure_words``: figures, holes and counts as words for tables.
- ``notebook``: display of objects in a notebook.
"""
