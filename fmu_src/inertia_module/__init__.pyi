from .common.errors import Refused as Refused
from .common.examples import example as example
from .figures.jobs import chart_figure as chart_figure
from .figures.jobs import design_figure as design_figure
from .figures.jobs import fit_figure as fit_figure
from .figures.scenes import scene_figure as scene_figure
from .fmu.builder import current_fmu as current_fmu
from .harness.chart import torque_converter_chart as torque_converter_chart
from .harness.fmu import Fmu as Fmu
from .harness.results import Result as Result
from .harness.simulate import drive as drive
from .jobs.batch import batch as batch
from .jobs.design import design as design
from .jobs.fit import fit as fit
from .jobs.orders import orders as orders
from .jobs.sweep import sweep as sweep
from .memory import DrivenShaft as DrivenShaft
from .memory import Module as Module
from .scene import Scene as Scene
from .scene import SceneResult as SceneResult
from .scene import load_scene as load_scene
from .scene import run_scene as run_scene

PUBLIC: dict[str, str]
__version__: str
__date__: str
