"""The inertia module: an inertial torque transformer as an FMI 2.0 or 3.0 co-simulation FMU.

The names in PUBLIC are imported at their first use: `from inertia_module import Fmu, simulate`.
"""

from importlib import import_module as _import_module

from .common import deprecated as _deprecated

__version__ = "0.2.0"
# date of this version: built files contain it instead of today, so the same source gives the same bytes
__date__ = "2026-11-22"

# module of each public name; __init__.pyi lists the same names for type checkers
PUBLIC = {
    "DesignResult": "studies.design_result",
    "DrivenShaft": "model",
    "FitResult": "studies.fit_result",
    "Fmu": "fmi.instance",
    "FmuError": "common.errors",
    "InertiaModuleError": "common.errors",
    "MissingDependencyError": "common.errors",
    "Module": "model",
    "Orders": "studies.order_result",
    "ParameterError": "common.errors",
    "Result": "fmi.results",
    "Scene": "scene",
    "SceneError": "common.errors",
    "SceneResult": "scene",
    "SimulationTerminated": "common.errors",
    "SweepResult": "studies.parameter_sweep",
    "TorqueConverterChart": "analysis.converter_chart",
    "batch": "studies.batch_run",
    "chart_figure": "plots.studies",
    "current_fmu": "fmu.builder",
    "design": "studies.design_search",
    "design_figure": "plots.studies",
    "example": "common.examples",
    "fit": "studies.parameter_fit",
    "fit_figure": "plots.studies",
    "load_scene": "scene",
    "orders": "studies.order_analysis",
    "run_scene": "scene",
    "scene_figure": "plots.scenes",
    "simulate": "scene",
    "sweep": "studies.parameter_sweep",
    "torque_converter_chart": "scene",
}
__all__ = ["PUBLIC", "__version__", *PUBLIC]  # noqa: PLE0604


_deprecated.install()
_renamed = _deprecated.renamed_names(__name__, Refused="InertiaModuleError", drive="simulate")


def __getattr__(name: str) -> object:
    if name in PUBLIC:
        return getattr(_import_module(f".{PUBLIC[name]}", __name__), name)
    return _deprecated.renamed_module(name) or _renamed(name)


def __dir__() -> list[str]:
    return sorted(__all__)
