"""The rows of docs/proofs.md, against which the proofs compare what they compute: the page cannot say anything else."""

from __future__ import annotations

import re
from pathlib import Path
from typing import NamedTuple

PAGE = Path(__file__).parents[2] / "docs/proofs.md"
_DECIMAL = re.compile(r"(?<![\w.])-?\d+\.\d+(?!\w)")
_COUNT = re.compile(r"(?<![\w.])\d[\d ]*(?![\w.])")
_BOUND = re.compile(r"within (\d+e-\d+)")


class Row(NamedTuple):
    """A published result, and ours; cells as they stand in the page."""

    result: str
    source: str
    parameters: str
    published: str
    ours: str
    script: str
    figure: str

    def equals(self, *values: float) -> None:
        """Assert that the values, rounded as the page prints them, are those of both columns.

        Where the published one is a closed form, the page prints no decimals of it, and the proof evaluates it.
        """
        assert self._agree(self.ours, values), f"{self.result}: computed {values}, the page says {self.ours}"
        if _DECIMAL.search(_plain(self.published)):
            assert self._agree(self.published, values), f"{self.result}: computed {values}, published {self.published}"

    def within(self, error: float) -> None:
        """Assert that an error does not exceed the bound that the page gives."""
        (bound,) = _BOUND.findall(_plain(self.ours))
        assert float(error) <= float(bound), f"{self.result}: off by {error:.3g}, the page says {self.ours}"

    def counts(self, *values: int) -> None:
        """Assert that the whole numbers in the column of ours are these."""
        printed = [int(number.replace(" ", "")) for number in _COUNT.findall(_plain(self.ours))]
        assert printed == [int(value) for value in values], (
            f"{self.result}: counted {values}, the page says {self.ours}"
        )

    @staticmethod
    def _agree(cell: str, values: tuple[float, ...]) -> bool:
        printed = _DECIMAL.findall(_plain(cell))
        decimals = [len(number.partition(".")[2]) for number in printed]
        return len(printed) == len(values) and printed == [
            f"{value:.{digits}f}" for value, digits in zip(values, decimals, strict=True)
        ]


def _plain(cell: str) -> str:
    return cell.replace("−", "-").replace("\u202f", " ")


def rows() -> dict[str, Row]:
    """Return all rows of the page by what they say is proven."""
    cells = [
        [cell.strip() for cell in line.strip().strip("|").split(" | ")]
        for line in PAGE.read_text().splitlines()
        if line.startswith("| ")
    ]
    found = [Row(*one) for one in cells if len(one) == len(Row._fields) and one[0] != "result"]
    assert len({row.result for row in found}) == len(found)
    return {row.result: row for row in found}


def row(result: str) -> Row:
    """Return the row of the page that says that `result` is proven."""
    return rows()[result]
