"""Units are read exactly, with the meaning that pint gives them."""

from __future__ import annotations

import subprocess
import sys

import numpy as np
import pint
import pytest

from film_model.base import units
from film_model.base.unit_symbols import SYMBOLS, parse_unit

REGISTRY = pint.get_application_registry()


@pytest.mark.parametrize("symbol", SYMBOLS)
def test_every_symbol_is_what_pint_says(symbol: str) -> None:
    size, (mass, length, time) = parse_unit(symbol)
    base = REGISTRY.Quantity(1.0, f"kg**{mass} * m**{length} * s**{time}")
    assert REGISTRY.Quantity(1.0, symbol).to(base.units).magnitude == pytest.approx(float(size), rel=1e-14)


@pytest.mark.parametrize("dimension", units.DIMENSIONS)
def test_every_dimension_has_a_unit_that_pint_and_we_read(dimension: str) -> None:
    if dimension != "dimensionless":
        text = units.scene_unit(dimension)
        assert units.to_si(f"2.5 {text}", dimension) == 2.5
        assert units.to_si(f"2.5 {units.si_unit(dimension)}", dimension) == 2.5
        assert units.to_si(units.DIMENSIONS[dimension].example, dimension) > 0
    assert units.to_si(units.quantity(2.5, dimension), dimension) == 2.5


@pytest.mark.parametrize(
    ("text", "dimension", "value"),
    [
        ("10 mm", "length", 0.01),
        ("10mm", "length", 0.01),
        (" 1e1\tmm ", "length", 0.01),
        (".5 um", "length", 5e-7),
        ("5 µm", "length", 5e-6),  # the micro sign
        ("5 μm", "length", 5e-6),  # the Greek letter
        ("10 inches", "length", 0.254),
        ("60.74 g", "mass", 0.06074),
        ("1 t", "mass", 1000.0),
        ("-0.1 m/s", "velocity", -0.1),
        ("90 km/h", "velocity", 25.0),
        ("9.81 m/s**2", "acceleration", 9.81),
        ("1 N/mm^2", "pressure", 1e6),
        ("1 N/mm²", "pressure", 1e6),
        ("7.85 g/cm^3", "density", 7850.0),
        ("154.9 N*m", "bending_stiffness", 154.9),
        ("154.9 N·m", "bending_stiffness", 154.9),
        ("154.9 J", "bending_stiffness", 154.9),
        ("150 kg/s", "impedance", 150.0),
        ("150 N s m-1", "impedance", 150.0),
        ("20 us", "time", 2e-5),
        ("40 1/s", "rate", 40.0),
        ("40/ms", "rate", 4e4),
        ("20 mPa*s", "viscosity", 0.02),
        ("20 mPa·s", "viscosity", 0.02),
        ("20 mPa s", "viscosity", 0.02),
        ("0.3", "dimensionless", 0.3),
        ("30 percent", "dimensionless", 0.3),
        (0.3, "dimensionless", 0.3),
        (REGISTRY.Quantity(60.74, "g"), "mass", 0.06074),
        (REGISTRY.Quantity(np.float32(2.0), "mm"), "length", 0.002),
    ],
)
def test_reads_to_the_last_bit(text: object, dimension: str, value: float) -> None:
    assert units.to_si(text, dimension) == value


@pytest.mark.parametrize(
    ("value", "fragment"),
    [
        ("10,5 mm", "comma"),
        ("1,000 mm", "comma"),
        ("−3 m", "U+2212"),
        ("5 mm ± 1 mm", "tolerance"),
        ("5 mm +/- 1 mm", "tolerance"),
        ("5 Nm", 'did you mean "N*m"?'),
        ("5 MM", 'did you mean "mm"?'),
        ("5 k", 'no unit is called "k"'),
        ("5 mPa", 'did you mean "MPa"?'),
        ("inf mm", "not finite"),
        ("nan mm", "not a number"),
        ("1e999 m", "not finite"),
        ("1e99999 m", "not understood"),
        ("10", "no unit"),
        ("", "empty"),
        ("  ", "empty"),
        ("mm", "not a number and a unit"),
        ("ten mm", "not a number and a unit"),
        ("10 mm 3", "not understood"),
        ("10 mm!", "not understood"),
        ("10 000 mm", "not understood"),
        ("1_000 mm", "not understood"),
        ("0x10 mm", "not understood"),
        ("5 e3 m", "not understood"),
        ("１０ mm", "not a number and a unit"),
        ("5 m^", "not understood"),
        ("5 m/s kg", "not understood"),
        ("5 degC", "not understood"),
        ("5 decibel", "not understood"),
        ("5 bananas", "not understood"),
        ("5 " + "m*" * 200 + "m", "not a number and a unit"),
        ("5 kg", "is a mass, a length is needed"),
        ("5 N*m", "is an energy"),
        ("5 m^7", 'has the unit "m^7"'),
        (10, "10 has no unit"),
        (True, "true is not"),
        (None, "None is not"),
        ([1], "a list is not"),
        (REGISTRY.Quantity(5, "kg"), "5 kg is a mass"),
        (REGISTRY.Quantity(5, "degC"), "not a matter of mass, length and time"),
        (REGISTRY.Quantity(float("nan"), "m"), "not finite"),
        (REGISTRY.Quantity([1.0, 2.0], "m"), "not one number"),
    ],
)
def test_refusals_state_the_reason_and_the_needed_dimension(value: object, fragment: str) -> None:
    with pytest.raises(ValueError, match=r'a length is needed \(e.g. "10 mm"\)$') as caught:
        units.to_si(value, "length")
    assert fragment in str(caught.value)
    assert len(str(caught.value).splitlines()) == 1


@pytest.mark.parametrize("value", [True, "5 m", "x", "1 dB", REGISTRY.Quantity(5, "dB")])
def test_values_that_are_no_plain_numbers_are_refused(value: object) -> None:
    with pytest.raises(ValueError, match="a plain number is needed") as caught:
        units.to_si(value, "dimensionless")
    assert "a unit" not in str(caught.value)


def test_bare_numbers_only_on_request() -> None:
    assert units.to_si(3, "length", bare=True) == 3.0
    assert units.to_si(np.float64(3), "length", bare=True) == 3.0
    for value in (True, float("nan"), 10**400):
        with pytest.raises(ValueError, match="a length is needed"):
            units.to_si(value, "length", bare=True)


def test_arrays() -> None:
    np.testing.assert_array_equal(units.array_to_si(["1 mm", "2 cm"], "length"), [0.001, 0.02])
    np.testing.assert_array_equal(units.array_to_si(REGISTRY.Quantity([1.0, 2.0], "mm"), "length"), [0.001, 0.002])
    np.testing.assert_array_equal(units.array_to_si(np.array([1, 2]), "length", bare=True), [1.0, 2.0])
    assert units.array_to_si("3 mm", "length").shape == ()
    for wrong in (np.array([1.0]), [1.0], ["1 kg"], REGISTRY.Quantity([1.0, np.inf], "m"), 1.0):
        with pytest.raises(ValueError, match="a length is needed") as caught:
            units.array_to_si(wrong, "length")
        assert str(caught.value)


@pytest.mark.parametrize("text", ["1e9 N/m^1.5", "1e9 N*m^-1.5", REGISTRY.Quantity(1e9, "N/m**1.5")])
def test_power_stiffness(text: object) -> None:
    assert units.power_stiffness_to_si(text, 1.5) == 1e9
    with pytest.raises(ValueError, match="N/m\\^2 is needed"):
        units.power_stiffness_to_si(text, 2)


def test_power_stiffness_in_millimetres() -> None:
    assert units.power_stiffness_to_si("3e5 N/mm^1.5", 1.5) == pytest.approx(3e5 * 1000**1.5, rel=1e-15)
    third = 4 / 3
    assert units.power_stiffness_to_si(f"2.0 N/m^{third!r}", third) == 2.0


@pytest.mark.parametrize("exponent", [0.5, 1.0, 1.5, 4 / 3, 10.0, 20.0])
def test_the_unit_of_a_power_stiffness_is_read_again(exponent: float) -> None:
    unit = units.power_stiffness_unit(exponent)
    assert units.power_stiffness_to_si(f"3 {unit}", exponent) == 3.0
    assert units.power_stiffness_unit(1.5) == "N/m^1.5" and units.power_stiffness_unit(20.0) == "N/m^20"


@pytest.mark.parametrize(
    ("value", "dimension", "text"),
    [
        (516.09, "force", "516.1 N"),
        (9.4838e-6, "length", "9.484 µm"),
        (55.627e-6, "time", "55.63 µs"),
        (999.96, "force", "1 kN"),
        (-1234.5, "force", "-1.234 kN"),
        (0.06074, "mass", "60.74 g"),
        (2.5, "mass", "2.5 kg"),
        (170.377e9, "pressure", "170.4 GPa"),
        (-0.2292, "velocity", "-0.2292 m/s"),
        (156.473, "impedance", "156.5 N·s/m"),
        (0.91691, "dimensionless", "0.9169"),
        (0.0, "length", "0 m"),
        (float("inf"), "length", "inf m"),
        (1e-30, "energy", "1e-30 J"),
    ],
)
def test_format(value: float, dimension: str, text: str) -> None:
    assert units.format_si(value, dimension) == text


@pytest.mark.slow
def test_ordinary_units_need_no_pint() -> None:
    code = "import sys; from film_model.base.units import *; to_si('5 N/mm^2', 'pressure'); format_si(1., 'force'); "
    code += "assert not {'pint', 'scipy'} & set(sys.modules)"
    subprocess.run([sys.executable, "-c", code], check=True)


def test_masked_values_are_missing() -> None:
    masked = np.ma.array([1, 2], mask=[False, True])
    for values in (REGISTRY.Quantity(masked, "mm"), masked):
        with pytest.raises(ValueError, match="not finite"):
            units.array_to_si(values, "length", bare=True)
    np.testing.assert_array_equal(units.array_to_si(REGISTRY.Quantity(masked[:1], "mm"), "length"), [0.001])
