"""Parameters that the vehicle tells unasked: decoded, judged anew, told, whoever changed them."""

import json
import math
import struct

import pytest
from hypothesis import given
from hypothesis import strategies as st
from pymavlink.dialects.v20 import common as mavlink

from groundstation.vehicle.overheard import decoded

INT32, REAL32 = mavlink.MAV_PARAM_TYPE_INT32, mavlink.MAV_PARAM_TYPE_REAL32


def fields(value: float, kind: int) -> str:
    """Return what MAVSDK makes of a PARAM_VALUE; it writes null for what JSON has no number for."""
    told = value if math.isfinite(value) else None
    return json.dumps({"param_id": "A_NAME", "param_value": told, "param_type": kind, "param_index": 3})


@given(st.integers(0, 2_000_000_000))
def test_the_bits_of_a_whole_number_are_read_back(number):
    (as_float,) = struct.unpack("<f", struct.pack("<i", number))
    assert decoded(fields(as_float, INT32), bytewise=True) == ("A_NAME", number)


@given(st.integers(-(2**24), 2**24))
def test_a_whole_number_that_is_cast_is_taken_as_it_is(number):
    assert decoded(fields(float(number), INT32), bytewise=False) == ("A_NAME", number)


@given(st.floats(width=32, allow_nan=False, allow_infinity=False))
def test_a_real_number_is_taken_as_it_is(number):
    assert decoded(fields(number, REAL32), bytewise=True) == ("A_NAME", number)


def test_bits_that_are_no_float_are_no_value_that_could_be_judged_fine():
    (as_float,) = struct.unpack("<f", struct.pack("<i", -1))
    name, value = decoded(fields(as_float, INT32), bytewise=True)
    assert name == "A_NAME"
    assert math.isnan(value)


@pytest.mark.parametrize("text", ["", "{}", "[1]", '{"param_id": 3}', fields(1e300, INT32)])
def test_what_is_no_parameter_is_passed_over(text):
    assert decoded(text, bytewise=True) is None
