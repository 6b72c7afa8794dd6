"""Between a fixture and a job of FreeCAD's CAM workbench, which was called Path before version 1.0."""

import os
import tempfile

from . import fixture
from .child import Refusal
from .compat import job_module, program_of

__all__ = ["job_of", "send", "take_program"]


def job_of(obj):
    """The job whose model is the part of a fixture; None where there is none."""
    for one in obj.Document.Objects:
        model = getattr(one, "Model", None)
        if model is None or not hasattr(one, "PostProcessorOutputFile"):
            continue
        for copy in getattr(model, "Group", []):
            if obj.HeldPart in (copy, *getattr(copy, "Objects", []), *copy.OutListRecursive):
                return one
    return None


def send(obj):
    """Makes a job of the part, unless there is one, and puts the fixture's bodies into a group beside it.

    Returns
    -------
    A sentence that says what was done.

    Raises
    ------
    Refusal
        Without a fixture, and where this FreeCAD has no CAM workbench.
    """
    if not obj.Group:
        raise Refusal("There is no fixture to send yet: design first.")
    job = job_of(obj)
    if job is None:
        job = job_module().Create("Job", [obj.HeldPart], None)
        job.Label = "Job of {}".format(obj.HeldPart.Label)
    if not hasattr(job, "Fixture"):
        job.addProperty("App::PropertyLink", "Fixture", "Workhold", "What holds the part of this job")
    job.Fixture = obj
    obj.Document.recompute()
    return "{} has {} bodies of {} beside its stock.".format(job.Label, len(obj.Group), obj.Label)


def take_program(obj):
    """Takes the G-code that the job was post-processed into, and designs again with it.

    Raises
    ------
    Refusal
        Without a job, or one file of it.
    """
    job = job_of(obj)
    if job is None:
        raise Refusal("No job has this part as its model: send the fixture to CAM first.")
    obj.Program, obj.Tools = program_of(job), write_tools(job)
    return fixture.design(obj)


def write_tools(job):
    """Writes the table of a job's tools: numbers and diameters in mm, as workhold reads them."""
    lines = ["tool,diameter"]
    for controller in job.Tools.Group:
        tool = controller.Tool
        diameter = getattr(tool, "Diameter", None)
        if diameter is not None:
            lines.append("{},{:.6f}".format(controller.ToolNumber, getattr(diameter, "Value", diameter)))
    handle, path = tempfile.mkstemp(prefix="workhold-tools-", suffix=".csv")
    with os.fdopen(handle, "w", encoding="utf-8") as stream:
        stream.write("\n".join(lines) + "\n")
    return path
