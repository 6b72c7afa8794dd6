"""The task panel: what is asked of a fixture, the list of what was found, and pictures of the first choices.

It is made for the width that the dock has at first: fields go below their names, and buttons stand two by two.
"""

import json
import tempfile
import threading
from pathlib import Path

import FreeCADGui as Gui
from PySide import QtCore, QtGui

from . import fixture
from .child import Refusal, answer
from .compat import button_number
from .pictures import FirstChoices, Picture
from .solid import body_of

__all__ = ["Panel"]

# The figures of the list, with their headings in two lines; the others stand on the sheet.
FIGURES = (
    ("warnings", "warnings\n"),
    ("penalty", "penalty\n"),
    ("clamp_amplification", "largest\nforce"),
    ("location_error", "location\nerror mm"),
    ("edge_distance", "edge dis-\ntance mm"),
    ("program_clearance", "program\nclearance mm"),
)
# Of the toolkit's name in letters, of a row of the list in pixels, of the list in rows, and of a field in pixels.
LEAST_LETTERS, ROW_HEIGHT, LEAST_ROWS = 16, 24, 7
LEAST_FIELD = 84
MARK_WIDTH = 18


def tr(text):
    """The text in the language of the window, where a translation is installed."""
    return QtCore.QCoreApplication.translate("Workhold", text)


class Panel:
    """The panel of one fixture object; FreeCAD asks for ``form`` and calls ``accept`` and ``reject``."""

    def __init__(self, obj):
        self.obj = obj
        self.cancel = threading.Event()
        self.busy, self.closed = False, False
        self.form = QtGui.QWidget()
        self.form.setWindowTitle(tr("Fixture of {}").format(obj.HeldPart.Label if obj.HeldPart else "?"))
        column = QtGui.QVBoxLayout(self.form)
        column.addLayout(self.questions())
        column.addLayout(self.buttons())
        self.state = QtGui.QLabel(obj.State)
        self.state.setWordWrap(True)
        # A long word, such as a path, is cut off rather than that all becomes wider.
        self.state.setSizePolicy(QtGui.QSizePolicy.Ignored, QtGui.QSizePolicy.Preferred)
        column.addWidget(self.state)
        self.first = FirstChoices(self.select, self.put_in)
        column.addWidget(self.first)
        column.addWidget(self.list_of_all())
        self.picture = Picture()
        column.addWidget(self.picture)
        self.fill()

    def questions(self):
        """The fields: toolkit, axis, peg height, faces, supports."""
        form = QtGui.QFormLayout()
        form.setRowWrapPolicy(QtGui.QFormLayout.WrapLongRows)
        form.setFieldGrowthPolicy(QtGui.QFormLayout.AllNonFixedFieldsGrow)
        self.toolkit = QtGui.QComboBox()
        self.toolkit.setEditable(True)
        self.toolkit.setSizeAdjustPolicy(QtGui.QComboBox.AdjustToMinimumContentsLengthWithIcon)
        self.toolkit.setMinimumContentsLength(LEAST_LETTERS)
        try:
            for one in answer("toolkits")["toolkits"]:
                self.toolkit.addItem(one["name"])
                self.toolkit.setItemData(self.toolkit.count() - 1, one["title"], QtCore.Qt.ToolTipRole)
        except Refusal as refusal:
            self.obj.State = str(refusal)
        self.toolkit.setEditText(self.obj.Toolkit)
        self.toolkit.lineEdit().setCursorPosition(0)
        form.addRow(tr("Toolkit"), self.toolkit)
        self.up = QtGui.QComboBox()
        self.up.addItems(fixture.AXIS_NAMES)
        self.up.setCurrentIndex(fixture.AXIS_NAMES.index(self.obj.Up))
        form.addRow(tr("Up"), self.up)
        self.height = Gui.UiLoader().createWidget("Gui::InputField")
        self.height.setProperty("unit", "mm")
        self.height.setProperty("quantity", self.obj.PegHeight)
        self.height.setToolTip(
            tr("Height that pegs reach above the plane on which the part lies; 0 is all of the part")
        )
        form.addRow(tr("Peg height"), self.height)
        self.faces = {}
        for name, words in (("Avoid", tr("Do not touch")), ("Only", tr("Touch only"))):
            row = QtGui.QHBoxLayout()
            self.faces[name] = QtGui.QLineEdit(", ".join(getattr(self.obj, name)))
            self.faces[name].setToolTip(tr("Click faces of the part in the window, then press the button"))
            self.faces[name].setMinimumWidth(LEAST_FIELD)
            row.addWidget(self.faces[name])
            button = QtGui.QPushButton(tr("Selected faces"))
            button.clicked.connect(lambda checked=False, name=name: self.take_selected(name))
            row.addWidget(button)
            form.addRow(words, row)
        self.supports = QtGui.QCheckBox(tr("Supports, clamp on top"))
        self.supports.setToolTip(tr("Three supports under the part, and the best place of a clamp on top"))
        self.supports.setChecked(self.obj.Supports)
        form.addRow(self.supports)
        return form

    def buttons(self):
        """The buttons, two by two."""
        grid = QtGui.QGridLayout()
        for k, (words, tip, called) in enumerate(
            (
                (tr("Design"), tr("Find every fixture"), self.design),
                (tr("Stop"), tr("End the search; the fixtures found so far are kept"), self.cancel.set),
                (tr("Put in"), tr("Put the selected fixture into the document as bodies"), self.put_in),
                (tr("Sheet ..."), tr("Write the setup sheet of the fixture in the document"), self.sheet),
            )
        ):
            button = QtGui.QPushButton(words)
            button.setToolTip(tip)
            button.clicked.connect(lambda checked=False, called=called: called())
            grid.addWidget(button, k // 2, k % 2)
        return grid

    def list_of_all(self):
        """The table of all fixtures that are kept; it sorts by each column."""
        self.table = QtGui.QTableWidget(0, 0)
        self.table.setSelectionBehavior(QtGui.QAbstractItemView.SelectRows)
        self.table.setSelectionMode(QtGui.QAbstractItemView.SingleSelection)
        self.table.setEditTriggers(QtGui.QAbstractItemView.NoEditTriggers)
        self.table.setSortingEnabled(True)
        self.table.verticalHeader().hide()
        self.table.verticalHeader().setDefaultSectionSize(ROW_HEIGHT)
        self.table.setMinimumHeight(LEAST_ROWS * ROW_HEIGHT)
        self.table.itemSelectionChanged.connect(self.show_picture)
        self.table.itemDoubleClicked.connect(lambda item: self.put_in())
        return self.table

    def take_selected(self, name):
        """Takes the faces of the part that are selected in the window."""
        part = self.obj.HeldPart
        names = [
            face
            for chosen in Gui.Selection.getSelectionEx()
            if part is not None and body_of(chosen.Object) == body_of(part)
            for face in chosen.SubElementNames
            if face.startswith("Face")
        ]
        self.faces[name].setText(", ".join(names))
        if not names:
            words = tr("No face of {} is selected: click faces in the window, then press the button again.")
            self.state.setText(words.format(part.Label if part is not None else "?"))

    def read(self):
        """Hands the fields over to the object."""
        obj = self.obj
        obj.Toolkit = self.toolkit.currentText().strip()
        obj.Up = self.up.currentText()
        obj.PegHeight = self.height.property("quantity")
        obj.Supports = self.supports.isChecked()
        for name, field in self.faces.items():
            setattr(obj, name, [word.strip() for word in field.text().split(",") if word.strip()])

    def attempt(self, work, name):
        """Does something that can be undone under a name, and says in the panel why it could not be done."""
        if self.busy:
            return
        self.busy = True
        Gui.getMainWindow().setCursor(QtCore.Qt.WaitCursor)
        document = self.obj.Document
        document.openTransaction(name)
        try:
            work()
        except Refusal as refusal:
            self.state.setText(str(refusal))
        else:
            self.state.setText(self.obj.State)
        finally:
            document.commitTransaction()
            Gui.getMainWindow().unsetCursor()
            self.busy = False

    def design(self):
        """Searches, with a window that stays alive."""
        if self.busy:
            return
        self.cancel.clear()
        self.state.setText(tr("Searching ..."))

        def work():
            self.read()
            fixture.design(self.obj, self.cancel, QtGui.QApplication.processEvents, pictures=True)

        self.attempt(work, "Design fixture")
        if not self.closed:
            self.fill()

    def fill(self):
        """Writes the list into the table; numbers sort as numbers."""
        rows = fixture.rows(self.obj)
        shown = [(name, words) for name, words in FIGURES if rows and name in rows[0]]
        self.table.blockSignals(True)
        self.table.setSortingEnabled(False)
        self.table.setColumnCount(2 + len(shown))
        self.table.setHorizontalHeaderLabels([tr("rank"), tr("type"), *(tr(words) for _, words in shown)])
        self.table.setRowCount(len(rows))
        for k, row in enumerate(rows):
            for column, value in enumerate([row["rank"], row["type"], *(row[name] for name, _ in shown)]):
                item = QtGui.QTableWidgetItem()
                number = round(value, 3) if isinstance(value, float) else value
                item.setData(QtCore.Qt.DisplayRole, number)
                self.table.setItem(k, column, item)
        self.table.resizeColumnsToContents()
        # The mark of sorting takes room of its own.
        self.table.setColumnWidth(0, self.table.columnWidth(0) + MARK_WIDTH)
        self.table.setSortingEnabled(True)
        self.table.sortItems(0)
        self.table.clearSelection()
        self.table.blockSignals(False)
        drawn = self.obj.Glance if self.obj.Glanced else ""
        self.first.fill(drawn if rows else "", json.loads(self.obj.Glanced or "[]"))
        self.picture.fill("" if rows else drawn)
        self.picture.setToolTip("" if rows else tr("The nearest miss"))
        if rows and self.obj.Chosen <= len(rows):
            self.table.selectRow(self.obj.Chosen - 1)

    def select(self, rank):
        """Selects the row of a rank, wherever it is sorted to."""
        for row in range(self.table.rowCount()):
            if int(self.table.item(row, 0).text()) == rank:
                self.table.selectRow(row)

    def rank(self):
        """The rank of the selected row; None where there is none."""
        row = self.table.currentRow()
        return None if row < 0 else int(self.table.item(row, 0).text())

    def show_picture(self):
        """Draws the selected fixture."""
        rank = self.rank()
        if rank is None:
            return
        self.first.mark(rank)
        if rank == self.obj.Paged:
            self.show_page(rank, self.obj.Page)
            return
        with tempfile.TemporaryDirectory() as folder:
            path = Path(folder) / "fixture.png"
            try:
                fixture.save_picture(self.obj, rank, path)
            except Refusal as refusal:
                self.state.setText(str(refusal))
                return
            self.show_page(rank, str(path))

    def show_page(self, rank, path):
        """Shows the picture of the fixture of a rank."""
        self.picture.fill(path)
        self.picture.setToolTip(tr("Fixture {}: click to see the whole picture").format(rank))

    def put_in(self):
        """Puts the selected fixture into the document."""
        rank = self.rank()
        if rank is not None:

            def work():
                self.obj.Supports = self.supports.isChecked()
                fixture.choose(self.obj, rank)

            self.attempt(work, "Put fixture in")

    def sheet(self):
        """Asks for a path and writes the setup sheet."""
        path, _ = QtGui.QFileDialog.getSaveFileName(
            self.form,
            tr("Setup sheet"),
            "{}.pdf".format(self.obj.Label),
            "PDF (*.pdf);;SVG (*.svg);;PNG (*.png)",
        )
        if path:
            self.attempt(lambda: fixture.save_sheet(self.obj, path), "Setup sheet")

    def getStandardButtons(self):
        """Only the button that closes the panel."""
        return button_number(QtGui.QDialogButtonBox.Close)

    def reject(self):
        """Closes the panel; what was put in stays."""
        self.cancel.set()
        self.closed = True
        Gui.Control.closeDialog()
        self.obj.Document.recompute()

    accept = reject
