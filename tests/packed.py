"""FMUs as files: their content, and FMUs with another one."""

import zipfile

from inertia_module.fmu.archive import archive


def files_of(path):
    """Bytes by name."""
    with zipfile.ZipFile(path) as packed:
        return {name: packed.read(name) for name in packed.namelist()}


def with_content(path, content):
    """Write the archive with this content."""
    path.write_bytes(archive(content))
    return path


def with_words(path, fmu, name, old, new):
    """A copy of an FMU in which other bytes stand in one of its files, where these stood first."""
    content = files_of(fmu)
    assert old in content[name]
    return with_content(path, content | {name: content[name].replace(old, new, 1)})
