"""Documentation and pictures in every FMU, as a host shows them from the folder it is unpacked to."""

import subprocess
import sys
from html.parser import HTMLParser
from pathlib import Path

import numpy as np
import pytest
from PIL import Image

from inertia_module.fmu.documentation import variables_page

from .conftest import MODELS

FLAVOURS = tuple(MODELS)
ROOT = Path(__file__).parents[2]
PICTURES = ROOT / "fmu_src" / "inertia_module" / "fmu" / "pictures"
ICON = (200, 200)
NEVER_CLOSED = {"meta", "img", "br", "hr"}


class Page(HTMLParser):
    """What a page refers to, its headings, the names in its tables; every element is closed in its turn."""

    def __init__(self, text):
        super().__init__()
        self.references, self.headings, self.names, self.open = [], [], [], []
        self.feed(text)
        assert self.open == []

    def handle_starttag(self, tag, attrs):
        self.references += [value for key, value in attrs if key in ("src", "href")]
        if tag not in NEVER_CLOSED:
            self.open.append(tag)

    def handle_endtag(self, tag):
        assert self.open.pop() == tag

    def handle_data(self, data):
        if self.open[-1:] in (["h1"], ["h2"]):
            self.headings.append(data)
        if self.open[-2:] == ["td", "code"]:
            self.names.append(data)


@pytest.fixture
def page(unpacked):
    return Page((unpacked / "documentation" / "index.html").read_text(encoding="utf-8"))


def test_page_refers_to_files_of_the_fmu_alone(page, unpacked):
    folder = unpacked / "documentation"
    licences = {f"licenses/{path.name}" for path in (folder / "licenses").iterdir()}
    assert licences >= {"licenses/license.txt"}
    assert set(page.references) == {"mechanism.png"} | licences
    for reference in page.references:
        path = (folder / reference).resolve()
        assert path.is_relative_to(folder.resolve())
        assert path.is_file()


def test_page_says_what_the_model_computes_how_to_couple_it_and_its_limits(page, model):
    first, *sections = page.headings
    assert first == model.title
    assert sections[:5] == [
        "What it computes",
        "How to couple it",
        "Order of calls",
        "Refusals",
        "What is not modelled",
    ]


def test_page_lists_every_variable_once_and_the_flanges(page, model):
    flanges = [
        name for end in model.terminals for name in (end.name, end.speed, end.torque, end.angle) if name
    ]
    assert sorted(page.names) == sorted([*(variable.name for variable in model.variables), *flanges])


def test_page_of_the_site_is_made_from_the_table():
    assert (ROOT / "docs" / "variables.md").read_text() == variables_page()


def test_icon_is_a_square_with_the_machine_in_colours(unpacked, description):
    name = "model.png" if description.fmiVersion == "2.0" else "terminalsAndIcons/icon.png"
    with Image.open(unpacked / name) as icon:
        assert icon.size == ICON
        assert icon.mode == "RGBA"
        small = np.asarray(icon.resize((100, 100)))
    assert 0.2 < (small[..., 3] > 128).mean() < 0.8  # neither empty nor a square of one colour
    assert len({tuple(pixel) for pixel in small[small[..., 3] == 255] // 32}) > 5


def test_picture_of_the_documentation_is_larger_than_the_icon(unpacked):
    with Image.open(unpacked / "documentation" / "mechanism.png") as picture:
        assert min(picture.size) > 2 * ICON[0]


def test_pictures_are_what_the_code_draws(tmp_path):
    subprocess.run([sys.executable, ROOT / "docs" / "make_icons.py", tmp_path], check=True)
    assert sorted(path.name for path in tmp_path.iterdir()) == sorted(
        path.name for path in PICTURES.iterdir()
    )
    for path in PICTURES.glob("*.png"):
        with Image.open(path) as kept, Image.open(tmp_path / path.name) as drawn:
            one, other = (np.asarray(picture.convert("RGBA"), dtype=float) for picture in (kept, drawn))
        assert one.shape == other.shape
        # another version of the library may smooth an edge or place a letter otherwise
        assert np.abs(one - other).mean() < 1.0, path.name
