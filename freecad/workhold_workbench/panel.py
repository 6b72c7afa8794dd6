"""The task panel: what is asked of a fixture, the list of what was found, and a picture of the chosen one."""

import tempfile
import threading
from pathlib import Path

import FreeCAD as App
import FreeCADGui as Gui
from PySide import QtCore, QtGui

from . import fixture
from .child import Refusal, answer
from .compat import button_number

__all__ = ["Panel"]

# The figures of the list, with their headings; the others stand on the sheet.
FIGURES = (
    ("warnings", "warnings"),
    ("penalty", "penalty"),
    ("clamp_amplification", "largest force"),
    ("location_error", "location error mm"),
    ("edge_distance", "edge distance mm"),
    ("program_clearance", "program clearance mm"),
)
PICTURE_WIDTH = 420
LEAST_WIDTH = 460
MARK_WIDTH = 24


def tr(text):
    """The text in the language of the window, where a translation is installed."""
    return QtCore.QCoreApplication.translate("Workhold", text)


class Panel:
    """The panel of one fixture object; FreeCAD asks for ``form`` and calls ``accept`` and ``reject``."""

    def __init__(self, obj):
        self.obj = obj
        self.cancel = threading.Event()
        self.form = QtGui.QWidget()
        self.form.setMinimumWidth(LEAST_WIDTH)
        self.form.setWindowTitle(tr("Fixture of {}").format(obj.HeldPart.Label if obj.HeldPart else "?"))
        column = QtGui.QVBoxLayout(self.form)
        column.addLayout(self.questions())
        column.addLayout(self.buttons())
        self.state = QtGui.QLabel(obj.State)
        self.state.setWordWrap(True)
        column.addWidget(self.state)
        self.table = QtGui.QTableWidget(0, 0)
        self.table.setSelectionBehavior(QtGui.QAbstractItemView.SelectRows)
        self.table.setSelectionMode(QtGui.QAbstractItemView.SingleSelection)
        self.table.setEditTriggers(QtGui.QAbstractItemView.NoEditTriggers)
        self.table.setSortingEnabled(True)
        self.table.verticalHeader().hide()
        self.table.itemSelectionChanged.connect(self.show_picture)
        self.table.itemDoubleClicked.connect(lambda item: self.put_in())
        column.addWidget(self.table)
        self.picture = QtGui.QLabel()
        self.picture.setAlignment(QtCore.Qt.AlignCenter)
        column.addWidget(self.picture)
        self.fill()

    def questions(self):
        """The fields: toolkit, axis, peg height, faces, supports."""
        grid = QtGui.QFormLayout()
        self.toolkit = QtGui.QComboBox()
        self.toolkit.setEditable(True)
        try:
            for one in answer("toolkits")["toolkits"]:
                self.toolkit.addItem(one["name"])
                self.toolkit.setItemData(self.toolkit.count() - 1, one["title"], QtCore.Qt.ToolTipRole)
        except Refusal as refusal:
            self.obj.State = str(refusal)
        self.toolkit.setEditText(self.obj.Toolkit)
        grid.addRow(tr("Toolkit"), self.toolkit)
        self.up = QtGui.QComboBox()
        self.up.addItems(fixture.AXIS_NAMES)
        self.up.setCurrentIndex(fixture.AXIS_NAMES.index(self.obj.Up))
        grid.addRow(tr("Up"), self.up)
        self.height = Gui.UiLoader().createWidget("Gui::InputField")
        self.height.setProperty("unit", "mm")
        self.height.setProperty("quantity", self.obj.PegHeight)
        grid.addRow(tr("Peg height (0: all of the part)"), self.height)
        self.faces = {}
        for name, words in (("Avoid", tr("Do not touch")), ("Only", tr("Touch only"))):
            row = QtGui.QHBoxLayout()
            self.faces[name] = QtGui.QLineEdit(", ".join(getattr(self.obj, name)))
            row.addWidget(self.faces[name])
            button = QtGui.QPushButton(tr("Selected faces"))
            button.clicked.connect(lambda checked=False, name=name: self.take_selected(name))
            row.addWidget(button)
            grid.addRow(words, row)
        self.supports = QtGui.QCheckBox(tr("Three supports and a clamp on top"))
        self.supports.setChecked(self.obj.Supports)
        grid.addRow("", self.supports)
        return grid

    def buttons(self):
        """The row of buttons."""
        row = QtGui.QHBoxLayout()
        for words, called in (
            (tr("Design"), self.design),
            (tr("Stop"), self.cancel.set),
            (tr("Put in"), self.put_in),
            (tr("Sheet ..."), self.sheet),
        ):
            button = QtGui.QPushButton(words)
            button.clicked.connect(lambda checked=False, called=called: called())
            row.addWidget(button)
        return row

    def take_selected(self, name):
        """Takes the faces of the part that are selected in the window."""
        names = [
            face
            for chosen in Gui.Selection.getSelectionEx()
            if chosen.Object == self.obj.HeldPart
            for face in chosen.SubElementNames
            if face.startswith("Face")
        ]
        self.faces[name].setText(", ".join(names))

    def read(self):
        """Hands the fields over to the object."""
        obj = self.obj
        obj.Toolkit = self.toolkit.currentText().strip()
        obj.Up = self.up.currentText()
        obj.PegHeight = self.height.property("quantity")
        obj.Supports = self.supports.isChecked()
        for name, field in self.faces.items():
            setattr(obj, name, [word.strip() for word in field.text().split(",") if word.strip()])

    def attempt(self, work):
        """Does something, and says in the panel why it could not be done."""
        Gui.getMainWindow().setCursor(QtCore.Qt.WaitCursor)
        try:
            work()
        except Refusal as refusal:
            self.state.setText(str(refusal))
        else:
            self.state.setText(self.obj.State)
        finally:
            Gui.getMainWindow().unsetCursor()

    def design(self):
        """Searches, with a window that stays alive."""
        self.cancel.clear()
        self.state.setText(tr("Searching ..."))

        def work():
            self.read()
            fixture.design(self.obj, self.cancel, QtGui.QApplication.processEvents)

        self.attempt(work)
        self.fill()

    def fill(self):
        """Writes the list into the table; numbers sort as numbers."""
        rows = fixture.rows(self.obj)
        shown = [(name, words) for name, words in FIGURES if rows and name in rows[0]]
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
        if rows and self.obj.Chosen <= len(rows):
            self.table.selectRow(self.obj.Chosen - 1)

    def rank(self):
        """The rank of the selected row; None where there is none."""
        row = self.table.currentRow()
        return None if row < 0 else int(self.table.item(row, 0).text())

    def show_picture(self):
        """Draws the selected fixture."""
        rank = self.rank()
        if rank is None:
            return
        with tempfile.TemporaryDirectory() as folder:
            path = Path(folder) / "fixture.png"
            try:
                fixture.save_picture(self.obj, rank, path)
            except Refusal as refusal:
                self.state.setText(str(refusal))
                return
            drawn = QtGui.QPixmap(str(path))
        self.picture.setPixmap(drawn.scaledToWidth(PICTURE_WIDTH, QtCore.Qt.SmoothTransformation))

    def put_in(self):
        """Puts the selected fixture into the document."""
        rank = self.rank()
        if rank is not None:

            def work():
                self.obj.Supports = self.supports.isChecked()
                fixture.choose(self.obj, rank)

            self.attempt(work)

    def sheet(self):
        """Asks for a path and writes the setup sheet."""
        path, _ = QtGui.QFileDialog.getSaveFileName(
            self.form,
            tr("Setup sheet"),
            "{}.pdf".format(self.obj.Label),
            "PDF (*.pdf);;SVG (*.svg);;PNG (*.png)",
        )
        if path:
            self.attempt(lambda: fixture.save_sheet(self.obj, path))

    def getStandardButtons(self):
        """Only the button that closes the panel."""
        return button_number(QtGui.QDialogButtonBox.Close)

    def reject(self):
        """Closes the panel; what was put in stays."""
        self.cancel.set()
        Gui.Control.closeDialog()
        App.ActiveDocument.recompute()

    accept = reject
