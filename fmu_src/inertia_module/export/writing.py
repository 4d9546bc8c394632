"""Writes a system in all formats: each file whole or not at all, and checked before."""

from __future__ import annotations

import io
from pathlib import Path

from ..common.files import write_atomically
from ..fmu.builder import content_of
from ..fmu.linking import Progress
from ..harness.wires import check_wiring
from .container import container
from .integers import with_integers
from .osp import STRUCTURE, structure
from .plan import Plan
from .ssp import ssp_file


def _check(plan: Plan, fmus: dict[str, bytes]) -> None:
    """Refuse a plan whose wires cannot work."""
    from fmpy import read_model_description

    descriptions = {
        part.name: read_model_description(io.BytesIO(fmus[part.fmu.file_name])) for part in plan.parts
    }
    given: dict[str, list[str]] = {}
    for owner, name in plan.inputs:
        given.setdefault(owner, []).append(name)
    values = {part.name: part.values for part in plan.parts}
    check_wiring(descriptions, plan.wires, given, plan.step, parameters=values)


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
    _check(plan, fmus)
    progress("packing the system")
    files = {"system.ssp": ssp_file(plan, fmus), f"osp/{STRUCTURE}": structure(plan)}
    files |= {f"osp/{name}": content for name, content in fmus.items()}
    files["container.fmu"] = container(plan, fmus)
    for name, content in files.items():
        write_atomically(folder / name, content)
    return [folder / name for name in files]
