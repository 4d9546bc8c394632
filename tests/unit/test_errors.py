"""The forms of the messages."""

import errno

import pytest
import typer

from inertia_module.cli.answer import Answer, command
from inertia_module.common.errors import (
    InertiaModuleError,
    Named,
    cannot_read,
    must_be,
    sentence_of,
    suggestion,
    unknown,
)

NAMES = ["omega1", "omega2", "omega_out", "tolerance"]


@pytest.mark.parametrize(
    ("name", "end"),
    [
        ("tolerance1", "; did you mean 'tolerance'?"),
        ("OMEGA", "; did you mean 'omega1', 'omega2' or 'omega_out'?"),
        ("xyz", "; available: omega1, omega2, omega_out, tolerance"),
        ("", "; available: omega1, omega2, omega_out, tolerance"),
        ("two\nlines", "; available: omega1, omega2, omega_out, tolerance"),
    ],
)
def test_an_unknown_name_gets_similar_names_or_the_available_ones(name, end):
    assert suggestion(name, NAMES) == end
    message = unknown("variable", name, NAMES)
    assert message == f"unknown variable {name!r}{end}"
    assert "\n" not in message


def test_a_list_of_names_is_cut_off_and_may_be_empty():
    many = [f"key{number}" for number in range(20)]
    assert unknown("key", "xyz", many).endswith("key11 and 8 more")
    assert unknown("input", 7, []) == "unknown input '7'; available: none"


@pytest.mark.parametrize(
    ("reason", "text"),
    [
        (FileNotFoundError(errno.ENOENT, "No such file or directory", "b.toml"), "no such file or directory"),
        (OSError("XML is broken"), "XML is broken"),
        (ValueError("Bad\nvalue"), "bad value"),
        ("line 3 is not UTF-8", "line 3 is not UTF-8"),
    ],
)
def test_unreadable_file_is_named_once_with_the_reason(reason, text):
    assert cannot_read("a.toml", reason) == f"cannot read a.toml: {text}"


def test_invalid_value_is_printed_with_all_digits():
    assert must_be("step", "above 0", -0.1) == "step must be above 0 (got -0.1)"
    assert must_be("layout", "bevel or planar", repr("flat")) == "layout must be bevel or planar (got 'flat')"


def error_of(cause, error):
    """Return an error raised while another error is handled."""
    try:
        try:
            raise cause
        except type(cause):
            raise error  # noqa: B904 - the implicit cause is tested
    except type(error) as caught:
        return caught


@pytest.mark.parametrize(
    ("error", "line"),
    [
        (TimeoutError(), "TimeoutError"),
        (ValueError(" \n"), "ValueError"),
        (error_of(OSError("scheduler closed"), TimeoutError()), "TimeoutError, caused by: scheduler closed"),
        (error_of(KeyError(), RuntimeError()), "RuntimeError, caused by: KeyError"),
    ],
)
def test_an_error_without_message_has_its_type_and_cause(error, line, capsys):
    def work() -> Answer:
        raise error

    assert sentence_of(error) == line
    with pytest.raises(typer.Exit):
        command(work)(as_json=True)
    printed = capsys.readouterr()
    assert printed.err == f"error: {line}\n"
    assert printed.out == f'{{"error": "{line}"}}\n'


def test_a_missing_value_has_its_reason():
    values = Named({"distance": 3.0}, "metric", {"time": "not reached"})
    with pytest.raises(InertiaModuleError, match=r"^time: not reached$"):
        values["time"]
    with pytest.raises(InertiaModuleError, match=r"^unknown metric 'distances'; did you mean 'distance'\?$"):
        values["distances"]
