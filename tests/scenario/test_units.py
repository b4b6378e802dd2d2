"""Units: every one of a dimension is converted, and another is refused."""

import pytest

from ospace.scenario import units


@pytest.mark.parametrize("dimension", units.UNITS)
def test_every_unit_is_converted_and_another_is_refused(dimension):
    for unit, size in units.UNITS[dimension].items():
        assert units.parse(f"-2.5e1 {unit}", dimension) == pytest.approx(-25.0 * size)
        assert units.parse(f" 3  {unit} ", dimension) == pytest.approx(3.0 * size)
        with pytest.raises(ValueError, match="unit 'parsec'"):
            units.parse("1 parsec", dimension)
    assert units.parse(2, dimension) == 2.0
