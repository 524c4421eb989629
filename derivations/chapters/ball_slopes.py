r"""What the stability of a ball on a spring needs beside its forces: two more sums over its strips.

By F22 the forces of a strip change with its depth, the rate of it and the velocity by its half length A, by
x_TE and by the cubes of both. Over the strips these are integrals of sqrt(1 - y**2), of x_TE and of cubes.
"""

import sympy as sp

from ..engine.chapter import Chapter
from ..engine.nomenclature import symbol
from ..engine.step import Proof
from .ball import EDGE, PI, SECTION, UNIT, ball_angle, ball_tail, known, y
from .steady import l

ball_edges = symbol(
    "P_b", "integral of the trailing edges of all strips of a ball", latex=r"\tilde P"
)
ball_cubes = symbol("Q_b", "integral of their cubes", latex=r"\tilde Q", real=True)

theta, T = ball_angle, ball_tail
EDGES = (l / 3 + T / 4) / (1 + l**2)
CUBES = (sp.Rational(3, 16) * T * (1 + 5 * l**2) - l) / (1 + l**2)
result = Chapter(SECTION)


@result("F20-slopes")
def _slopes(proof: Proof) -> None:
    r"""Ball: how its forces change.

    A strip of the half length $\sqrt{1 - \tilde \zeta^2}$ has its trailing edge at $\sqrt{1 - \tilde \zeta^2
    + l^2} - l$. By F22 these two and their cubes say how its forces change with depth, rate and velocity;
    strips that the motion lifts or presses down carry nothing to first order.
    """
    width, whole, arc = sp.sqrt(1 - y**2), 1 + l**2, sp.atan(y / EDGE)
    cubed = y * (5 * whole - 2 * y**2) * EDGE / 8 + sp.Rational(3, 8) * whole**2 * arc
    line = (y * EDGE + whole * arc) / 2
    at_rest = sp.Integral(width, UNIT)
    proof.integral(at_rest, width, UNIT, "half lengths", value=PI / 4,
                   antiderivative=(y * width + sp.asin(y)) / 2)  # fmt: skip
    of_cube = y * (5 - 2 * y**2) * width / 8 + sp.Rational(3, 8) * sp.asin(y)
    proof.integral(sp.Integral(width**3, UNIT), width**3, UNIT, "and their cubes", value=3 * PI / 16,
                   antiderivative=of_cube)  # fmt: skip
    powers = cubed - 3 * l * (whole * y - y**3 / 3) + 3 * l**2 * line - l**3 * y
    known(proof)
    proof.integral(ball_edges, EDGE - l, UNIT, "trailing edges, positive", value=EDGES,
                   antiderivative=line - l * y)  # fmt: skip
    proof.integral(ball_cubes, (EDGE - l) ** 3, UNIT, "and their cubes", value=CUBES,
                   antiderivative=powers)  # fmt: skip
