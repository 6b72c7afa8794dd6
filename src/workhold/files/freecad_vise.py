"""Vises of FreeCAD's CAM workbench, read from their files without FreeCAD.

A FreeCAD file (.FCStd) is a ZIP archive. Its member ``Document.xml`` names every object with its type, and then
gives the properties of each. A vise of the CAM workbench keeps its settings in a set of variables (``App::VarSet``),
or in a job's document in the vise itself: Opening, and where they are stated JawHeight, JawWidth and MaxOpening, in
mm. What reads them here looks at these properties alone; shapes, expressions and scripts of the document stay unread.

The names are those of FreeCAD's own code (``Path.Workholding``) and of the files of the library
``Connor9220/FreeCAD-Workholding``, in the layouts ("vise schemas") 1 and 2.
"""

from __future__ import annotations

import zlib
from math import isfinite
from pathlib import Path
from typing import Any
from xml.parsers import expat
from zipfile import BadZipFile, ZipFile

from attrs import define, field

from workhold.archive import DirectoryCheckedFile
from workhold.errors import InputError
from workhold.files.budget import LIMITS, Budget
from workhold.files.text import refuse_large_file
from workhold.fixels.fields import JAW_HEIGHT, JAW_WIDTH, MAX_OPENING, PARALLELS

__all__ = ["ENDING", "read_freecad_vise"]

ENDING = ".fcstd"
DOCUMENT = "Document.xml"
# Bytes that are unpacked together.
BLOCK = 1 << 16
# The newest layout of vises that is known here.
NEWEST_LAYOUT = 2
LENGTHS = ("Opening", "JawHeight", "JawWidth", "MaxOpening", "SeatHeight", "Parallels")
FLAGS = ("TakesParallels", "SelfCentering", "OnParallels")
NUMBERS = ("Stations", "ViseSchema")
TEXTS = ("Kind", "Label", "Maker", "Model", "Source")
KNOWN = {*LENGTHS, *FLAGS, *NUMBERS, *TEXTS}
# Letters of a text that is kept.
LONGEST = 200


@define
class DocumentReader:
    """What is kept of a FreeCAD document while its XML is parsed.

    Parameters
    ----------
    budget : for the elements of the document.
    types : type of each object by its name.
    values : by name of the object, the values of its properties in :data:`KNOWN`, as text.
    place : tags and names of the elements that are open.
    """

    budget: Budget
    types: dict[str, str] = field(factory=dict)
    values: dict[str, dict[str, str]] = field(factory=dict)
    place: list[tuple[str, str]] = field(factory=list)

    def handle_start(self, tag: str, attributes: dict[str, str]) -> None:
        """Handle a start tag."""
        self.budget.enter(lambda: f"<{tag[:40]}>")
        self.budget.spend(1 + len(attributes) // 10)
        name = attributes.get("name", "")
        if tag == "Object" and "type" in attributes:
            self.types.setdefault(name, attributes["type"])
        tags = [one for one, _ in self.place]
        if tags[-4:] == ["ObjectData", "Object", "Properties", "Property"]:
            owner, known = self.place[-3][1], self.place[-1][1]
            if known in KNOWN and "value" in attributes:
                self.values.setdefault(owner, {}).setdefault(known, attributes["value"][:LONGEST])
        self.place.append((tag, name))

    def handle_end(self, _: str) -> None:
        """Handle an end tag."""
        self.budget.leave()
        self.place.pop()


def read_freecad_vise(path: Path) -> tuple[dict[str, Any], str, str]:
    """Return the fields of a plain vise in mm, its title and the source of its figures, from a FreeCAD file.

    A length that the file does not state is left out. What stands under the part as the file was saved is the one
    height of parallels.

    Raises
    ------
    InputError
        Without the file's name: for a file that cannot be read, is no FreeCAD document, or has no such vise.
    """
    reader = parse_document(unpack_document(path))
    settings = find_settings(reader)
    layout = read_number(settings, "ViseSchema") or 1
    if layout > NEWEST_LAYOUT:
        raise InputError(
            f"the vise is laid out for a newer FreeCAD (vise schema {layout:g}; 1 and {NEWEST_LAYOUT} are known): write "
            "its jaw_width, jaw_height and max_opening into a TOML file."
        )
    if settings.get("SelfCentering") == "true":
        raise InputError(
            "both jaws of this vise move, to its middle; a plain vise has a fixed jaw, on which the part lies: take one."
        )
    lengths = {name: read_number(settings, name) for name in LENGTHS}
    rows = {"JawWidth": JAW_WIDTH, "JawHeight": JAW_HEIGHT, "MaxOpening": MAX_OPENING}
    fields: dict[str, Any] = {row.name: lengths[name] for name, row in rows.items() if lengths[name]}
    under = lengths["Parallels"] if settings.get("OnParallels") == "true" else lengths["SeatHeight"]
    if under and settings.get("TakesParallels") != "false":
        fields[PARALLELS.name] = (under,)
    labels = [values.get("Label", "") for owner, values in reader.values.items() if is_part(reader, owner)]
    title = settings.get("Model") or next((label for label in labels if label), "")
    told = ["the settings of a vise of FreeCAD's CAM workbench, in this file"]
    if settings.get("Source"):
        told.append(f"which names {settings['Source']} as its source")
    if (read_number(settings, "Stations") or 1) > 1:
        told.append("of its stations the first is meant")
    return fields, " ".join(title.split()), "; ".join(told)


def is_part(reader: DocumentReader, name: str) -> bool:
    """Return whether an object is a container of others, whose label is the vise's name."""
    return reader.types.get(name, "") == "App::Part"


def find_settings(reader: DocumentReader) -> dict[str, str]:
    """Return the settings of the first vise in a document, as text by name.

    Raises
    ------
    InputError
        Where there is none.
    """
    owners = sorted(reader.values, key=lambda name: reader.types.get(name) != "App::VarSet")
    for name in owners:
        if {"Opening", "JawHeight"} <= reader.values[name].keys():
            return reader.values[name]
    opens = [name for name in owners if "Opening" in reader.values[name]]
    if opens:
        # The settings may be spread over several sets of variables.
        together: dict[str, str] = {}
        for name in (*opens, *owners):
            together = reader.values[name] | together
        return together
    if any("Kind" in reader.values[name] for name in owners if reader.types.get(name) == "App::VarSet"):
        raise InputError("this is a clamp of FreeCAD's CAM workbench, not a vise: name a file with a vise.")
    raise InputError(
        "this FreeCAD document has no vise of the CAM workbench, no set of variables with Opening and JawHeight: name a "
        "file with one, or describe the vise in a TOML file."
    )


def read_number(settings: dict[str, str], name: str) -> float | None:
    """Return a setting as a number; None where it is not given, or 0.

    Raises
    ------
    InputError
        For anything but a finite number that is not negative.
    """
    if name not in settings:
        return None
    try:
        value = float(settings[name])
    except ValueError:
        value = -1.0
    if not (isfinite(value) and value >= 0.0):
        raise InputError(f"{name} of the vise is {settings[name][:40]!r}, not a number of 0 or more.")
    # FreeCAD keeps lengths with the rounding of its own arithmetic.
    return round(value, 6) or None


def unpack_document(path: Path) -> bytes:
    """Return the document's XML from a FreeCAD file.

    Raises
    ------
    InputError
        For a file that cannot be read or is no FreeCAD document, and for one that is too large unpacked.
    """
    limits = LIMITS["freecad"]
    most = limits.most_bytes or 0
    try:
        refuse_large_file(path, limits)
        with DirectoryCheckedFile(path) as stream, ZipFile(stream) as archive:
            content = bytearray()
            with archive.open(DOCUMENT) as member:
                while block := member.read(BLOCK):
                    content += block
                    if len(content) > most:
                        raise InputError(
                            f"its {DOCUMENT} has more than {most / 1e6:g} MB unpacked: {limits.remedy}."
                        )
        return bytes(content)
    except KeyError as error:
        raise InputError(f"this is an archive without {DOCUMENT}, not a FreeCAD document.") from error
    except (BadZipFile, zlib.error, EOFError, NotImplementedError, RuntimeError, ValueError) as error:
        if isinstance(error, InputError):
            raise
        raise InputError(
            "this is not a FreeCAD document, or it is damaged: save it in FreeCAD again."
        ) from error
    except OSError as error:
        raise InputError(f"the file cannot be read ({(error.strerror or str(error)).lower()}).") from error


def parse_document(content: bytes) -> DocumentReader:
    """Return types and known properties of a document's objects, from its XML.

    Raises
    ------
    InputError
        For XML that is broken, declares a document type or entities, or is larger or deeper than the limits.
    """
    reader = DocumentReader(Budget(LIMITS["freecad"], len(content)))
    parser = expat.ParserCreate()

    def refuse_declarations(*_: object) -> None:
        """Refuse a document type, with which entities and default values could be declared."""
        raise InputError(
            "its XML declares a document type, which FreeCAD does not write: save it there again."
        )

    parser.StartDoctypeDeclHandler = refuse_declarations
    parser.StartElementHandler = reader.handle_start
    parser.EndElementHandler = reader.handle_end
    try:
        parser.Parse(content, True)
    except expat.ExpatError as error:
        raise InputError(
            f"its {DOCUMENT} is not valid XML (line {error.lineno}): save it in FreeCAD again."
        ) from error
    except (ValueError, LookupError) as error:
        if isinstance(error, InputError):
            raise
        raise InputError(
            f"the text encoding of its {DOCUMENT} is not usable: save it in FreeCAD again."
        ) from error
    return reader
