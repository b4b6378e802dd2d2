"""The reason why a text is not a number."""

import pytest

from ospace.urdf.numbers import NumberError, number, numbers


@pytest.mark.parametrize(
    ("text", "reason"),
    [
        ("", "is empty"),
        ("nan", "is not finite"),
        ("-Inf", "is not finite"),
        ("1e400", "is too large"),
        ("1e-400", "reads as zero"),
        ("0x10", "is hexadecimal"),
        ("1,5", "has a decimal comma"),
        ("12 kg", "has 'kg' behind the number"),
        ("kg", "is not a number"),
        ("1\u00a0", "has the character U+00A0"),
    ],
)
def test_a_number_is_read_or_refused_with_its_reason(text, reason):
    with pytest.raises(NumberError, match=reason.replace("+", r"\+")):
        number(text)


@pytest.mark.parametrize(
    ("text", "reason"),
    [
        ("0, 0, 1", "has a comma behind '0', where white space alone separates numbers"),
        ("0,5 0 1", "has a decimal comma"),
        ("0 1", "has 2 numbers instead of 3"),
    ],
)
def test_a_list_of_numbers_is_read_or_refused_with_its_reason(text, reason):
    with pytest.raises(NumberError, match=reason):
        numbers(text, 3)


def test_white_space_is_that_of_xml():
    assert numbers(" 1\t-.5\n 2e1 ", 3) == (1.0, -0.5, 20.0)
