"""Systems of FMUs: planned for a mechanism, and written in the files of SSP 1.0 and of OSP.

A plan is the module or, if its shaft is elastic, the rigid module and its shaft as two FMUs, wired, with the
values of a scene. Of SSP (System Structure and Parameterization) it uses what OMSimulator, libcosim, Ecos and
FMPy all read: each component has its own values, nothing is connected to the boundary of the system, and
only wired inputs have connectors.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from pathlib import Path
from typing import NamedTuple

from .. import __version__
from ..contract.models import DRIVEN_SHAFT, INERTIA_MODULE, Model
from ..contract.variables import PARAMETER, UNITS, Variable
from ..fmu.archive import archive, filled_xml, generation_date
from ..fmu.builder import MODULE_FMU, SHAFT_FMU
from ..fmu.native_fmu import NativeFmu
from ..harness.wires import Wire
from ..kernel.codes import DRIVE_TORQUE, ELASTIC, RIGID

MODULE, SHAFT = "module", "shaft"
TEMPLATES = Path(__file__).parent / "templates"
OSP_STRUCTURE = "OspSystemStructure.xml"
# outputs worth a connector
SHOWN = {
    MODULE: (
        "input_speed",
        "omega2",
        "omega_out",
        "input_torque_mean",
        "output_torque_mean",
        "imbalance_acceleration",
    ),
    SHAFT: ("omega_out", "shaft_torque_mean", "twist", "driven_acceleration"),
}


class Part(NamedTuple):
    """One FMU of a system: its values by name, those that differ from the start values."""

    name: str
    fmu: NativeFmu
    values: dict[str, float]

    def variable(self, name: str) -> Variable:
        """One of its variables."""
        return self.fmu.model.by_name[name]


class Plan(NamedTuple):
    """A system of FMUs to export.

    Attributes:
        title: of the system. parts: its FMUs. wires: between them.
        inputs: inputs that no wire drives (part, variable). outputs: those that are shown, likewise.
        step: communication step, s. stop_time: s.
    """

    title: str
    parts: tuple[Part, ...]
    wires: tuple[Wire, ...]
    inputs: tuple[tuple[str, str], ...]
    outputs: tuple[tuple[str, str], ...]
    step: float
    stop_time: float

    def part(self, name: str) -> Part:
        """A part by its name."""
        return next(part for part in self.parts if part.name == name)


def _parameters(model: Model, values: Mapping[str, float]) -> dict[str, float]:
    names = {variable.name for variable in model.with_causality(PARAMETER)}
    return {name: float(value) for name, value in values.items() if name in names}


def make_plan(
    title: str,
    values: Mapping[str, float],
    inputs: Mapping[str, float],
    step: float,
    stop_time: float,
) -> Plan:
    """Plan the system for a mechanism: the module alone or, if it is elastic, the rigid module and its shaft.

    Args:
        title: of the system.
        values: parameters of the module that differ from their start values.
        inputs: omega1, load_torque and, of a module driven by torque, drive_torque at the start.
        step: communication step, s. stop_time: s.
    """
    own, of_shaft = _parameters(INERTIA_MODULE, values), _parameters(DRIVEN_SHAFT, values)
    own.setdefault("tolerance", 1e-6)
    wires: tuple[Wire, ...] = ()
    if values.get("fidelity") == ELASTIC:
        rigid = {name: value for name, value in own.items() if name not in DRIVEN_SHAFT.by_name}
        rigid |= {name: own[name] for name in ("omega_out_start", "input_hold") if name in own}
        rigid |= {**inputs, "fidelity": float(RIGID), "load_torque": 0.0}
        start = {"hub_speed": own.get("omega_out_start", 0.0), "load_torque": inputs["load_torque"]}
        parts: tuple[Part, ...] = (
            Part(MODULE, MODULE_FMU, rigid),
            Part(SHAFT, SHAFT_FMU, of_shaft | start),
        )
        wires = (
            Wire(MODULE, "omega_out", SHAFT, "hub_speed"),
            Wire(SHAFT, "shaft_torque_mean", MODULE, "load_torque"),
        )
    else:
        parts = (Part(MODULE, MODULE_FMU, {**own, **inputs}),)
    drive = "drive_torque" if values.get("drive") == DRIVE_TORQUE else "omega1"
    ends = ((MODULE, drive), (parts[-1].name, "load_torque"))
    shown = tuple((part.name, output) for part in parts for output in SHOWN[part.name])
    return Plan(title, parts, wires, ends, shown, step, stop_time)


def typed(variable: Variable, value: float) -> tuple[str, str]:
    """(kind, value as text) of a variable in files of other tools; an enumeration as an Integer.

    libcosim and Ecos know no enumerations, FMPy knows none by the names of their items.
    """
    if variable.kind == "Boolean":
        return "Boolean", "true" if value else "false"
    if variable.kind == "Real":
        return "Real", repr(float(value))
    return "Integer", str(int(value))


# --- SSP and OSP ---


def osp_structure(plan: Plan) -> bytes:
    """OspSystemStructure.xml of a plan, for libcosim; its FMUs describe enumerations as Integers."""
    return filled_xml(TEMPLATES / OSP_STRUCTURE, plan=plan, typed=typed)


def ssp_file(plan: Plan, fmus: Mapping[str, bytes]) -> bytes:
    """The content of the .ssp file; fmus: contents by file name, enumerations described as Integers."""
    origin = {
        "generationTool": f"inertia-module {__version__}",
        "generationDateAndTime": generation_date(),
    }
    wired = [end for w in plan.wires for end in ((w.source, w.output), (w.sink, w.input))]
    # variables that have a connector, by part and name: those that are wired or shown
    ends = list(dict.fromkeys([*wired, *plan.outputs]))
    shown = _units(plan.part(owner).variable(name) for owner, name in ends)
    files = {f"resources/{name}": content for name, content in fmus.items()}
    for part in plan.parts:
        units = _units(map(part.variable, part.values))
        values = {"part": part, "typed": typed, "units": units, "origin": origin}
        files[f"resources/{part.name}.ssv"] = filled_xml(TEMPLATES / "ParameterSet.ssv", **values)
    structure = {"plan": plan, "ends": ends, "units": shown, "origin": origin}
    files["SystemStructure.ssd"] = filled_xml(TEMPLATES / "SystemStructure.ssd", **structure)
    return archive(files)


def _units(variables: Iterable[Variable]) -> dict[str, dict[str, int]]:
    """Units of variables, by their exponents of base units."""
    return {name: UNITS[name] for name in sorted({variable.unit for variable in variables} - {""})}
