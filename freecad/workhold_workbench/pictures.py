"""Pictures in the task panel: the first choices side by side, and the one that is looked at.

They are files that the command ``workhold`` draws: a sheet of thumbnails, and a page with a plan and words
beside it. A dock is narrow, so the thumbnails are cut out of their sheet, and the plan out of its page.
"""

from PySide import QtCore, QtGui

__all__ = ["FirstChoices", "Picture"]

ICON = QtCore.QSize(104, 78)
# Room for the caption of a thumbnail and the bar to scroll by, in pixels.
BELOW = 38
LEAST_WIDTH, MOST_WIDTH = 60, 420
# The words of a page take this many units at its right side, of the units of its width: landscape, portrait.
WORDS, ACROSS = 382.0, (1188.0, 840.0)
# A thumbnail that is looked at, of pixels, and what is white of it.
LOOKED_AT, WHITE = 160, 250


class FirstChoices(QtGui.QListWidget):
    """Thumbnails of the first choices in a row; each knows its rank.

    Parameters
    ----------
    chosen : called with the rank of the one that was clicked.
    put_in : called after a double click.
    """

    def __init__(self, chosen, put_in):
        super().__init__()
        self.setViewMode(QtGui.QListView.IconMode)
        self.setMovement(QtGui.QListView.Static)
        self.setWrapping(False)
        self.setIconSize(ICON)
        self.setFixedHeight(ICON.height() + BELOW)
        self.setHorizontalScrollMode(QtGui.QAbstractItemView.ScrollPerPixel)
        self.itemClicked.connect(lambda item: chosen(item.data(QtCore.Qt.UserRole)))
        self.itemDoubleClicked.connect(lambda item: put_in())
        self.hide()

    def fill(self, path, choices):
        """Shows the thumbnails of a sheet.

        Parameters
        ----------
        path : of the sheet's picture.
        choices : for each its ``rank``, how many are ``like`` it, and its ``box`` as parts of the sheet.
        """
        self.clear()
        sheet = QtGui.QPixmap(path) if path else QtGui.QPixmap()
        self.setVisible(bool(choices) and not sheet.isNull())
        if sheet.isNull():
            return
        for one in choices:
            x, y, width, height = one["box"]
            cut = sheet.copy(
                int(x * sheet.width()),
                int(y * sheet.height()),
                int(width * sheet.width()),
                int(height * sheet.height()),
            )
            drawn = without_margin(cut).scaled(
                ICON, QtCore.Qt.KeepAspectRatio, QtCore.Qt.SmoothTransformation
            )
            words = "{}, +{} like it".format(one["rank"], one["like"]) if one["like"] else str(one["rank"])
            item = QtGui.QListWidgetItem(QtGui.QIcon(drawn), words)
            item.setData(QtCore.Qt.UserRole, one["rank"])
            self.addItem(item)

    def mark(self, rank):
        """Marks the thumbnail of a rank, if there is one."""
        for row in range(self.count()):
            self.item(row).setSelected(self.item(row).data(QtCore.Qt.UserRole) == rank)


class Picture(QtGui.QLabel):
    """The plan of a picture, as wide as the panel; a click shows the whole page in a window."""

    def __init__(self):
        super().__init__()
        self.setAlignment(QtCore.Qt.AlignCenter)
        self.setSizePolicy(QtGui.QSizePolicy.Ignored, QtGui.QSizePolicy.Minimum)
        self.setCursor(QtCore.Qt.PointingHandCursor)
        self.page, self.plan = None, None

    def fill(self, path):
        """Shows the picture of a path; none takes away what was shown."""
        page = QtGui.QPixmap(path) if path else QtGui.QPixmap()
        self.clear()
        self.page, self.plan = (None, None) if page.isNull() else (page, plan_of(page))
        self.fit()

    def fit(self):
        """Scales the plan to the width that there is."""
        if self.plan is not None:
            width = min(max(self.width(), LEAST_WIDTH), MOST_WIDTH)
            self.setPixmap(self.plan.scaledToWidth(width, QtCore.Qt.SmoothTransformation))

    def resizeEvent(self, event):
        """Called by Qt when the panel has become narrower or wider."""
        super().resizeEvent(event)
        self.fit()

    def mouseReleaseEvent(self, event):
        """Called by Qt after a click: shows the whole page."""
        if self.page is None:
            return
        window = QtGui.QDialog(self)
        window.setWindowTitle(self.toolTip() or "Workhold")
        shown = QtGui.QLabel(window)
        room = QtGui.QApplication.primaryScreen().availableSize() * 0.8
        shown.setPixmap(self.page.scaled(room, QtCore.Qt.KeepAspectRatio, QtCore.Qt.SmoothTransformation))
        QtGui.QVBoxLayout(window).addWidget(shown)
        window.show()


def plan_of(page):
    """The plan of a page without the words beside it."""
    units = ACROSS[page.width() <= page.height()]
    return without_margin(page.copy(0, 0, int(page.width() * (1.0 - WORDS / units)), page.height()))


def without_margin(drawn):
    """A picture without its white margin."""
    small = drawn.scaledToWidth(LOOKED_AT).toImage()
    inked = [
        (x, y)
        for x in range(small.width())
        for y in range(small.height())
        if QtGui.QColor(small.pixel(x, y)).lightness() < WHITE
    ]
    if not inked:
        return drawn
    scale = drawn.width() / float(small.width())
    left, right = min(x for x, _ in inked) - 1, max(x for x, _ in inked) + 2
    top, low = min(y for _, y in inked) - 1, max(y for _, y in inked) + 2
    return drawn.copy(
        int(max(left, 0) * scale),
        int(max(top, 0) * scale),
        int((min(right, small.width()) - max(left, 0)) * scale),
        int((min(low, small.height()) - max(top, 0)) * scale),
    )
