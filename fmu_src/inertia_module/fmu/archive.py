"""FMU files: archives of the same content are the same bytes, and know themselves by their GUID."""

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


def filled(
    template: Path, values: Mapping[str, Any], write: Callable[[Any], str] | None = None, xml: bool = False
) -> str:
    """Text of a template of Jinja.

    Args:
        template: its file. values: by name. write: makes text of a value. xml: escaped for XML.
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


def filled_xml(template: Path, values: Mapping[str, Any]) -> bytes:
    """An XML file of a template."""
    return filled(template, values, xml=True).encode()


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
