"""What the scripts of the hosts share: the tasks they are given, and the results they leave."""

import json
import sys
from pathlib import Path

import numpy as np
from fmpy import read_model_description


class Task:
    """A task in a folder.

    Attributes:
        work: the folder. models, step, steps, connections, clock: as given.
        paths, descriptions, variables: of each instance; the variables by name.
        outputs: (instance, output) of all.
    """

    def __init__(self, work):
        self.work = Path(work)
        given = json.loads((self.work / "task.json").read_text())
        self.models, self.step, self.steps = given["models"], given["step"], given["steps"]
        self.connections, self.clock = given["connections"], given["clock"]
        self._changes = given["changes"]
        folder = Path(given["folder"])
        self.paths = {model: folder / f"{model.split('_')[0]}.fmu" for model in self.models}
        self.descriptions = {model: read_model_description(str(path)) for model, path in self.paths.items()}
        self.variables = {
            model: {variable.name: variable for variable in description.modelVariables}
            for model, description in self.descriptions.items()
        }
        self.outputs = [
            (model, name)
            for model, variables in self.variables.items()
            for name, variable in variables.items()
            if variable.causality == "output"
        ]

    def values(self):
        """(instance, variable, value) of all that the scene sets before the end of initialisation."""
        for model, values in self.models.items():
            for name, value in values.items():
                yield model, self.variables[model][name], value

    def changes(self, step):
        """(instance, variable, value) of all inputs that are set before a step."""
        for model, values in self._changes.get(str(step), {}).items():
            for name, value in values.items():
                yield model, self.variables[model][name], value

    def write(self, rows):
        """Leave the outputs after each step."""
        (self.work / "names.json").write_text(json.dumps([f"{model}.{name}" for model, name in self.outputs]))
        np.save(self.work / "rows.npy", np.array(rows))


def run_all(run):
    """Run the tasks in the folders that the script is given, one after the other."""
    for work in sys.argv[1:]:
        run(Task(work))
