"""The workbench without a window: a fixture stands in the document, and is found again when the part changes."""

from __future__ import annotations

from pathlib import Path

from workbench.scripts import HELD, Scripted


def test_bodies_stand_about_the_part_and_are_found_again(scripted: Scripted) -> None:
    """A longer part keeps its fixture; the document keeps it when it is closed and opened."""
    answer = scripted(
        HELD
        + """
first = fixture.design(held)
before, distance = marks(held), distances(held)
block.Length = 64
document.recompute()
changed = held.State
again = fixture.design(held)
same = marks(held) == before
longer = distances(held)
fixture.choose(held, 10)
other = marks(held)
block.Length = 65
document.recompute()
second = [fixture.design(held), marks(held) == other]
fixture.choose(held, 3)
document.saveAs("held.FCStd")
App.closeDocument("held")
opened = App.openDocument("held.FCStd").getObject("Fixture")
answered(first=first, changed=changed, again=again, same=same, second=second, distance=distance, longer=longer,
         opened=[opened.State, len(opened.Group), isinstance(opened.Proxy, fixture.Fixture)],
         rows=len(fixture.rows(opened)))
"""
    )
    assert answer["first"] == "Fixture 1 of 20."
    assert answer["changed"] == "The part has changed: design again."
    assert (answer["again"], answer["same"]) == ("Fixture 1 of 20.", True)
    # One that is not the first of the list is looked for, too.
    words, same = answer["second"]
    assert same and words.startswith("Fixture ") and words != "Fixture 1 of 20."
    for distances in (answer["distance"], answer["longer"]):
        touching = {name: far for name, far in distances.items() if not name.startswith("bolt")}
        assert len(touching) == 6 and set(touching.values()) == {0.0}
    assert answer["opened"] == ["Fixture 3 of 20.", 8, True]
    assert answer["rows"] == 20


def test_a_fixture_that_is_none_any_more_says_so(scripted: Scripted) -> None:
    answer = scripted(
        HELD
        + """
held.Best = 3
fixture.design(held)
fixture.choose(held, 3)
block.Length, block.Width = 91, 33
document.recompute()
lower = fixture.design(held)
block.Length, block.Width = 50, 30
document.recompute()
lost = fixture.design(held)
fixture.choose(held, 2)
kept = marks(held)
block.Length = 3
document.recompute()
none, bodies = fixture.design(held), len(held.Group)
block.Length = 50
document.recompute()
back = [fixture.design(held), marks(held) == kept]
answered(lower=lower, lost=lost, none=none, bodies=bodies, back=back)
"""
    )
    gone = "The fixture that was chosen is not among the best 3 any more: "
    assert answer["lower"].startswith(gone + "it is number ")
    assert answer["lost"].startswith(gone + "in these holes nothing holds the part as it is now. The first")
    assert answer["none"].startswith("No fixture. ") and answer["bodies"] == 0
    # When something holds the part again, the fixture that was chosen last is looked for.
    assert answer["back"] == ["Fixture 2 of 3.", True]


def test_with_supports_all_bodies_stand_about_the_part(scripted: Scripted, tmp_path: Path) -> None:
    """Also where the set-up stands a column further on than in the list; no two bodies have one name."""
    (tmp_path / "two.toml").write_text(
        'kind = "vise"\nunit = "mm"\npitch = 20\ncolumns = 2\npeg_radius = 3\n'
    )
    answer = scripted(
        """
corners = [App.Vector(*corner) for corner in ((0, 0), (90, 0), (100, 30), (60, 70), (20, 64), (0, 0))]
five = document.addObject("Part::Feature", "Five")
five.Shape = Part.Face(Part.makePolygon(corners)).extrude(App.Vector(0, 0, 12))
five.Placement.Base = App.Vector(300, -40, 8)
document.recompute()
held = []
for supports in (False, True):
    held.append(fixture.make(document, five, "z", "two.toml"))
    held[-1].Supports, held[-1].Best = supports, 1
    fixture.design(held[-1])
plain, with_supports = held
answered(state=with_supports.State, shared=[shared(one) for one in held], near=[distances(one) for one in held])
"""
    )
    assert answer["state"] == "Fixture 1 of 1."
    for volumes in answer["shared"]:
        assert set(volumes.values()) == {0.0}, volumes
    for near in answer["near"]:
        touching = {
            name: far for name, far in near.items() if name.startswith(("peg", "support", "clamp on top"))
        }
        assert len(touching) in (4, 8) and set(touching.values()) == {0.0}, near
    plain, with_supports = answer["near"]
    assert "peg L-B1" in plain and "peg L-A1" in with_supports
    assert not set(plain) & set(with_supports) and "left jaw of Fixture001" in with_supports


def test_what_cannot_be_done_is_a_sentence(scripted: Scripted, tmp_path: Path) -> None:
    answer = scripted(
        """
said = []
def attempt(work):
    try:
        work()
    except child.Refusal as refusal:
        said.append(str(refusal))
held = fixture.make(document, block, "z", "no-such-toolkit")
attempt(lambda: fixture.design(held))
attempt(lambda: fixture.choose(held, 1))
attempt(lambda: child.use("/nowhere"))
block.Placement.Rotation = App.Rotation(App.Vector(1, 1, 0), 30)
document.recompute()
attempt(lambda: solid.axis_of_face(block.Shape.Faces[5]))
held.HeldPart = None
attempt(lambda: fixture.design(held))
answered(said=said)
"""
    )
    toolkit, rank, place, axis, part = answer["said"]
    assert "no-such-toolkit" in toolkit
    assert rank == "There is no fixture 1 in the list: design first."
    assert place.startswith("There is no command workhold in /nowhere")
    assert axis.endswith("turn the part first.")
    assert part == "The fixture holds no part: choose one."


def test_the_sheet_and_a_job_of_the_cam_workbench(scripted: Scripted, tmp_path: Path) -> None:
    """The job's G-code becomes the program that the tools have to pass with."""
    (tmp_path / "job.nc").write_text("G21 G90\nT1 M6\nG0 X112 Y40 Z30\nG1 Z9 F100\nG1 X148\nG0 Z30\nM30\n")
    answer = scripted(
        HELD
        + """
from workhold_workbench import cam
fixture.design(held)
fixture.save_sheet(held, "sheet.pdf")
fixture.save_picture(held, 2, "second.png")
try:
    cam.take_program(held)
except child.Refusal as refusal:
    early = str(refusal)
sent = cam.send(held)
job = cam.job_of(held)
linked = job.Fixture.Name
job.PostProcessorOutputFile = App.ActiveDocument.Name and __import__("os").path.abspath("job.nc")
answered(early=early, sent=sent, taken=cam.take_program(held), tools=open(held.Tools).read(),
         linked=[linked, held.Name], near=fixture.rows(held)[0].get("program_clearance"))
"""
    )
    assert (tmp_path / "sheet.pdf").read_bytes().startswith(b"%PDF")
    assert (tmp_path / "second.png").read_bytes().startswith(b"\x89PNG")
    assert answer["early"].startswith("No job has this part as its model")
    assert answer["sent"].startswith("Job of Block has 8 bodies")
    assert answer["linked"][0] == answer["linked"][1]
    assert answer["taken"].startswith("Fixture ")
    assert answer["tools"].startswith("tool,diameter\n1,")
    # From the first cut to the left side 12 mm, less the radius of the default end mill; holes are never nearer.
    assert 9.5 <= answer["near"] < 11


BRACKET = """
import os, signal
plate = document.addObject("Part::Box", "Plate")
plate.Length, plate.Width, plate.Height = 80, 50, 14
pocket = document.addObject("Part::Box", "Hollow")
pocket.Length, pocket.Width, pocket.Height = 30, 20, 8
pocket.Placement.Base = App.Vector(25, 15, 6)
slanted = document.addObject("Part::Wedge", "Corner")
slanted.Xmin, slanted.Xmax, slanted.X2min, slanted.X2max = 0, 18, 0, 0
slanted.Ymin, slanted.Ymax, slanted.Zmin, slanted.Zmax, slanted.Z2min, slanted.Z2max = 0, 12, 0, 14, 0, 14
bored = document.addObject("Part::Cut", "Bored")
bored.Base, bored.Tool = plate, pocket
bracket = document.addObject("Part::Cut", "Bracket")
bracket.Base, bracket.Tool = bored, slanted
bracket.Placement = App.Placement(App.Vector(-40, 300, 25), App.Rotation(App.Vector(0, 0, 1), 90))
document.recompute()
"""


def test_a_bracket_with_a_pocket_is_held_without_interference(scripted: Scripted) -> None:
    """Before and after a dimension has changed; the bodies touch the part, and none cuts into it."""
    answer = scripted(
        BRACKET
        + """
held = fixture.make(document, bracket, "z", "two-clamp-plate-20mm")
held.PegHeight = 8
first = fixture.design(held)
def seen():
    return dict(volumes=shared(held), near=distances(held), chosen=marks(held),
                low=min(one.Shape.BoundBox.ZMax for one in held.Group if "plate" in one.Label.lower()))
before = seen()
poses = [one["pose"]["theta_deg"] for one in json.loads(held.ResultText)["fixtures"]]
turned = max(range(len(poses)), key=lambda k: abs(poses[k] % 180 - 180 * (poses[k] % 180 > 90)))
fixture.choose(held, turned + 1)
across = seen()
fixture.choose(held, 1)
plate.Width = 54
document.recompute()
changed = held.State
again = fixture.design(held)
answered(first=first, before=before, changed=changed, again=again, after=seen(), across=across,
         turned=poses[turned], foot=bracket.Shape.BoundBox.ZMin)
"""
    )
    assert answer["first"].startswith("Fixture 1 of ")
    assert answer["changed"] == "The part has changed: design again."
    assert answer["again"].startswith(("Fixture ", "The fixture that was chosen is not among"))
    # One in which the part lies turned, neither as drawn nor half round.
    assert answer["turned"] % 180 > 1
    for seen in (answer["before"], answer["across"], answer["after"]):
        assert len(seen["volumes"]) >= 6
        assert set(seen["volumes"].values()) == {0.0}, seen["volumes"]
        touching = [far for name, far in seen["near"].items() if name.startswith(("peg", "locator", "clamp"))]
        assert len(touching) >= 5 and set(touching) == {0.0}, seen["near"]
        # The part lies on the plate.
        assert abs(seen["low"] - answer["foot"]) < 1e-3
    if answer["again"].startswith("Fixture "):
        assert answer["after"]["chosen"] == answer["before"]["chosen"]


def test_what_is_no_prism_is_a_sentence(scripted: Scripted) -> None:
    """A ball, a cone and a body of two solids; the document keeps the fixture that there was."""
    answer = scripted(
        HELD
        + """
ball = document.addObject("Part::Sphere", "Ball")
cone = document.addObject("Part::Cone", "Cone")
both = document.addObject("Part::Compound", "Both")
both.Links = [ball, block]
document.recompute()
fixture.design(held)
bodies = len(held.Group)
said = []
for part in (ball, cone, both):
    held.HeldPart = part
    said.append(said_by(lambda: fixture.design(held)))
answered(said=said, bodies=[bodies, len(held.Group)])
"""
    )
    for sentence in answer["said"]:
        assert sentence.startswith("refused: ") and sentence.endswith(".") and "Traceback" not in sentence
    ball, cone, both = answer["said"]
    assert "upright" in ball and "upright" in cone, answer["said"]
    # In the words of the panel: no option of the command, and no name of a file.
    assert ball.startswith("refused: Ball: ") and "--" not in ball + cone
    assert both == "refused: Both has 2 solids: choose a body with one."
    assert answer["bodies"][0] == answer["bodies"][1] == 8


def test_a_child_that_is_killed_leaves_freecad_alive(scripted: Scripted) -> None:
    """By a signal that it cannot hear, in the middle of a search; the next design works."""
    answer = scripted(
        HELD
        + """
import os, signal
first = fixture.design(held)
killed = []
def kill():
    for entry in os.listdir("/proc"):
        if entry.isdigit() and not killed:
            try:
                parent = open("/proc/%s/stat" % entry).read().rpartition(")")[2].split()[1]
            except OSError:
                continue
            if int(parent) == os.getpid():
                killed.append(int(entry))
                os.kill(int(entry), signal.SIGKILL)
said = said_by(lambda: fixture.design(held, wait=kill))
kept = [held.State, len(held.Group), len(fixture.rows(held))]
again = fixture.design(held)
answered(first=first, killed=len(killed), said=said, kept=kept, again=again)
"""
    )
    assert answer["killed"] == 1
    assert answer["said"] == "refused: Workhold was ended before it had an answer: choose the command again."
    assert answer["kept"] == [answer["first"], 8, 20]
    assert answer["again"] == answer["first"]


def test_a_design_is_one_child_and_speaks_the_words_of_the_panel(scripted: Scripted) -> None:
    """With faces named, supports and pictures, too; what is said of the reading names no option."""
    answer = scripted(
        """
import types
said, started = [], []
child.App = types.SimpleNamespace(
    ParamGet=App.ParamGet, Console=types.SimpleNamespace(PrintMessage=said.append)
)
begin = child.subprocess.Popen
child.subprocess.Popen = lambda words, **more: started.append(words[1:]) or begin(words, **more)
held = fixture.make(document, block, "z", "two-clamp-plate-20mm")
held.PegHeight, held.Supports, held.Best = 8, True, 20
fixture.design(held, pictures=True)
plain = len(started)
fixture.choose(held, 2)
chosen, pages = marks(held), [held.Paged]
names = ["Face%d" % k for k, face in enumerate(block.Shape.Faces, 1) if abs(face.normalAt(0, 0).z) < 0.5]
started.clear()
held.Only = names
again = fixture.design(held, pictures=True)
answered(plain=plain, started=len(started), said=said, again=again, same=marks(held) == chosen,
         pages=[*pages, held.Paged], size=len(open(held.Page, "rb").read()))
"""
    )
    assert (answer["plain"], answer["started"]) == (1, 1)
    assert answer["again"].startswith("Fixture 2 of 20.") and answer["same"]
    # The picture is of what stands in the document, as long as it does.
    assert answer["pages"] == [1, 2] and answer["size"] > 10_000
    assert answer["said"] and not any("--" in one or one.startswith("workhold:") for one in answer["said"])
    assert answer["said"][0].startswith("The part is 12 mm high along z; the outline is what pegs of 8 mm")


def test_a_search_that_is_stopped_says_so(scripted_as_installed: Scripted) -> None:
    """At once nothing is found, and the fixture that there was stays; of a list that is not whole the state says so."""
    answer = scripted_as_installed(
        HELD
        + """
import threading
first = fixture.design(held)
stop = threading.Event()
said = said_by(lambda: fixture.design(held, cancel=stop, wait=stop.set))
bodies = len(held.Group)
whole = fixture.ordered
fixture.ordered = lambda *words, **order: {**whole(*words, **order), "complete": False}
answered(first=first, said=said, bodies=bodies, partly=fixture.design(held))
"""
    )
    assert answer["first"] == "Fixture 1 of 20." and answer["bodies"] == 8
    assert answer["said"].startswith("refused: ") or answer["said"].endswith("there may be better ones.")
    assert (
        answer["partly"]
        == "Fixture 1 of 20. The search was stopped before its end: there may be better ones."
    )
