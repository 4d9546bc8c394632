"""Writing a system in all formats: each file whole or not at all, and checked before."""

from __future__ import annotations

import io
import zipfile
from pathlib import Path
from xml.etree import ElementTree

from fmpy import read_model_description

from ..common.files import write_atomically
from ..fmu.archive import DESCRIPTION, archive
from ..fmu.builder import content_of
from ..fmu.linking import Progress
from ..harness.wires import check_wiring
from .container import container
from .plan import Plan
from .systems import OSP_STRUCTURE, osp_structure, ssp_file


def with_integers(fmu: bytes) -> bytes:
    """Copy an FMU so that its enumerations are described as Integers: to the library inside that is the same.

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


def export(plan: Plan, folder: Path, progress: Progress = lambda stage: None) -> list[Path]:
    """Write system.ssp, osp/ (structure and FMUs) and container.fmu into a folder.

    Args:
        plan: the system. folder: made if it is not there. progress: told each stage as it begins.

    Returns:
        Paths of the files.

    Raises:
        CompilationUnavailable: the native FMUs cannot be built here.
        WiringError: the wires of the plan cannot work.
    """
    fmus = {}
    for part in plan.parts:
        progress(f"building {part.fmu.file_name}")
        fmus[part.fmu.file_name] = with_integers(content_of(part.fmu, progress)[0])
    given: dict[str, list[str]] = {}
    for owner, name in plan.inputs:
        given.setdefault(owner, []).append(name)
    check_wiring(
        {part.name: read_model_description(io.BytesIO(fmus[part.fmu.file_name])) for part in plan.parts},
        plan.wires,
        given,
        plan.step,
        parameters={part.name: part.values for part in plan.parts},
    )
    progress("packing the system")
    files = {"system.ssp": ssp_file(plan, fmus), f"osp/{OSP_STRUCTURE}": osp_structure(plan)}
    files |= {f"osp/{name}": content for name, content in fmus.items()}
    files["container.fmu"] = container(plan, fmus)
    for name, content in files.items():
        write_atomically(folder / name, content)
    return [folder / name for name in files]
