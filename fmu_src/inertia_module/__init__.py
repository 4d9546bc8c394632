"""The inertia module: an inertial torque transformer as an FMI 2.0 or 3.0 co-simulation FMU.

The names in PUBLIC are imported at their first use: `from inertia_module import Fmu, drive`.
"""

from importlib import import_module as _import_module

__version__ = "0.2.0"
# date of this version: built files contain it instead of today, so the same source gives the same bytes
__date__ = "2026-11-22"

# module of each public name; __init__.pyi lists the same names for type checkers
PUBLIC = {
    "DrivenShaft": "model",
    "Fmu": "fmi.instance",
    "Module": "model",
    "Refused": "common.errors",
    "Result": "fmi.results",
    "Scene": "scene",
    "SceneResult": "scene",
    "batch": "studies.batch_run",
    "chart_figure": "plots.studies",
    "current_fmu": "fmu.builder",
    "design": "studies.design_search",
    "design_figure": "plots.studies",
    "drive": "fmi.simulate",
    "example": "common.examples",
    "fit": "studies.parameter_fit",
    "fit_figure": "plots.studies",
    "load_scene": "scene",
    "orders": "studies.order_analysis",
    "run_scene": "scene",
    "scene_figure": "plots.scenes",
    "sweep": "studies.parameter_sweep",
    "torque_converter_chart": "analysis.converter_chart",
}
__all__ = ["PUBLIC", "__version__", *PUBLIC]  # noqa: PLE0604


def __getattr__(name: str) -> object:
    if name not in PUBLIC:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    return getattr(_import_module(f".{PUBLIC[name]}", __name__), name)


def __dir__() -> list[str]:
    return sorted(__all__)
