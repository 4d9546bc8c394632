"""FMUs for hosts that know no enumerations: described as Integers. To the library inside that is the same."""

from __future__ import annotations

import io
import zipfile
from xml.etree import ElementTree

from ..fmu.archive import DESCRIPTION, archive


def with_integers(fmu: bytes) -> bytes:
    """A copy of an FMU whose enumerations are described as Integers.

    libcosim and Ecos leave variables out that are enumerations, so there no fidelity could be set.

    Args:
        fmu: content of the file.
    """
    with zipfile.ZipFile(io.BytesIO(fmu)) as packed:
        content = {name: packed.read(name) for name in packed.namelist()}
    root = ElementTree.fromstring(content[DESCRIPTION])
    for element in root.iterfind("ModelVariables/ScalarVariable/Enumeration"):
        element.tag = "Integer"
        del element.attrib["declaredType"]
    content[DESCRIPTION] = ElementTree.tostring(root, xml_declaration=True, encoding="UTF-8")
    return archive(content)
