from .analysis.converter_chart import TorqueConverterChart as TorqueConverterChart
from .common.errors import FmuError as FmuError
from .common.errors import InertiaModuleError as InertiaModuleError
from .common.errors import MissingDependencyError as MissingDependencyError
from .common.errors import ParameterError as ParameterError
from .common.errors import SceneError as SceneError
from .common.errors import SimulationTerminated as SimulationTerminated
from .common.examples import example as example
from .fmi.instance import Fmu as Fmu
from .fmi.results import Result as Result
from .fmu.builder import current_fmu as current_fmu
from .model import DrivenShaft as DrivenShaft
from .model import Module as Module
from .plots.scenes import scene_figure as scene_figure
from .plots.studies import chart_figure as chart_figure
from .plots.studies import design_figure as design_figure
from .plots.studies import fit_figure as fit_figure
from .scene import Scene as Scene
from .scene import SceneResult as SceneResult
from .scene import load_scene as load_scene
from .scene import run_scene as run_scene
from .scene import simulate as simulate
from .scene import torque_converter_chart as torque_converter_chart
from .studies.batch_run import batch as batch
from .studies.design_result import DesignResult as DesignResult
from .studies.design_search import design as design
from .studies.fit_result import FitResult as FitResult
from .studies.order_analysis import orders as orders
from .studies.order_result import Orders as Orders
from .studies.parameter_fit import fit as fit
from .studies.parameter_sweep import SweepResult as SweepResult
from .studies.parameter_sweep import sweep as sweep

PUBLIC: dict[str, str]
__version__: str
__date__: str
