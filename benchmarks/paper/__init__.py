"""The report that ``make paper`` writes: sections that measure, and what they look like in print.

A section is a module with

- ``NAME``, ``TITLE``: of its data file and its heading;
- ``SECONDS``, ``QUICK_SECONDS``: about how long it takes here, for the bar;
- ``measure(data, quick)``: fills the dictionary ``data``, which JSON can hold, and yields after each step the share done
  and what comes next, so that what an interruption leaves behind is whole;
- ``render(figures)``: blocks of the report, from the data file alone, however much of it is there.

Glossary
--------
key : the place of a number in a data file, ``section/name/0/name``; it stands beside the number in both forms of the report.
witness : a file beside the report that shows what a claim says and that a command can check.
"""
