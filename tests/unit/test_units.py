"""Test units in the usual notation, and the table of units in the documentation."""

import re
from pathlib import Path

import pytest

from inertia_module.common.units import _PRODUCTS, _SYMBOLS, KINDS, factor_between, number_of
from inertia_module.interface.variables import DISPLAY_UNITS

PAGE = Path(__file__).parents[2] / "docs" / "reference" / "quantities.md"

RPM, POUND_FOOT = 0.10471975511965977, 1.3558179483314004

# A unit as text, the unit of the result, the factor between both.
WRITTEN = [
    *((unit, "rad/s", RPM) for unit in ("1/min", "1 / min", "/min", "min-1", "min^-1", "min⁻¹", "(1/min)")),
    *((unit, "rad/s", RPM) for unit in ("U/min", "U min-1", "U·min⁻¹", "Umin", "Umin-1", "Umin⁻¹", "r/min")),
    *((unit, "rad/s", RPM) for unit in ("RPM", "rpm", "rev/min")),
    *((unit, "rad/s", 1.0) for unit in ("rad/s", "rad s^-1", "rad·s⁻¹", "rad/sec")),
    *((unit, "rad/s", 0.017453292519943295) for unit in ("deg/s", "°/s", "º/s")),
    *((unit, "rad/s2", 1.0) for unit in ("rad/s2", "rad/s^2", "rad/s²", "rad·s⁻²", "rad/s/s")),
    *((unit, "rad/s2", RPM) for unit in ("rpm/s", "1/min/s", "U/min/s")),
    *((unit, "Hz", 1.0) for unit in ("1/s", "s-1", "s⁻¹", "/s")),
    ("1/min", "Hz", 1.0 / 60.0),
    *((unit, "m/s", 1.0 / 3.6) for unit in ("km/h", "kmh", "kph", "km h⁻¹")),
    ("mph", "m/s", 0.44704),
    ("mi/h", "m/s", 0.44704),
    ("ft", "m", 0.3048),
    ("in", "m", 0.0254),
    *((unit, "m", 1e-6) for unit in ("um", "µm", "μm")),
    *((unit, "s", 1e-6) for unit in ("us", "µs", "μs")),
    ("lb", "kg", 0.45359237),
    *((unit, "m2", 1.0) for unit in ("m2", "m^2", "m²", "m**2")),
    *((unit, "kg.m2", 1.0) for unit in ("kg·m²", "kg⋅m²", "kg m^2", "kg*m**2", "kgm2", "kgm²", "kg-m2")),
    *((unit, "kg.m2", 1e-7) for unit in ("gcm²", "g.cm2", "g cm²")),
    *((unit, "kg.m2", 0.45359237 * 0.3048**2) for unit in ("lb.ft2", "lb-ft²")),
    *((unit, "N.m", 1.0) for unit in ("N·m", "N m", "Nm", "N-m", "N*m")),
    ("Ncm", "N.m", 0.01),
    ("mNm", "N.m", 0.001),
    *((unit, "N.m", POUND_FOOT) for unit in ("lbf.ft", "lb.ft", "lb-ft", "ft-lb", "ftlb", "lbft", "lbf ft")),
    *((unit, "N.m", POUND_FOOT / 12.0) for unit in ("in.lb", "in-lb", "lbin", "lbf·in")),
    ("lb.ft/rad", "N.m/rad", POUND_FOOT),
    *((unit, "N.m.s/rad", 1.0) for unit in ("Nm/(rad/s)", "Nms/rad", "N m s / rad", "N.m.(rad/s)^-1")),
    *((unit, "N.m.s/rad", 1.0 / RPM) for unit in ("Nm/rpm", "Nm/(1/min)", "Nm/(U/min)")),
    ("kW", "W", 1e3),
    ("PS", "W", 735.49875),
    ("hp", "W", 745.6998715822702),
    ("kWh", "J", 3.6e6),
    ("arcmin", "rad", 2.908882086657216e-4),
    # units other than SI
    ("rpm", "deg/s", 6.0),
    ("kWh", "MJ", 3.6),
]


def test_display_units_have_the_factors_of_their_names():
    for unit, (display, factor) in DISPLAY_UNITS.items():
        assert factor == pytest.approx(factor_between(unit, display), rel=1e-15)


@pytest.mark.parametrize(("unit", "si", "factor"), WRITTEN)
def test_unit_in_usual_notation_is_accepted(unit, si, factor):
    assert factor_between(unit, si) == pytest.approx(factor, rel=1e-14)
    assert number_of(f"3 {unit}", si) == pytest.approx(3.0 * factor, rel=1e-14)


@pytest.mark.parametrize(
    ("unit", "si", "words"),
    [
        ("blink", "rad/s", "unknown unit 'blink'; available: rad/s, rpm, .*1/min.* more$"),
        ("stone", "N.m", r"unknown unit 'stone'; available: N\.m, .*Ncm.*lbf\.ft.* more$"),
        ("blink", "J", "unknown unit 'blink'; available: J, kJ, .*kWh$"),
        ("blink", "kg.m2", r"unknown unit 'blink'; available: kg\.m2, .*gcm2.*slug\.ft2$"),
        ("kgg", "kg", r"unknown unit 'kgg'; did you mean 'kg'\?$"),
        ("NM", "N.m", r"unknown unit 'NM'; did you mean 'Nm', 'kNm' or 'Nmm'\?$"),
        ("blink", "N.s", r"unknown unit 'blink'; available: N\.s$"),
        ("kg", "rad/s", "incompatible unit 'kg'; available: rad/s, rpm, "),
        # The unit could be rad/s or rev/s.
        ("1/s", "rad/s", "incompatible unit '1/s'; available: .* rev/s"),
        ("Hz", "rad/s", "incompatible unit 'Hz'; available: rad/s"),
        ("lb", "N.m", r"incompatible unit 'lb'; available: N\.m"),
        ("1/min", "s", "incompatible unit '1/min'; available: s, ms"),
        ("rad/s)", "rad/s", r"unknown unit 'rad/s\)'; did you mean 'rad/s'\?"),
        ("(rad/s", "rad/s", r"unknown unit '\(rad'; did you mean 'rad/s'\?"),
        ("N..m/", "N.m", "unknown unit ''"),
        ("Nm2", "N.m", r"incompatible unit 'Nm2'; available: N\.m"),
    ],
)
def test_an_unknown_unit_is_rejected_with_the_units_of_its_kind(unit, si, words):
    with pytest.raises(ValueError, match=words):
        factor_between(unit, si)


def test_each_unit_of_the_table_is_of_its_kind_and_no_unit_is_missing():
    for units in KINDS.values():
        assert all(factor_between(unit, units[0]) > 0.0 for unit in units)
    written = " ".join(unit for units in KINDS.values() for unit in units)
    symbols = set(re.findall(r"[A-Za-z%‰°]+\d?", written))
    assert {*_SYMBOLS, *_PRODUCTS} - symbols <= {"1", "Nms", "Umin-1"}


def test_the_documentation_has_the_table_of_units():
    rows = re.findall(r"^\| ([^|`]+) \| `(.+)` \|$", PAGE.read_text(encoding="utf-8"), re.MULTILINE)
    assert {kind: tuple(units.split("`, `")) for kind, units in rows} == KINDS
