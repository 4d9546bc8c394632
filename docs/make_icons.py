"""Draws the icons of the FMUs and the pictures of their documentation: fmu_src/inertia_module/fmu/pictures.

Kinematic schemes in section, x along the central axis, in units of the icon, a square from -100 to 100.
"""

import sys
from pathlib import Path

from matplotlib.figure import Figure
from matplotlib.patches import Circle, Polygon, Rectangle
from PIL import Image

from inertia_module.common.colours import BLACK, BLUE, GREEN, GREY, ORANGE, PURPLE, SKY, VERMILION
from inertia_module.fmi.results import write_figure

TARGET = Path(__file__).parent.parent / "fmu_src" / "inertia_module" / "fmu" / "pictures"
AMBER = "#F2C500"  # rollers of a freewheel
# of names, dark enough to be read on white
DARK_BLUE, DARK_SKY, DARK_RED, DARK_AMBER, DARK_GREEN, DARK_PURPLE = (
    "#005a8e",
    "#1f6f9f",
    "#a84a00",
    "#8a5f00",
    "#00704f",
    "#8f4470",
)
EDGE = {"edgecolor": BLACK, "linewidth": 0.7}
# height of the central axis, radius of shafts
AXIS, SHAFT = -18.0, 7.0
# pixels of the icon, and inches of it at 100 pixels an inch
ICON, INCHES = 200, 2.0
NOTE = {"ha": "center", "va": "center", "fontsize": 11}


class Drawing:
    """Axes in units of the icon, shapes on them."""

    def __init__(self, axes, left=-100, right=100, low=-100, high=100):
        self.axes = axes
        axes.set_xlim(left, right)
        axes.set_ylim(low, high)
        axes.set_axis_off()

    @classmethod
    def sheet(cls, left, right, low, high, scale):
        """A figure of its own: at scale 1 a unit is a pixel."""
        size = INCHES / ICON * scale
        figure = Figure(figsize=((right - left) * size, (high - low) * size), dpi=ICON / INCHES)
        return cls(figure.add_axes((0, 0, 1, 1)), left, right, low, high)

    def box(self, left, right, low, high, colour):
        self.axes.add_patch(Rectangle((left, low), right - left, high - low, facecolor=colour, **EDGE))

    def shape(self, colour, *corners):
        self.axes.add_patch(Polygon(corners, facecolor=colour, **EDGE))

    def ball(self, x, y, radius, colour):
        self.axes.add_patch(Circle((x, y), radius, facecolor=colour, **EDGE))

    def ground(self, left, right, y):
        """Hatched from below: it does not turn."""
        self.axes.plot([left, right], [y, y], color=BLACK, linewidth=1.6)
        for n in range(int(left), int(right) - 5, 8):
            self.axes.plot([n, n + 7], [y - 8, y], color=BLACK, linewidth=0.9)

    def freewheel(self, left, right, colour):
        """Rollers between the shaft and a race of a colour, above and below the axis."""
        roller = (right - left) / 2.0
        for side in (-1.0, 1.0):
            inner, outer = (AXIS + side * (SHAFT + reach) for reach in (2.0 * roller, 2.0 * roller + 7.0))
            self.box(left - 2.0, right + 2.0, min(inner, outer), max(inner, outer), colour)
            self.ball(left + roller, AXIS + side * (SHAFT + roller), roller, AMBER)
        return AXIS - SHAFT - 2.0 * roller - 7.0

    def line(self, *points, width):
        self.axes.plot(*zip(*points, strict=True), color=BLACK, linewidth=width, solid_joinstyle="round")

    def axis_line(self, left, right, y):
        self.axes.plot([left, right], [y, y], color=BLACK, linewidth=0.8, dashes=(9, 3, 2, 3))

    def name(self, x, y, text, colour, at=None):
        """A name, with a line from it to what it names."""
        style = NOTE | {"color": colour}
        if at is None:
            self.axes.text(x, y, text, **style)
        else:
            line = {"arrowstyle": "-", "color": BLACK, "linewidth": 0.9, "shrinkB": 0}
            self.axes.annotate(text, at, (x, y), arrowprops=line, **style)
            self.axes.plot(*at, "o", color=BLACK, markersize=3)


def module(drawing):
    """Link 1 with one module, link 2, both freewheels, the output shaft."""
    # link 1: input shaft, bracket that carries wheel 17 and the bearing of the drive
    drawing.box(-100, -82, AXIS - SHAFT, AXIS + SHAFT, BLUE)
    drawing.box(-82, -72, AXIS - 14, AXIS + 108, BLUE)
    drawing.box(-72, -20, AXIS + 98, AXIS + 108, BLUE)
    drawing.box(-72, -20, AXIS - 5, AXIS + 5, BLUE)
    # drive 16: its shaft in the bracket, its wheel on wheel 2, the arm of the satellite
    drawing.box(-37, -27, AXIS + 5, AXIS + 112, SKY)
    drawing.box(-27, 1, AXIS + 31, AXIS + 38, SKY)
    drawing.shape(SKY, (-56, AXIS + 92), (-8, AXIS + 92), (4, AXIS + 78), (-68, AXIS + 78))
    # satellite 6, its pitch cone on that of wheel 17 (Q is their common apex), and its imbalance
    q, inner, outer = AXIS + 34.5, (17.0, 10.0), (31.0, 18.5)
    corners = ((-1, inner), (1, inner), (1, outer), (-1, outer))
    drawing.shape(BLUE, *((side * x - 32, q - y) for side, (x, y) in corners))
    drawing.box(-63, -1, AXIS + 5, q - outer[1], BLUE)
    drawing.shape(ORANGE, *((x - 32, q + side * y) for side, (x, y) in corners))
    drawing.ball(-8, q + 21, 10.5, VERMILION)
    # link 2: wheel 2 and its shaft
    drawing.box(16, 76, AXIS - SHAFT, AXIS + SHAFT, GREEN)
    drawing.shape(GREEN, (4, AXIS + 78), (16, AXIS + 67), (16, AXIS - 67), (4, AXIS - 78))
    # freewheels: to the housing, to the output shaft
    foot = drawing.freewheel(27, 42, GREY)
    drawing.box(30, 39, AXIS - 66, foot, GREY)
    drawing.ground(19, 51, AXIS - 66)
    drawing.freewheel(55, 70, PURPLE)
    drawing.box(72, 82, AXIS - SHAFT - 22, AXIS + SHAFT + 22, PURPLE)
    drawing.box(82, 100, AXIS - SHAFT, AXIS + SHAFT, PURPLE)


def driven_shaft(drawing):
    """Hub, shaft as a spring with its damper, driven mass."""
    drawing.box(-100, -76, AXIS - SHAFT, AXIS + SHAFT, PURPLE)
    drawing.box(-76, -56, AXIS - 48, AXIS + 48, PURPLE)
    drawing.box(48, 76, AXIS - 76, AXIS + 76, PURPLE)
    drawing.box(76, 100, AXIS - SHAFT, AXIS + SHAFT, PURPLE)
    spring, damper = AXIS + 22, AXIS - 24
    turns = [(-40 + 8 * n, spring + 13 * (-1) ** n) for n in range(10)]
    drawing.line((-56, spring), (-46, spring), *turns, (38, spring), (48, spring), width=2.4)
    drawing.line((-56, damper), (4, damper), width=2.4)
    drawing.line((4, damper + 11), (4, damper - 11), width=3.4)
    drawing.line((18, damper + 16), (-22, damper + 16), width=2.0)
    drawing.line((-22, damper - 16), (18, damper - 16), width=2.0)
    drawing.line((18, damper + 16), (18, damper - 16), width=2.0)
    drawing.line((18, damper), (48, damper), width=2.4)


def module_named(drawing):
    """The module with the names of its parts."""
    drawing.axis_line(-128, 128, AXIS)
    module(drawing)
    drawing.name(-108, 40, "carrier\n(link 1)", DARK_BLUE, (-77, 24))
    drawing.name(-114, -2, "input\nshaft", DARK_BLUE)
    drawing.name(-66, -64, "gear 17,\nfixed to the carrier", DARK_BLUE, (-52, AXIS + 10))
    drawing.name(-86, 104, "pinion 16", DARK_SKY, (-32, 88))
    drawing.name(62, 78, "unbalanced mass", DARK_RED, (-6, 38))
    drawing.name(62, 52, "satellite (gear 6)", DARK_AMBER, (-6, 10))
    drawing.name(-44, -98, "gear 2 (link 2)", DARK_GREEN, (9, -80))
    drawing.name(84, -104, "housing freewheel", BLACK, (35, AXIS - 15))
    drawing.name(94, 30, "output freewheel", DARK_PURPLE, (62, AXIS + 15))
    drawing.name(114, -4, "output\nshaft", DARK_PURPLE)


def driven_shaft_named(drawing):
    """The driven shaft with the names of its parts."""
    drawing.axis_line(-128, 128, AXIS)
    driven_shaft(drawing)
    drawing.name(-66, 44, "hub", DARK_PURPLE)
    drawing.name(-2, 34, "stiffness of the shaft", BLACK)
    drawing.name(-2, -72, "damping of the shaft", BLACK)
    drawing.name(62, 72, "driven mass", DARK_PURPLE)


def flange(drawing):
    """A rotating flange, as a terminal."""
    drawing.ball(0, 0, 90, GREY)


# name, what draws it, pixels
ICONS = (("module", module, ICON), ("driven_shaft", driven_shaft, ICON), ("flange", flange, 32))
# name, what draws it, lowest and highest point
NAMED = (("module_named", module_named, -112, 112), ("driven_shaft_named", driven_shaft_named, -104, 84))


def main(target=TARGET):
    """Icons without words, pictures with them and with few colours, for they stand in every FMU."""
    for name, draw, pixels in ICONS:
        icon = Drawing.sheet(-100, 100, -100, 100, pixels / ICON)
        draw(icon)
        icon.axes.figure.patch.set_alpha(0.0)
        for ending in ("png", "svg"):
            write_figure(target / f"{name}.{ending}", icon.axes.figure)
    for name, draw, low, high in NAMED:
        sheet = Drawing.sheet(-128, 128, low, high, 3)
        draw(sheet)
        path = write_figure(target / f"{name}.png", sheet.axes.figure)
        with Image.open(path) as picture:
            picture.convert("RGB").quantize(64).save(path, optimize=True)


if __name__ == "__main__":
    main(*map(Path, sys.argv[1:]))
