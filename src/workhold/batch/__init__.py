"""Many parts in many toolkits: every part with every toolkit, on one machine or on a cluster.

Glossary
--------
job : a part, a toolkit and a query for fixtures; a row of the table of results.
task : a piece of work that a worker does: reading a drawing, or answering a job. Jobs of equal parts share
    one.
record : the file with the outcome of a task. It is stored under the task's name; a task is done if and only
    if its record exists.
name : hash of everything on which a task's outcome depends: content, query, and the program.
store : a place for records.
queue : gives tasks to workers (processes of this machine, or of a cluster) and takes their outcomes.
"""
