"""A Maxwell arm over a step of the elements: its stress, its mean, its energy.

Stresses are in units of the stiffness K_i of the arm, time of the step h. The surface moves along a straight
line, by the rise r; z = h/tau_i. Everything is linear, so that one arm is enough.
"""

import sympy as sp

from ..engine.chapter import Chapter
from ..engine.nomenclature import letter, symbols
from ..engine.step import Proof
from .element_schemes import SECTION

letter(r"\check z", "time step over the relaxation time of an arm")
letter(r"\check t", "elapsed part of a time step")
letter(r"\check r", "rise of the surface in a time step", "m")
letter(r"\check s", "stress of an arm, in units of $K_i$", "m")
letter(r"\check s_0", r"$\check s$ at the start of the step", "m")

_z, _y = sp.symbols("z y", positive=True)
_rise, _first, _stress = sp.symbols("r s_0 s", real=True)
_spring, _damper = symbols(r"""
    k_arm  k_{\mathrm{r}}  1  stiffness of the spring that replaces an arm, in units of $K_i$
    c_arm  c_{\mathrm{r}}  1  damping beside that spring, in units of $K_i$ and of the step  real
""")
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
    proof.define(_stress, STRESS, "the stress")
    grows = sp.Derivative(_stress, _y)
    proof.equal(grows + _z * _stress, _rise, "the equation of the arm, with a steady rise")
    proof.equal(sp.Subs(_stress, _y, 0), _first, "and its stress at the start")
    end, ends = sp.Subs(_stress, _y, 1), _first * sp.exp(-_z) + _rise * END
    proof.equal(end, ends, "stress at the end of the step")
    over = (_y, 0, 1)
    proof.integral(sp.Integral(_stress, over), _stress, over, "mean stress",
                   value=_first * END + _rise * MEAN)  # fmt: skip
    reason = "the power that goes in is stored in the spring or lost in the damper"
    proof.equal(_rise * _stress, _stress * grows + _z * _stress**2, reason)
    proof.define(_spring, 2 * (END - MEAN), "the spring that replaces the arm on a ramp")
    proof.define(_damper, 2 * MEAN - END, "and the damper beside it")
    proof.equal(_spring + _damper, END, "the same stress at the end of the ramp")
    proof.equal(_spring / 2 + _damper, MEAN, "and the same mean")
    proof.leading_order(_damper, _z / 6, _z, 0, "the damper of a slow arm")
    reason = r"in units of $K_i \tau_i$: 1 for a fast arm"
    proof.equal(_z * _damper, 1 + sp.exp(-_z) - 2 * END, reason)
    proof.done(end, ends)
