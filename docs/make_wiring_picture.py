"""Draw docs/how_to/wiring.png: signals between the models of a host and the flanges of the FMU."""

from pathlib import Path

from make_icons import DARK_BLUE, DARK_PURPLE, Drawing, module
from matplotlib.patches import Rectangle

from inertia_module.common.colours import BLACK

TARGET = Path(__file__).parent / "how_to" / "wiring.png"
# of a row: title, what is in front, signals to the FMU and from it, what is in it, the same behind
ROWS = (
    (
        "inertias in the FMU",
        "engine or motor\ntorque over speed",
        ("drive_torque", "input_speed"),
        "input_inertia\noutput_inertia",
        ("omega_out", "load_torque"),
        "road, pump, brake\ntorque over speed",
    ),
    (
        "inertias in the host: the step has a limit",
        "an inertia\nof the host",
        ("omega1", "input_torque_mean"),
        "output_inertia",
        ("omega_out", "load_torque"),
        "spring and damper,\ninertias of the host",
    ),
)
WIDTH, HEIGHT, STEP = 760.0, 150.0, 215.0
SMALL = {"ha": "center", "va": "center", "fontsize": 10}


def box(axes, left, low, width, height, text, colour):
    axes.add_patch(Rectangle((left, low), width, height, facecolor="white", edgecolor=colour, linewidth=1.6))
    axes.text(left + width / 2, low + height / 2, text, color=colour, **SMALL)


def arrows(axes, left, right, low, names, colour):
    """One signal to the right, above, and one to the left, below."""
    for start, end, y, name in ((left, right, low + 100, names[0]), (right, left, low + 45, names[1])):
        line = {"arrowstyle": "-|>", "color": colour, "linewidth": 1.6, "shrinkA": 0, "shrinkB": 0}
        axes.annotate("", (end, y), (start, y), arrowprops=line)
        axes.text((left + right) / 2, y + 11, name, color=colour, family="monospace", **SMALL)


def main():
    sheet = Drawing.sheet(0, WIDTH, 0, 2 * STEP, 1.15)
    for row, (title, front, at_input, inside, at_output, behind) in enumerate(ROWS):
        low = (1 - row) * STEP + 25
        sheet.axes.text(8, low + HEIGHT + 14, title, fontsize=11, va="center", color=BLACK)
        box(sheet.axes, 6, low + 15, 150, 120, front, DARK_BLUE)
        arrows(sheet.axes, 156, 310, low, at_input, DARK_BLUE)
        box(sheet.axes, 310, low, 130, HEIGHT, "", BLACK)
        icon = sheet.axes.inset_axes((318, low + 34, 114, 114), transform=sheet.axes.transData)
        module(Drawing(icon))
        sheet.axes.text(375, low + 18, inside, family="monospace", **SMALL)
        arrows(sheet.axes, 440, 590, low, at_output, DARK_PURPLE)
        box(sheet.axes, 590, low + 15, 164, 120, behind, DARK_PURPLE)
    sheet.axes.figure.savefig(TARGET)


if __name__ == "__main__":
    main()
