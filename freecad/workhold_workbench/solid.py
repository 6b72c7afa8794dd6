"""A body of the document as workhold sees it: exported, with an axis up, its faces known by their numbers."""

import math
from pathlib import Path

import FreeCAD as App
import Part

from .child import Refusal

__all__ = [
    "AXES",
    "axis_of_face",
    "body_of",
    "export",
    "face_places",
    "foot_height",
    "placing",
    "shape_of",
    "signature",
]

# Which coordinates of the model are x, y and z of the set-up with an axis up, as workhold's manual says.
AXES = {"x": (1, 2, 0), "y": (2, 0, 1), "z": (0, 1, 2)}
NEAR = 1e-6
# In mm: a box of a shape with round faces is a little too large.
NEAR_HEIGHT = 1e-2


def body_of(obj):
    """The body that an object is a feature of, such as a pad; the object itself where it is in none.

    A click on a face selects the feature that is seen. A fixture holds the body, which later features change.
    """
    group = getattr(obj, "getParentGeoFeatureGroup", lambda: None)()
    return group if group is not None and group.isDerivedFrom("PartDesign::Body") else obj


def shape_of(part):
    """The solid of an object where it lies in the document.

    Raises
    ------
    Refusal
        For an object with no solid, or with several.
    """
    shape = getattr(part, "Shape", None)
    solids = [] if shape is None else shape.Solids
    if len(solids) != 1:
        raise Refusal("{} has {} solids: choose a body with one.".format(part.Label, len(solids) or "no"))
    solid = solids[0].copy()
    place = getattr(part, "getGlobalPlacement", None)
    if place is not None:
        solid.Placement = place().multiply(part.Placement.inverse()).multiply(solid.Placement)
    return solid


def signature(shape):
    """Numbers that change when the shape does."""
    faces = sorted(
        tuple(round(value, 6) for value in (face.Area, *face.CenterOfMass)) for face in shape.Faces
    )
    return repr(faces)


def axis_of_face(face):
    """The axis that a flat face looks along, such as "-z".

    Raises
    ------
    Refusal
        For a face that is not flat, or looks along no axis.
    """
    if not isinstance(face.Surface, Part.Plane):
        raise Refusal("The face is not flat: choose the upper face of the part.")
    normal = face.normalAt(0, 0)
    for k, name in enumerate("xyz"):
        if abs(abs(normal[k]) - 1) < NEAR:
            return name if normal[k] > 0 else "-" + name
    raise Refusal("The face looks along none of x, y and z: turn the part first.")


def export(shape, folder, label="part"):
    """Writes the solid into a STEP file of a folder, named by a label, and returns its path."""
    name = "".join(letter if letter.isalnum() or letter in "-_ ." else "-" for letter in label)
    path = Path(folder) / "{}.step".format(name.strip(". ") or "part")
    shape.exportStep(str(path))
    return path


def turn(axis):
    """The matrix that makes an axis of the model point up."""
    signs = (-1, 1, -1) if axis.startswith("-") else (1, 1, 1)
    rows = []
    for sign, source in zip(signs, AXES[axis.lstrip("-")]):
        rows += [float(sign) if column == source else 0.0 for column in range(3)] + [0.0]
    return App.Matrix(*rows, 0.0, 0.0, 0.0, 1.0)


def placing(shape, axis, pose):
    """The placement that carries the frame of the toolkit into the document, about the part.

    Parameters
    ----------
    shape : the part's solid.
    axis : what points up.
    pose : ``theta_deg``, ``x`` and ``y`` of the part in the toolkit.
    """
    up, low = turn(axis), foot_height(shape, axis)
    angle = math.radians(pose["theta_deg"])
    cos, sin = math.cos(angle), math.sin(angle)
    first, second = (cos, -sin, 0.0, pose["x"]), (sin, cos, 0.0, pose["y"])
    laid = App.Matrix(*first, *second, 0.0, 0.0, 1.0, -low, 0.0, 0.0, 0.0, 1.0)
    return App.Placement(laid.multiply(up)).inverse()


def foot_height(shape, axis):
    """The height of a shape's lowest point with an axis up: of a corner, or of a round face that goes lower.

    FreeCAD 0.20 ends with a fault where the exact box is asked for.
    """
    standing = shape.copy()
    standing.Placement = App.Placement(turn(axis)).multiply(standing.Placement)
    low = min(vertex.Z for vertex in standing.Vertexes)
    bounds = standing.BoundBox.ZMin
    return low if low - bounds < NEAR_HEIGHT else bounds


def face_places(path, shape, names):
    """The places of faces of the document in the file that the solid was exported into, by their names.

    Parameters
    ----------
    path : the exported solid.
    shape : the solid of the document.
    names : such as ``Face5``.

    Raises
    ------
    Refusal
        For a face that the part does not have any more.
    """
    read = Part.Shape()
    if names:
        read.read(str(path))
    places = {}
    for name in names:
        try:
            face = shape.getElement(name)
        except Exception:
            # FreeCAD 0.20 raises what is not a class of Python's own.
            face = None
        if not isinstance(face, Part.Face):
            raise Refusal("The part has no face {} as it is now: choose the faces again.".format(name))
        places[name] = min(
            range(len(read.Faces)), key=lambda k: (read.Faces[k].CenterOfMass - face.CenterOfMass).Length
        )
    return places
