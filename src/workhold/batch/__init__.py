"""Many parts in many toolkits: every part with every toolkit, on the processors of one machine or of many.

Glossary
--------
job : a part with a toolkit and what is asked of its fixtures; a row of the table of results.
task : a piece of work that a worker does: reading a drawing, or answering a job. Jobs of equal parts share
    one.
record : the file with the outcome of a task. It is stored under the task's name; a task is done where, and
    only where, its record is there.
name : hash of all that a task's outcome depends on: content, what is asked, and the program.
store : where records are kept.
queue : gives tasks to workers (processes of this machine, or of a cluster) and takes their outcomes.
"""
