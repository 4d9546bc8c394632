"""Functions for FMU archives: read their content and change it."""

import zipfile

from inertia_module.fmu.archive import archive


def files_of(path):
    """Return the bytes by name."""
    with zipfile.ZipFile(path) as packed:
        return {name: packed.read(name) for name in packed.namelist()}


def with_content(path, content):
    """Write the archive with this content."""
    path.write_bytes(archive(content))
    return path


def with_words(path, fmu, name, old, new):
    """Copy an FMU and replace the first occurrence of these bytes in one of its files."""
    content = files_of(fmu)
    assert old in content[name]
    return with_content(path, content | {name: content[name].replace(old, new, 1)})
