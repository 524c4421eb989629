"""Text with units becomes the right float, or an error that teaches."""

import re
from decimal import Decimal
from fractions import Fraction

import numpy as np
import pint
import pytest
from hypothesis import given
from hypothesis import strategies as st

import kvtheory as kv
from kvtheory.scene.units import EXAMPLES, expected, to_si
from tests import REFUSALS

FIVE_OVER_PI = 1.591549430918953357689
EXACT = {
    "m": {"5 µm": 5e-06, "5 μm": 5e-06, "5um": 5e-06, "300 µm": 3e-4, "10 mm": 0.01, "1e-2 m": 0.01,
          ".5 m": 0.5},
    "m/s": {"-100 mm/s": -0.1, "1 km/h": 1000 / 3600},
    "N/m^3": dict.fromkeys(
        ("10 GN/m^3", "10 GN/m**3", "10 GN/m³", "10 MPa/mm", "10 N/mm3", "10 N mm-3", "10 N·mm^-3",
         "10 N / mm ^ 3", "10 N/(mm mm^2)"), 1e10),
    "kg/m": {"1 kg/mm": 1000.0}, "N/m^2": {"30 MPa": 3e7}, "s": {"100 ms": 0.1}, "1": {"3": 3.0},
    "m/s^2": {"9.80665 m/s^2": 9.80665},
    "1/s": {"1.5 Hz": 1.5, "90 /min": 1.5, "90 rpm": 1.5, "1.5 cycle/s": 1.5, "1.5 turn/s": 1.5,
            "540 deg/s": 1.5, "10 rad/s": FIVE_OVER_PI},
}  # fmt: skip


@pytest.mark.parametrize("unit", EXACT)
def test_reads_to_the_last_bit(unit):
    for text, value in EXACT[unit].items():
        assert to_si(text, unit) == value, text


@given(st.decimals(allow_nan=False, allow_infinity=False, places=9, min_value=-1e6, max_value=1e6))
def test_agrees_with_exact_decimals(number):
    assert to_si(f"{number} µm", "m") == float(Fraction(number) / 10**6)
    assert to_si(f"{number} GN/m^3", "N/m^3") == float(Fraction(number) * 10**9)


WRONG = [
    *((text, unit, word) for unit, rows in REFUSALS["units"].items() for text, word in rows),
    *((each, "m", "expected a quantity in m")
      for each in (True, np.bool_(True), np.complex128(1 + 2j), None, [1.0], {})),
]  # fmt: skip


@pytest.mark.parametrize(("text", "unit", "words"), WRONG)
def test_refuses_and_says_what_is_expected(text, unit, words):
    with pytest.raises(ValueError, match="expected") as caught:
        to_si(text, unit)
    assert words in str(caught.value)
    example = "dimensionless number" if unit == "1" else EXAMPLES[unit][0]
    assert example in str(caught.value)


def test_what_is_no_finite_float_stays_so_and_what_underflows_is_zero():
    for text in ("1e999999999 m", "1e308 km", "inf m", "nan m"):
        assert not np.isfinite(to_si(text, "m")), text
    assert to_si("1e-999999999 m", "m") == 0.0


def test_takes_pint_quantities_and_plain_si_numbers():
    registry = pint.UnitRegistry()
    assert to_si(registry.Quantity(5, "µm"), "m") == 5e-06
    assert to_si(registry.Quantity(10, "GN/m^3"), "N/m^3") == 1e10
    assert to_si(registry.Quantity(Decimal("0.1"), "kg/mm"), "kg/m") == 100.0
    assert to_si(registry.Quantity(10, "rad/s"), "1/s") == FIVE_OVER_PI
    assert to_si(registry.Quantity(2.5), "1") == 2.5
    assert to_si(np.float32(0.5), "m") == 0.5
    assert to_si(3, "m") == 3.0
    assert to_si(Decimal("0.1"), "m") == to_si(Fraction(1, 10), "m") == 0.1
    with pytest.raises(ValueError, match="wrong dimension"):
        to_si(registry.Quantity(5, "s"), "m")
    with pytest.raises(ValueError, match="dimensionless"):
        to_si(registry.Quantity(5, "s"), "1")


@pytest.mark.parametrize("unit", EXAMPLES)
def test_the_examples_in_the_messages_work(unit):
    for example in EXAMPLES[unit]:
        assert to_si(example, unit) > 0


@pytest.mark.parametrize(
    ("made", "units"),
    [
        (lambda: kv.DeadWeight(load="150 g"), ("N/m", "N")),
        (lambda: kv.DeadWeight(mass="1 N"), ("kg/m", "kg")),
        (lambda: kv.Drive(velocity=1.0, stiffness=["3 kg"]), ("N/m^2", "N/m")),
    ],
)
def test_a_part_without_a_shape_says_what_a_line_and_what_a_ball_expects(made, units):
    per_width, total = map(expected, units)
    words = f"expected {per_width}, of a line contact, or {total}, of a ball"
    with pytest.raises(kv.SceneError, match=re.escape(words)):
        made()


def test_several_values_in_one_text_are_told_to_be_a_list():
    with pytest.raises(ValueError, match=r'a list: \["20 degC", "60 degC"\]'):
        to_si("20 degC, 60 degC", "K")
    with pytest.raises(ValueError, match=r'a list: \["1 mm", "2 mm"\]'):
        to_si("1 mm,2 mm", "m")
    with pytest.raises(ValueError, match="decimal mark as a point"):
        to_si("0,5 mm", "m")
