r"""An elastic layer bonded to a rigid ground (F30): its compliance in plane strain, from Navier's equations.

With the wave number k of the pressure and kappa = k H, the depression is that of a half-space times T(kappa).
The mean stress is an unknown of its own, so that an incompressible layer is no special case.
"""

import sympy as sp

from ..engine.chapter import Chapter
from ..engine.nomenclature import function, symbols
from ..engine.step import Proof
from .model import x

(
    poisson, modulus, thickness, wave, height, kappa_h, size, in_phase, out_of_phase, transfer, crest, pull,
    squeezed,
) = symbols(r"""
    nu_P     \nu_{\mathrm{P}}  1    Poisson's ratio of the layer  from scene
    E_0      -                Pa   modulus of the layer, relaxed  from scene
    H        -                m    thickness of the layer  from scene
    k_w      k_{\mathrm{c}}   1/m  wave number of a pressure along the layer
    z_H      z_{\mathrm{l}}   m    height above the ground  real
    kappa_H  \kappa_H         1    scaled wave number, $k_{\mathrm{c}} H$
    b_H      -                m    size of a wave in a layer
    A_H      A_{\mathrm{l}}   m    amplitude of a wave in a layer  real
    B_H      B_{\mathrm{l}}   m    another one  real
    T_H      -                1    depression of a layer over that of a half-space  real
    w_c      -                m    amplitude of the displacement of the surface of a layer  real
    p_c      -                Pa   amplitude of the stress there  real
    e_H      -                1    $1 - 2 \nu_{\mathrm{P}}$  nonnegative
""")  # fmt: skip
along = function("u_H", "displacement along the layer", "m", real=True)
up = function("w_H", "displacement upward", "m", real=True)
mean = function("s_H", r"change of volume over $1 - 2 \nu_{\mathrm{P}}$", "1", real=True)

SECTION = "A layer"
nu, k, z, kappa = poisson, wave, height, kappa_h
A = size * (2 * (1 - nu) * sp.cosh(kappa) + kappa * sp.sinh(kappa))
B = size * ((1 - 2 * nu) * sp.sinh(kappa) - kappa * sp.cosh(kappa))
_C, _S = sp.cosh(k * z), sp.sinh(k * z)
_FREE, _HALF = (3 - 4 * nu) * _S, sp.Rational(1, 2)
ALONG = _HALF * (_FREE * out_of_phase + k * z * (in_phase * _S + out_of_phase * _C)) * sp.sin(k * x)
UP = _HALF * (_FREE * in_phase - k * z * (in_phase * _C + out_of_phase * _S)) * sp.cos(k * x)
MEAN = k * (in_phase * _C + out_of_phase * _S) * sp.cos(k * x)
UPPER = (3 - 4 * nu) * sp.sinh(2 * kappa) - 2 * kappa
LOWER = (3 - 4 * nu) * sp.cosh(2 * kappa) + 2 * kappa**2 + 5 - 12 * nu + 8 * nu**2
TRANSFER = UPPER / LOWER
result = Chapter(SECTION)


@result("F30-balance")
def _balance(proof: Proof) -> None:
    r"""Layer: Navier's equations with the mean stress as an unknown.

    Hooke's law in plane strain: the stress is $E_0/(1 + \nu_{\mathrm{P}})$ times the strain, to which
    $\nu_{\mathrm{P}} s_H$ is added on the diagonal. Nothing is divided by $1 - 2 \nu_{\mathrm{P}}$, so that
    an incompressible layer, $\nu_{\mathrm{P}} = 1/2$, is one of these.
    """
    u, w, s = (each(x, z) for each in (along, up, mean))
    d, half = sp.Derivative, sp.Rational(1, 2)
    change = (1 - 2 * nu) * d(s, x) - d(u, x, 2)
    proof.define(d(w, x, z), change, r"the change of volume is $(1 - 2 \nu_{\mathrm{P}}) s_H$")
    balance = d(d(u, x) + nu * s, x) + half * d(d(u, z) + d(w, x), z)
    form = half * (d(u, x, 2) + d(u, z, 2) + d(s, x))
    proof.equal(balance, form, r"force along the layer over $E_0/(1 + \nu_{\mathrm{P}})$: zero")
    proof.done(balance, form)


@result("F30-field")
def _field(proof: Proof) -> None:
    r"""Layer: what a pressure of one wave number does.

    Both amplitudes are those of a surface without shear.

    Argued: Nothing else obeys these equations with the same pressure, as solutions in elasticity are unique
    (Kirchhoff).
    """
    u, w, s = (each(x, z) for each in (along, up, mean))
    d, zero = sp.Derivative, sp.S.Zero
    for field, value in ((u, ALONG), (w, UP), (s, MEAN)):
        proof.define(field, value, "a wave along the layer")
    proof.equal(d(u, x) + d(w, z), (1 - 2 * nu) * s, "change of volume")
    proof.equal(d(u, x, 2) + d(u, z, 2) + d(s, x), zero, "balance along the layer, F30-balance")
    proof.equal(d(w, x, 2) + d(w, z, 2) + d(s, z), zero, "balance across it, likewise")
    proof.equal(sp.Subs(u, z, 0), zero, "bonded to the ground")
    proof.equal(sp.Subs(w, z, 0), zero, "likewise")
    proof.define(k, kappa / thickness, "scaled wave number")
    proof.define(in_phase, A, "one amplitude")
    proof.define(out_of_phase, B, "the other one follows, as there is")
    proof.equal(sp.Subs(d(u, z) + d(w, x), z, thickness), zero, "no shear at the surface")


@result("F30")
def _compliance(proof: Proof) -> None:
    r"""Layer: its compliance.

    For $0 < \nu_{\mathrm{P}} \le 1/2$. The depression of the surface is $\frac{2 (1 -
    \nu_{\mathrm{P}}^2)}{E_0 k_{\mathrm{c}}} T_H$ times the pressure.
    """
    w, s = up(x, z), mean(x, z)
    proof.recall("F30-field", w, s, k, in_phase, out_of_phase)
    proof.define(nu, (1 - squeezed) / 2, r"$\nu_{\mathrm{P}} \le 1/2$")
    phase, stress = sp.cos(k * x), modulus / (1 + nu) * (sp.Derivative(w, z) + nu * s)
    proof.define(crest, size * (1 - nu) / 2 * UPPER, "its amplitude")
    proof.equal(sp.Subs(w, z, thickness), crest * phase, "displacement of the surface")
    proof.define(pull, size * modulus * k / (4 * (1 + nu)) * LOWER, "its amplitude")
    proof.equal(sp.Subs(stress, z, thickness), pull * phase, "stress there, by Hooke's law")
    proof.define(transfer, modulus * k * crest / (2 * (1 - nu**2) * pull), "over a half-space's")
    proof.equal(transfer, TRANSFER, "the compliance")


DEPRESSION = 2 * (1 - nu**2) * thickness / (modulus * kappa) * transfer
"""That of the surface, over the pressure."""


@result("F30-thin")
def _thin(proof: Proof) -> None:
    r"""Thin layer: independent elements, $1/K$, and the next term.

    For $\nu_{\mathrm{P}} < 1/2$. So the $K$ of a thin layer is
    $\frac{E_0 (1 - \nu_{\mathrm{P}})}{(1 + \nu_{\mathrm{P}}) (1 - 2 \nu_{\mathrm{P}}) H}$; it fails by
    the next term, which grows beyond all bounds as $\nu_{\mathrm{P}} \to 1/2$.
    """
    proof.recall("F30")
    proof.define(nu, (1 - squeezed) / 2, r"$\nu_{\mathrm{P}} \le 1/2$")
    thin = (1 + nu) * (1 - 2 * nu) * thickness / (modulus * (1 - nu))
    proof.where(sp.Gt(squeezed, 0), r"compressible")
    proof.leading_order(DEPRESSION, thin, kappa, 0, "a long wave")
    next_term = (squeezed - 1) * (2 * squeezed - 1) / (3 * squeezed * (squeezed + 1))
    proof.equal(next_term, nu * (4 * nu - 1) / (3 * (1 - nu) * (1 - 2 * nu)), "next coefficient")
    proof.done(DEPRESSION, thin)


@result("F30-incompressible")
def _incompressible(proof: Proof) -> None:
    r"""Thin layer: one that cannot be compressed.

    For $\nu_{\mathrm{P}} = 1/2$. The layer flows sideways, and no $K$ describes it.
    """
    proof.define(nu, sp.Rational(1, 2), "no change of volume")
    proof.recall("F30")
    proof.leading_order(DEPRESSION, thickness * kappa**2 / modulus, kappa, 0, "a long wave")


@result("F30-thick")
def _thick(proof: Proof) -> None:
    r"""Thick layer: a half-space.

    All that differs from 1 goes with $e^{-2 \kappa_H}$, $\kappa_H e^{-2 \kappa_H}$ or $\kappa_H^2 e^{-2
    \kappa_H}$, and vanishes as $\kappa_H \to \infty$: short waves do not reach the ground. In this form
    nothing overflows.
    """
    fade = sp.exp(-2 * kappa)
    proof.recall("F30")
    proof.define(nu, (1 - squeezed) / 2, r"$\nu_{\mathrm{P}} \le 1/2$")
    proof.holds(kappa**2 * fade, "<", 16 / kappa**2, r"largest of these terms for $\kappa_H > 1$")
    top = (3 - 4 * nu) * (1 - fade**2) - 4 * kappa * fade
    bottom = (3 - 4 * nu) * (1 + fade**2) + 2 * (2 * kappa**2 + 5 - 12 * nu + 8 * nu**2) * fade
    proof.equal(transfer, top / bottom, "in these")
