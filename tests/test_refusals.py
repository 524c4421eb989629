"""Commands that cannot do what they are asked say so in one message, with status 2, and write nothing."""

import pytest
from click.testing import CliRunner

from kvtheory.cli import main

FAILURES, PRECISION = ("chart", "failures"), ("chart", "work-precision")
COMPARE = ("compare", "--report", "r.html", "--plot", "p.png")
RUBBER = {
    "indenter.shape": "circle", "foundation.kind": "generalized-maxwell",
    "foundation.arms": '[["30 GN/m^3", "10 ms"]]',
}  # fmt: skip
ON_RUBBER = [part for key, value in RUBBER.items() for part in ("--set", f"{key}={value}")]


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ([*FAILURES, "--only", "sawtoth"], 'did you mean "sawtooth"?'),
        ([*FAILURES, "-o", "atlas.pdf"], "expected a name that ends in .html"),
        ([*PRECISION, "--standard", "hopp"], 'did you mean "hop"?'),
        (
            [*PRECISION, "--standard", "hop", "--set", "drive.velocity=1 m/s"],
            "does not go with SCENE",
        ),
        ([*PRECISION, "-o", "chart.txt"], "expected a name that ends in"),
        ([*PRECISION, "--set", "indenter.shape=circle"], "parabola only"),
        (["chart", "stability", "-o", "map.txt"], "expected a name that ends in"),
        ([*COMPARE, "--plot", "nowhere/p.png"], 'there is no directory "'),
        ([*COMPARE, "--plot", "p.xyz"], "ends in"),
        ([*COMPARE, "--report", "r.txt"], "ends in .html"),
        ([*COMPARE, "--report", "folder.html"], "is a directory"),
        (["explore", *ON_RUBBER], 'the explorer holds for foundation.kind = "kelvin-voigt" only'),
    ],
)
def test_a_mistake_costs_a_message_and_nothing_is_written(
    arguments, message, tmp_path, monkeypatch
):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "folder.html").mkdir()
    done = CliRunner().invoke(main, arguments)
    assert done.exit_code == 2
    assert message in done.stderr
    assert done.stdout == ""
    assert [path.name for path in tmp_path.iterdir()] == ["folder.html"]
