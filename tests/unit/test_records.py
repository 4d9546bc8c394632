"""Test records of the kernel: misspelt fields raise, debuggers print records, the workspace is scratch."""

import math
import re

import pytest
from scenes import motions

from inertia_module.compiling import stubs
from inertia_module.interface.records import place, record_type, size
from inertia_module.kernel import records
from inertia_module.model import Module

FIELDS = ("first", ("row", 3), ("inner", ("left", "right")), ("several", ("left", "right"), 2), "last")


def test_fields_are_contiguous():
    record = record_type(FIELDS)()
    record.row[1], record.inner.right, record.several[1].left = 1.0, 2.0, 3.0
    assert list(record.numbers) == [0.0, 0.0, 1.0, 0.0, 0.0, 2.0, 0.0, 0.0, 3.0, 0.0, 0.0]
    assert (size(FIELDS), place(FIELDS, "inner.right"), place(FIELDS, "last")) == (11, 5, 10)


@pytest.mark.parametrize("name", ["fist", "inner.lift", "several[0].left_"])
def test_a_misspelt_field_raises(name):
    record = record_type(FIELDS)()
    with pytest.raises(AttributeError):
        exec(f"record.{name} = 1.0", {"record": record})
    with pytest.raises(AttributeError):
        eval(f"record.{name}", {"record": record})


def test_the_state_of_a_module_can_be_read():
    module = Module("plain").start(omega1=100.0)
    module.advance(0.001)
    text = repr(module.state)
    assert "    omega1=100.0,\n" in text
    assert "omega_missing" not in text
    assert "(0.0" not in text


def test_the_stub_of_the_records_is_current():
    assert stubs.PATH.read_text(encoding="utf-8") == stubs.stub()


def test_every_record_of_the_stub_has_a_name_in_plain_python():
    names = re.findall(r"^(?:class )?([A-Z]\w+)(?:\(.*\))?(?::| =)", stubs.stub(), re.MULTILINE)
    assert len(names) > 20
    assert all(hasattr(records, name) for name in names)


@motions()
def test_results_do_not_depend_on_the_workspace_of_earlier_calls(compiled, scene):
    usual, spoilt = Module(compiled), Module(compiled)
    usual.start(**scene)
    workspace = spoilt._records[-1].numbers
    workspace[:] = [math.nan] * len(workspace)
    spoilt.start(**scene)
    for step in (0.003, 1e-4, 0.02, 0.05):
        workspace[:] = [1e3] * len(workspace)
        usual.advance(step)
        spoilt.advance(step)
        assert bytes(spoilt.state) == bytes(usual.state)
        assert bytes(spoilt.outputs) == bytes(usual.outputs)
