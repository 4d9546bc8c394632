"""Test the shipped libraries of the FMUs, and libraries compiled from their sources, in a C host."""

import itertools

import pytest
import scenes

from inertia_module.compiling.targets import host_target
from inertia_module.fmu.linking import SHELL_FOLDER, header_folder
from inertia_module.fmu.native_fmu import SOURCE, library, source_files
from inertia_module.fmu.tables import generated
from inertia_module.interface.variables import BOOLEAN, ENUMERATION, INTEGER, LOCAL, OUTPUT, REAL

from ..fmu.test_binaries import read, required_by
from .conftest import FMUS, SOURCES, WITH_KERNEL, run, system_compiler

LETTERS = {REAL: "r", INTEGER: "i", BOOLEAN: "b", ENUMERATION: "e"}
# Delphi, C++Builder and Fortran with -ffpe-trap set traps; -ffast-math flushes subnormal numbers.
TRAPS, FLUSH = {"TRAPS": "1"}, {"FLUSH": "1"}


def levels():
    """Return settings of the module: each level, layout and drive, with each kind of losses of the level."""
    for level, layout, drive, added in itertools.product(
        scenes.LEVELS, scenes.SCENES, scenes.DRIVES, ("ideal", "losses", "worn", "play")
    ):
        has_springs, is_prescribed = level == "elastic", level == "kinematic"
        if (added == "worn" and not has_springs) or (
            is_prescribed and (added == "play" or drive == "torque")
        ):
            continue
        more = dict(scenes.ADDED[added])
        if level == "averaged":
            more.pop("windage", None)
        yield (
            f"{level}-{layout}-{drive}-{added}",
            {"fidelity": 2, **scenes.DRIVES[drive][layout], **scenes.LEVELS[level], **more},
        )


MODULE = dict(levels())
SHAFT = {
    "shaft": {},
    "linear": {"input_hold": 1},
    "stiff": {"shaft_stiffness": 1e8, "driven_inertia": 1e-9},
    "soft": {"shaft_stiffness": 1e-2, "shaft_damping": 1e5},
}
CASES = [
    pytest.param(name, settings, id=f"{name}-{case}")
    for name, fmu in FMUS.items()
    for case, settings in (MODULE if fmu.model.warnings else SHAFT).items()
]
# Overlapping satellites cause a warning.
OVERLAPPING = {"fidelity": 2, "satellites": 9, "mesh_efficiency": 0.98}


@pytest.fixture(scope="session")
def host(tmp_path_factory):
    """Return the path of the program that loads libraries."""
    folder = tmp_path_factory.mktemp("host")
    for name, text in generated(FMUS["InertiaModule"].model, "", 2).items():
        (folder / name).write_text(text)
    headers = [f"-I{path}" for path in (SHELL_FOLDER, WITH_KERNEL, folder)]
    flags = ["-std=gnu11", "-O1", *headers, "-isystem", header_folder()]
    run([system_compiler(), *flags, SOURCES / "loaded.c", "-o", folder / "loaded", "-ldl", "-lm"])
    return folder / "loaded"


@pytest.fixture(scope="session")
def shipped(tmp_path_factory):
    """Return a function that gives the path of the library in an FMU."""
    folder = tmp_path_factory.mktemp("shipped")

    def library_of(identifier):
        path = folder / f"{identifier}{host_target().suffix}"
        if not path.exists():
            fmu = FMUS[identifier]
            path.write_bytes(library(fmu, fmu.guid(), host_target(), lambda stage: None))
        return path

    return library_of


@pytest.fixture(scope="session")
def compiled_from_source(tmp_path_factory):
    """Return a function that compiles the sources in an FMU and gives the path of the library."""
    folder = tmp_path_factory.mktemp("source")

    def library_of(identifier):
        path = folder / identifier / "library.so"
        if not path.exists():
            fmu = FMUS[identifier]
            for name, content in source_files(fmu, fmu.guid(), lambda stage: None).items():
                target = folder / identifier / name
                target.parent.mkdir(parents=True, exist_ok=True)
                target.write_bytes(content)
            source = folder / identifier / "sources" / SOURCE
            flags = ["-O2", "-fPIC", "-shared", "-isystem", header_folder()]
            run([system_compiler(), *flags, source, "-o", path, "-lm"])
        return path

    return library_of


def instance(identifier, path, settings):
    """Return arguments of the host for an instance with these settings."""
    fmu = FMUS[identifier]
    variables = fmu.model.variables
    places = {variable.name: n for n, variable in enumerate(variables)}
    outputs = [n for n, one in enumerate(variables) if one.causality in (OUTPUT, LOCAL) and one.kind == REAL]
    words = [
        f"{LETTERS[variables[places[name]].kind]}:{places[name]}:{value!r}"
        for name, value in settings.items()
    ]
    return [path, fmu.guid(), fmu.fmi, ",".join(map(str, outputs)), *words, "--"]


@pytest.mark.parametrize("identifier, settings", CASES)
def test_host_keeps_its_floating_point_environment_without_exceptions(identifier, settings, host, shipped):
    """The host calls FMI in and out of order, with invalid numbers, and checks its environment."""
    words = [host, *instance(identifier, shipped(identifier), settings)]
    assert run(words, **TRAPS) == run(words)


@pytest.mark.parametrize("identifier", FMUS)
def test_a_host_that_flushes_subnormal_numbers_gets_the_same_bits(identifier, host, shipped):
    words = [host, *instance(identifier, shipped(identifier), {})]
    assert run(words, **FLUSH) == run(words)


@pytest.mark.parametrize("identifier", FMUS)
def test_library_compiled_from_sources_exports_only_fmi_and_has_the_bits_of_the_shipped_library(
    identifier, host, shipped, compiled_from_source
):
    path = compiled_from_source(identifier)
    exported = read(path).offers - {"_init", "_fini", "__bss_start", "_edata", "_end"}
    assert exported == required_by(FMUS[identifier].fmi) | {"inertiaModuleRun"}
    settings = OVERLAPPING if FMUS[identifier].model.warnings else {}
    printed = run([host, *instance(identifier, path, settings)], **TRAPS)
    assert printed == run([host, *instance(identifier, shipped(identifier), settings)])
    assert ("satellites of a module overlap" in printed) == bool(settings)


def test_libraries_that_are_loaded_globally_do_not_call_each_other(host, shipped, compiled_from_source):
    every = {"GLOBAL": "1"}
    for order in (list(FMUS), list(reversed(FMUS))):
        for library_of in (compiled_from_source, shipped):
            words = [word for name in order for word in instance(name, library_of(name), {})]
            assert run([host, *words], **every) == run([host, *words])
