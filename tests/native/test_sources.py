"""The C sources of the native FMUs, compiled by a compiler of the system and used in another country."""

import shutil
import subprocess

import pytest

from .conftest import run, system_compiler


def test_shell_and_tables_are_c99_without_a_warning(workshop):
    compiler = system_compiler()
    if compiler is None:
        pytest.skip("there is no C compiler of the system")
    strict = ["-Wshadow", "-Wstrict-prototypes", "-O2", "-fsyntax-only"]
    done = subprocess.run(
        [compiler, *workshop.flags(), *strict, *workshop.all_sources()],
        cwd=workshop.folder,
        capture_output=True,
        text=True,
        check=False,
    )
    assert (done.returncode, done.stderr) == (0, "")


@pytest.fixture
def comma(tmp_path):
    """Environment of a country that writes 1,5."""
    tool = shutil.which("localedef")
    command = [tool, "--no-archive", "-i", "de_DE", "-f", "UTF-8", str(tmp_path / "comma")]
    if tool is None or subprocess.run(command, capture_output=True, check=False).returncode != 0:
        pytest.skip("no locale with a decimal comma can be made (Debian: locales)")
    return {"LOCPATH": str(tmp_path), "LC_ALL": "comma"}


def test_messages_write_numbers_alike_in_every_country(workshop, comma):
    program = workshop.build("locales", "locales.c", "host.c")
    tolerance, begin, speed = run([program], **comma).splitlines()
    variable = workshop.fmu.model.variables[0]
    assert tolerance == "tolerance must be a positive number, is -1.5"
    assert begin == "start time must be a finite number of seconds, is nan"
    assert speed == f"{variable.name} must be {variable.allowed}, is 1234567.5"
