"""The engine refuses each false step of `tests/planted_fresh.py`, and accepts each true one."""

import pytest

from tests import planted_fresh as planted

ROWS = [
    pytest.param(step, expected, why, id=f"{kind}: {name}")
    for kind, name, expected, step, why in planted.rows()
]


def test_the_tables_are_long():
    assert sum(len(group) for group in planted.FALSE.values()) >= 110
    assert sum(len(group) for group in planted.TRUE.values()) >= 40


@pytest.mark.parametrize(("step", "expected", "why"), ROWS)
def test_planted(step, expected, why):
    result, words = planted.verdict(step)
    assert result == expected, f"{why}; {words}"
