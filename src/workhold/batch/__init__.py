"""Many parts in many toolkits: every part with every toolkit, on the processors of one machine or of many.

Glossary
--------
job : a part with a toolkit and what is asked of its fixtures; a row of the table of results.
task : a piece of work that a worker does: reading a drawing, or answering a job. Jobs of equal parts share
    one.
record : the file of what came of a task. It stands under the task's name, and is the only sign that the task
    is done.
name : hash of all that a task's outcome depends on: content, what is asked, and the program.
store : where records are kept.
queue : what gives tasks to workers and takes their outcomes: processes of this machine, or a cluster.
"""
