"""What a user of Python asks of a workpiece, a fixture or a result: pictures, papers, tables, and toolkits by
name.

Methods of the model's classes lead here, see ``delegates``; the command line writes its papers here too.

- ``papers``: pictures that show themselves in a notebook, the setup sheet of a fixture, its set-up for a CAM system and
  its list of pins.
- ``data``: plain data for JSON, and all fixtures as a table of pandas or Arrow.
- ``presets``: toolkits that people own, by name.
"""
