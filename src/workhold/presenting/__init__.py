"""What a user of Python asks of a workpiece, a fixture or a result: pictures, papers, tables, and toolkits by name.

Methods of the model's classes lead here, see ``delegates``; the command line writes its papers here too.

- ``pictures``: SVG text that shows itself in a notebook.
- ``papers``: the setup sheet of a fixture, its set-up for a CAM system and its list of pins.
- ``frames``: all fixtures as a table of pandas or Arrow.
- ``presets``: toolkits that people own, by name.
"""
