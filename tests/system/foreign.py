"""FMUs with errors or with unusual correct behaviour: C code compiled for a test, and a description."""

import functools
import subprocess
import tempfile
import zipfile
from pathlib import Path

from fmpy import fmi2, fmi3, platform, platform_tuple, sharedLibraryExtension

from tests.compilers import system_compiler

SOURCES = Path(__file__).parent
REFERENCES = "extra/org.fmi-standard.fmi-ls-ref"
DESCRIPTION = "modelDescription.xml"

DESCRIPTION_2 = """<?xml version="1.0" encoding="UTF-8"?>
<fmiModelDescription fmiVersion="2.0" modelName="foreign" guid="{{1}}">
  <CoSimulation modelIdentifier="foreign" canHandleVariableCommunicationStepSize="{variable}"/>
  {experiment}
  <ModelVariables>
    <ScalarVariable name="u" valueReference="1" causality="input"><Real start="0"/></ScalarVariable>
    <ScalarVariable name="y" valueReference="2" causality="output"><Real/></ScalarVariable>
    <ScalarVariable name="flag" valueReference="3" causality="output" variability="discrete">
      <Boolean/>
    </ScalarVariable>
    <ScalarVariable name="text" valueReference="4" causality="output" variability="discrete">
      <String/>
    </ScalarVariable>
    <ScalarVariable name="count" valueReference="5" causality="output" variability="discrete">
      <Integer/>
    </ScalarVariable>
  </ModelVariables>
  <ModelStructure>
    <Outputs>{unknowns}</Outputs>
    <InitialUnknowns>{unknowns}</InitialUnknowns>
  </ModelStructure>
</fmiModelDescription>
"""
DESCRIPTION_3 = """<?xml version="1.0" encoding="UTF-8"?>
<fmiModelDescription fmiVersion="3.0" modelName="foreign" instantiationToken="1">
  <{interface} modelIdentifier="foreign" {more}/>
  {experiment}
  <ModelVariables>
    <Float64 name="time" valueReference="0" causality="independent" variability="continuous"/>
    <Float64 name="u" valueReference="1" causality="input" start="0"/>
    <Float64 name="y" valueReference="2" causality="output"/>
    <Boolean name="flag" valueReference="3" causality="output"/>
    <String name="text" valueReference="4" causality="output"/>
    <Int32 name="count" valueReference="5" causality="output"/>
    <Float64 name="ramps" valueReference="6" causality="output"><Dimension start="3"/></Float64>
    <Binary name="data" valueReference="7" causality="output"/>
    <String name="in_text" valueReference="8" causality="input"><Start value="none"/></String>
  </ModelVariables>
  <ModelStructure>
    {outputs}
    {unknowns}
  </ModelStructure>
</fmiModelDescription>
"""
MANIFEST = """<fmiReferences>
  <Related type="application/x-ma-hs-experiments" source="experiments.exp" role="experiment/validation"/>
</fmiReferences>
"""
EXPERIMENT = """<Experiments>
  <Experiment name="test"><TransientSimulation {times}/>{inputs}<References source="{results}"/></Experiment>
</Experiments>
"""


@functools.cache
def library(fmi, behaviour):
    """Compile a library whose steps run this C code; without a compiler the test is skipped."""
    kinds = (fmi2.FMU2Slave,) if fmi == 2 else (fmi3.FMU3Slave, fmi3.FMU3Model)
    names = sorted({name for kind in kinds for name in dir(kind) if name.startswith(f"fmi{fmi}")})
    stubs = "".join(f"__attribute__((weak)) int {name}() {{ return 0; }}\n" for name in names)
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        (folder / "stubs.c").write_text(stubs)
        (folder / "behaviour.h").write_text(behaviour)
        sources = [SOURCES / f"foreign{fmi}.c", folder / "stubs.c"]
        flags = ["-shared", "-fPIC", "-w", "-I", folder, "-I", SOURCES]
        subprocess.run([system_compiler(), *flags, *sources, "-o", folder / "library", "-lm"], check=True)
        return (folder / "library").read_bytes()


def description(fmi=2, times="", variable="true", interface="CoSimulation", more=""):
    """Return a model description with the times of the default experiment."""
    experiment = f"<DefaultExperiment {times}/>" if times else ""
    if fmi == 2:
        unknowns = "".join(f'<Unknown index="{index}"/>' for index in range(2, 6))
        return DESCRIPTION_2.format(variable=variable, experiment=experiment, unknowns=unknowns)
    if interface == "CoSimulation":
        more += f' canHandleVariableCommunicationStepSize="{variable}"'
    outputs, unknowns = (
        "".join(f'<{kind} valueReference="{reference}"/>' for reference in range(2, 8))
        for kind in ("Output", "InitialUnknown")
    )
    render = {"outputs": outputs, "unknowns": unknowns}
    return DESCRIPTION_3.format(interface=interface, more=more, experiment=experiment, **render)


def references(
    results, times='startTime="0" stopTime="1" stepSize="0.25"', inputs=None, source="results.csv"
):
    """Return the files of an experiment by name: its results and its inputs."""
    stimuli = '<Stimuli source="inputs.csv"/>' if inputs is not None else ""
    experiment = EXPERIMENT.format(times=times, inputs=stimuli, results=source)
    files = {"fmi-ls-manifest.xml": MANIFEST, "experiments.exp": experiment, "results.csv": results}
    files |= {"inputs.csv": inputs} if inputs is not None else {}
    return {f"{REFERENCES}/{name}": text for name, text in files.items()}


def foreign_fmu(folder, code="", fmi=2, files=None, **more):
    """Write an FMU to a folder; its steps run C code.

    files: text or bytes by name, in addition to library and description; more: parts of the description.
    """
    content = library(fmi, f"static int behaviour(double time, double step) {{ {code}; return 0; }}")
    place = platform if fmi == 2 else platform_tuple
    path = folder / "foreign.fmu"
    with zipfile.ZipFile(path, "w") as archive:
        archive.writestr(DESCRIPTION, description(fmi, **more))
        archive.writestr(f"binaries/{place}/foreign{sharedLibraryExtension}", content)
        for name, text in (files or {}).items():
            archive.writestr(name, text)
    return path


def packed(path, entries):
    """Write an archive with these entries (names or ZipInfo, with content) and a description."""
    with zipfile.ZipFile(path, "w", zipfile.ZIP_DEFLATED) as archive:
        archive.writestr(DESCRIPTION, description())
        for entry, content in entries:
            archive.writestr(entry, content)
    return path
