"""FMU files: archives of the same content are the same bytes, and know themselves by their GUID."""

from __future__ import annotations

import io
import os
import zipfile
from collections.abc import Mapping
from datetime import UTC, datetime
from pathlib import Path
from typing import Any
from xml.sax.saxutils import escape

from jinja2 import Environment, StrictUndefined
from markupsafe import Markup

from .. import __date__
from ..common.files import content_hash

DESCRIPTION = "modelDescription.xml"
# the earliest time a zip archive can hold
_ZIP_TIME = (1980, 1, 1, 0, 0, 0)


def guid_of(files: Mapping[str, bytes]) -> str:
    """A GUID that is the hash of names and contents."""
    digits = content_hash(files)
    return "{" + "-".join((digits[:8], digits[8:12], digits[12:16], digits[16:20], digits[20:])) + "}"


def generation_date() -> str:
    """The day of this version, or SOURCE_DATE_EPOCH, in UTC: the same source gives the same bytes."""
    epoch = os.environ.get("SOURCE_DATE_EPOCH")
    moment = datetime.fromtimestamp(int(epoch), UTC) if epoch else datetime.fromisoformat(__date__)
    return moment.strftime("%Y-%m-%dT%H:%M:%SZ")


def filled_xml(template: Path, **values: Any) -> bytes:
    """An XML file: a template of Jinja with values, of which what has a meaning in XML is escaped.

    Args:
        template: its file; the filter attributes writes those of a mapping that are not None.
    """
    special = {'"': "&quot;", "\n": "&#10;", "\r": "&#13;", "\t": "&#09;"}

    def attributes(items: Mapping[str, Any]) -> Markup:
        found = (
            f' {name}="{escape(str(value), special)}"' for name, value in items.items() if value is not None
        )
        return Markup("".join(found))

    environment = Environment(
        trim_blocks=True,
        lstrip_blocks=True,
        keep_trailing_newline=True,
        undefined=StrictUndefined,
        finalize=lambda value: value if isinstance(value, Markup) else escape(str(value), special),
    )
    environment.filters["attributes"] = attributes
    return environment.from_string(template.read_text(encoding="utf-8")).render(values).encode()


def archive(content: Mapping[str, bytes]) -> bytes:
    """A zip archive that depends on nothing but its content."""
    stream = io.BytesIO()
    with zipfile.ZipFile(stream, "w", zipfile.ZIP_DEFLATED) as packed:
        for name in sorted(content, key=lambda name: (name != DESCRIPTION, name)):
            info = zipfile.ZipInfo(name, _ZIP_TIME)
            info.compress_type = zipfile.ZIP_DEFLATED
            info.create_system = 3  # whatever packs it: the permissions below are those of Unix
            info.external_attr = 0o644 << 16
            packed.writestr(info, content[name], compresslevel=9)
    return stream.getvalue()
