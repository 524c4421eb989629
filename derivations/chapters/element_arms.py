"""A Maxwell arm over a step of the elements: its stress, its mean, its energy.

Stresses are in units of the stiffness K_i of the arm, time of the step h. The surface moves along a straight
line, by the rise r; z = h/tau_i. Everything is linear, so that one arm is enough.
"""

import sympy as sp

from ..engine.chapter import Chapter
from ..engine.nomenclature import letter
from ..engine.step import Proof, tex
from .element_schemes import SECTION

letter(r"\check z", "time step over the relaxation time of an arm")
letter(r"\check t", "elapsed part of a time step")
letter(r"\check r", "rise of the surface in a time step", "m")
letter(r"\check s", "stress of an arm, in units of $K_i$", "m")
letter(r"\check s_0", r"$\check s$ at the start of the step", "m")

_z, _y = sp.symbols("z y", positive=True)
_rise, _first, _stress = sp.symbols("r s_0 s", real=True)
result = Chapter(SECTION)

END = (1 - sp.exp(-_z)) / _z
"""phi_1: the stress of a unit ramp at the end of the step."""
MEAN = (1 - END) / _z
"""phi_2: its mean."""
STRESS = _first * sp.exp(-_z * _y) + _rise * (1 - sp.exp(-_z * _y)) / _z


@result("element-arms")
def _arm(proof: Proof) -> None:
    r"""An arm over a step.

    The stress of an arm grows by $K_i u'$ with the compression $u$ and decays at the rate $1/\tau_i$. In
    units of $K_i$ and of the step, with $z$ the step over $\tau_i$ and a surface that rises by $r$ along a
    straight line, the stress $s$ obeys $s' = r - z s$ over $0 < y < 1$. The mean stress times the rise is the
    work done on the arm, so that a step of elements in contact balances energy exactly. A spring and a damper
    in parallel can replace the arm on a ramp: the damper of a fast arm is $K_i \tau_i$, that of a slow one is
    of second order in the step.
    """
    proof.equal(
        sp.Derivative(STRESS, _y) + _z * STRESS,
        _rise,
        "the equation of the arm, with a steady rise",
    )
    proof.equal(sp.Subs(STRESS, _y, 0), _first, "and its stress at the start")
    ends = _first * sp.exp(-_z) + _rise * END
    proof.equal(sp.Subs(STRESS, _y, 1), ends, "stress at the end of the step")
    over = (_y, 0, 1)
    falling = -_first * sp.exp(-_z * _y) / _z
    rising = _rise * (_y + sp.exp(-_z * _y) / _z) / _z
    proof.integral(
        *(sp.Integral(STRESS, over), STRESS, over, falling + rising), "mean stress",
        value=_first * END + _rise * MEAN,
    )  # fmt: skip
    proof.equal(
        _rise * STRESS, STRESS * sp.Derivative(STRESS, _y) + _z * STRESS**2,
        "the power that goes in is stored in the spring or lost in the damper",
    )  # fmt: skip
    damper, spring = 2 * MEAN - END, 2 * (END - MEAN)
    shown = rf"\left({tex(spring)}\right) + \left({tex(damper)}\right)"
    proof.equal(spring + damper, END, left=shown,
                reason="a spring and a damper with the same stress at the end of the ramp")  # fmt: skip
    proof.equal(spring / 2 + damper, MEAN, "and the same mean", left=rf"\frac{{1}}{{2}} {shown}")
    proof.leading_order(damper, _z / 6, _z, 0, "the damper of a slow arm", eps=_z)
    proof.equal(
        _z * damper, 1 + sp.exp(-_z) - 2 * END, r"in units of $K_i \tau_i$: 1 for a fast arm"
    )
    proof.done(sp.Subs(STRESS, _y, 1), ends)
