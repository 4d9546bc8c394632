"""FMU files: reproducible archives, and GUIDs that are hashes of the content."""

from __future__ import annotations

import io
import os
import zipfile
from collections.abc import Callable, Mapping
from datetime import UTC, datetime
from pathlib import Path
from typing import Any

from jinja2 import Environment, StrictUndefined

from .. import __date__
from ..common.files import content_hash

DESCRIPTION = "modelDescription.xml"
TEMPLATES = Path(__file__).parent / "templates"
# the earliest time in a zip archive
_ZIP_TIME = (1980, 1, 1, 0, 0, 0)


def guid_of(files: Mapping[str, bytes]) -> str:
    """Return a GUID that is the hash of names and contents.

    Args:
        files: contents by name.
    """
    digits = content_hash(files)
    return "{" + "-".join((digits[:8], digits[8:12], digits[12:16], digits[16:20], digits[20:])) + "}"


def generation_date() -> str:
    """Return the date of this version, or SOURCE_DATE_EPOCH, in UTC; the same source gives the same bytes."""
    epoch = os.environ.get("SOURCE_DATE_EPOCH")
    moment = datetime.fromtimestamp(int(epoch), UTC) if epoch else datetime.fromisoformat(__date__)
    return moment.strftime("%Y-%m-%dT%H:%M:%SZ")


def render(
    template: Path, values: Mapping[str, Any], write: Callable[[Any], str] | None = None, xml: bool = False
) -> str:
    """Return the text of a Jinja template with values.

    Args:
        template: path of the template.
        values: values by name.
        write: function that converts a value to text, or None.
        xml: True to escape texts for XML.
    """
    environment = Environment(
        trim_blocks=True,
        lstrip_blocks=True,
        keep_trailing_newline=True,
        undefined=StrictUndefined,
        finalize=write,
        autoescape=xml,
    )
    return environment.from_string(template.read_text(encoding="utf-8")).render(values)


def render_xml(template: Path, values: Mapping[str, Any]) -> bytes:
    """Return the XML file of a Jinja template with values.

    Args:
        template: path of the template.
        values: values by name; texts are escaped for XML.
    """
    return render(template, values, xml=True).encode()


def archive(content: Mapping[str, bytes]) -> bytes:
    """Return a zip archive that depends only on its content.

    Args:
        content: contents by name.
    """
    stream = io.BytesIO()
    with zipfile.ZipFile(stream, "w", zipfile.ZIP_DEFLATED) as packed:
        for name in sorted(content, key=lambda name: (name != DESCRIPTION, name)):
            info = zipfile.ZipInfo(name, _ZIP_TIME)
            info.compress_type = zipfile.ZIP_DEFLATED
            info.create_system = 3  # Unix on all platforms, because the next line sets Unix permissions
            info.external_attr = 0o644 << 16
            packed.writestr(info, content[name], compresslevel=9)
    return stream.getvalue()
