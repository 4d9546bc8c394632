"""Test the reference results in an FMU: they are up to date, and other hosts find them."""

import re
import shutil
import subprocess
import tomllib
import zipfile
from pathlib import Path

import numpy as np
import pytest
from fmpy import fmi2, fmi3
from fmpy.cross_check.validate_vendor_repo import validate_repo
from fmpy.fmi1 import FMICallException
from lxml import etree

from inertia_module.common.errors import SimulationTerminated
from inertia_module.fmi import loading
from inertia_module.fmi.examination import examine
from inertia_module.fmi.experiments import experiments, read_table
from inertia_module.fmi.instance import Fmu, read_description
from inertia_module.fmi.replay import deviations
from inertia_module.fmi.report import Journal
from inertia_module.fmi.results import Result
from inertia_module.fmi.simulate import simulate_fmu
from inertia_module.fmu.native_fmu import METADATA
from inertia_module.interface.models import MODELS
from verification import compatibility
from verification.reference.experiments import LS_REF_FOLDER, files, package_folder

FLAVOURS = ("InertiaModule", "InertiaModule3", "DrivenShaft3")


def changed(path, folder, case):
    """Return a copy of an FMU with changed or deleted reference files."""
    copy = folder / path.name
    with zipfile.ZipFile(path) as old, zipfile.ZipFile(copy, "w") as new:
        for name in old.namelist():
            content = old.read(name)
            if LS_REF_FOLDER in name:
                for pattern, text in case.get("changes", {}).items():
                    content = re.sub(pattern.encode(), text.encode(), content)
            if case.get("removed", "nothing") not in name:
                new.writestr(name, content)
    return copy


def test_results_of_an_fmu_agree_with_its_references(fmu_path):
    report = examine(fmu_path, Journal())
    assert report.problems == [] == report.warnings
    assert len(report.references) == (6 if "Shaft" in fmu_path.name else 22)
    assert max(result.deviation / result.allowed for result in report.references) < 0.1


def test_files_of_manifest_and_metadata_exist(unpacked):
    for file in (unpacked / LS_REF_FOLDER / "fmi-ls-manifest.xml", unpacked / METADATA):
        links = etree.parse(file).xpath("//@source | //@*[local-name() = 'href']")
        local_files = [name for name in links if "://" not in name]
        assert len(local_files) >= 2
        assert all((file.parent / name).is_file() for name in local_files)


@pytest.mark.parametrize("model", MODELS.values(), ids=lambda model: model.name)
def test_references_in_the_fmu_are_up_to_date(model, tmp_path):
    computed, folder = files(model), package_folder(model)
    assert {folder / name for name in computed} == {path for path in folder.rglob("*") if path.is_file()}
    for name, content in computed.items():
        if name.endswith("_ref.csv"):
            (tmp_path / "now.csv").write_bytes(content)
            computed_table, package_table = (
                Result.from_csv(path) for path in (tmp_path / "now.csv", folder / name)
            )
            assert computed_table.names == package_table.names
            for column in computed_table:
                np.testing.assert_allclose(
                    computed_table[column], package_table[column], rtol=2e-8, atol=1e-7
                )
        else:
            assert content == (folder / name).read_bytes(), name


CHANGED_REFERENCES = tomllib.loads(
    Path(__file__).with_name("changed_references.toml").read_text(encoding="utf-8")
)


@pytest.mark.parametrize("case", CHANGED_REFERENCES)
def test_references_of_other_fmus_are_checked(built, tmp_path, case):
    messages = CHANGED_REFERENCES[case].get("messages", [])
    path = changed(built / "InertiaModule.fmu", tmp_path, CHANGED_REFERENCES[case])
    problems = examine(path, Journal()).problems
    assert bool(problems) == bool(messages)
    for words in messages:
        assert any(words in problem for problem in problems), problems
    assert not any("R1_ref: omega" in problem for problem in problems)


@pytest.mark.parametrize("slave", [fmi2.FMU2Slave, fmi3.FMU3Slave], ids=["DrivenShaft", "DrivenShaft3"])
def test_references_are_checked_until_an_fmu_ends_the_simulation(built, monkeypatch, slave):
    def step(self, *arguments, **named):
        time = next(iter((*arguments, *named.values())))
        if slave is fmi2.FMU2Slave and time > 0.295:
            raise FMICallException("fmi2DoStep", fmi2.fmi2Discard)
        answer = real(self, *arguments, **named)
        return answer if slave is fmi2.FMU2Slave else (answer[0], time > 0.295, *answer[2:])

    real = slave.doStep
    monkeypatch.setattr(slave, "doStep", step)
    monkeypatch.setattr(fmi2.FMU2Slave, "getBooleanStatus", lambda self, kind: kind == fmi2.fmi2Terminated)
    monkeypatch.setattr(loading, "RUN", "none: step by step")
    path = built / ("DrivenShaft.fmu" if slave is fmi2.FMU2Slave else "DrivenShaft3.fmu")
    report = examine(path, Journal())
    assert report.problems == []
    assert re.match(r"0\.29\d s in 29\d steps; the FMU ends the simulation", report.facts["simulated"])
    for name in ("shock", "ramp"):
        assert report.facts[name] == "0.3 s; the FMU ends the simulation"
    assert len(report.references) == 6
    assert max(one.time for one in report.references) <= 0.3
    table = simulate_fmu(path, {"hub_speed": 1.0}, 1.0, 0.1, "omega_out")
    assert table.time.tolist() == pytest.approx([0.0, 0.1, 0.2, 0.3])
    with Fmu(path) as fmu:
        fmu.advance(0.4)
        with pytest.raises(SimulationTerminated, match=rf"{path.name} ends the simulation at 0.4 s"):
            fmu.advance(0.1)


def test_tree_for_importers_has_the_structure_of_the_cross_check(built, tmp_path, monkeypatch):
    def ready(fmu, build):
        return (built / fmu.file_name).read_bytes()

    monkeypatch.setattr(compatibility, "content_of", ready)
    written, problems = compatibility.write_tree(tmp_path, print)
    assert (len(written), problems) == (25, [])
    assert validate_repo(str(tmp_path)) == (5, 0, [])


@pytest.mark.parametrize("identifier", ["InertiaModule", "InertiaModule3", "DrivenShaft", "DrivenShaft3"])
def test_fmusim_reproduces_the_references_of_an_fmu(built, opened, tmp_path, identifier):
    fmusim = shutil.which("fmusim")
    if fmusim is None:
        pytest.skip("fmusim is not installed")
    folder = opened(identifier)[1]
    variables = {v.name: v for v in read_description(built / f"{identifier}.fmu").modelVariables}
    for experiment in experiments(folder):
        expected, settings = read_table(folder, experiment.results, variables), experiment.settings
        command = [fmusim, "--interface-type", "cs", "--stop-time", settings["stopTime"]]
        command += ["--output-interval", settings["stepSize"], "--tolerance", settings["tolerance"]]
        for name, value in experiment.parameters.items():
            command += ["--start-value", name, str(value).split()[0].removesuffix(".0")]
        command += ["--input-file", experiment.inputs, "--output-file", tmp_path / "out.csv"]
        for name in expected.columns:
            command += ["--output-variable", name]
        subprocess.run([*command, built / f"{identifier}.fmu"], check=True)
        recorded = read_table(tmp_path, tmp_path / "out.csv", variables)
        for result in deviations(experiment, expected, recorded):
            assert result.deviation <= result.allowed, result
