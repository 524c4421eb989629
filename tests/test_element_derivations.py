"""The derivations of the schemes against numbers: the steps themselves, carried out in 30 digits."""

import mpmath as mp
import numpy as np
import pytest
import sympy as sp
from kvtheory.derivations.chapters import element_arms as arms
from kvtheory.derivations.chapters import element_edges as edges
from kvtheory.derivations.chapters import element_schemes as schemes
from kvtheory.derivations.chapters import element_strips as strips

from kvtheory.models.elements.kernels import (
    exponential_fit,
    kink_area,
    weigh,
)
from kvtheory.theory.laws import Element


def test_limit_of_the_papers_scheme():
    limit = mp.findroot(sp.lambdify(schemes._z, schemes.CUBIC), 2.8)
    assert mp.nstr(limit, 6) == "2.78529"


@pytest.mark.parametrize("z", [1e-9, 1e-3, 0.9e-2, 1.1e-2, 0.3, 3.0, 40.0, 1e6])
def test_exponential_fit_of_the_code_is_the_derived_one(z):
    with mp.workdps(40):
        exact = 1 / (1 - mp.exp(-mp.mpf(z))) - 1 / mp.mpf(z)
        assert exponential_fit(z) == pytest.approx(float(exact), rel=1e-12)
    assert 0.5 <= exponential_fit(z) <= 1.0


@pytest.mark.parametrize("z", [1e-6, 0.019, 0.021, 3.0, 1e4])
def test_ramp_of_an_arm_in_the_code_is_the_derived_one(z):
    step = Element.of(1.0, 0.0, [(1.0, 1.0)]).step(z)
    with mp.workdps(40):
        end, mean = (form.subs(arms._z, sp.Float(z, 40)) for form in (arms.END, arms.MEAN))
        assert step.ramp[0] == pytest.approx(float(end), rel=1e-12)
        assert step.stiffness - 0.5 == pytest.approx(float(mean), rel=1e-12)


def step_matrix(law, M, L, k_s, h, theta):
    """Return one implicit step of (d, v, s_i), the contact held, by solving its linear equations."""
    step, count = law.step(h), law.arm_stiffness.size
    # M (v1 - v0)/h = -L (K d0 + weights s_i + stiffness (d1 - d0)) - k_s ((1-theta) d0 + theta d1)
    # d1 - d0 = h ((1-theta) v0 + theta v1)
    new = np.array([[L * step.stiffness + theta * k_s, M / h], [1.0, -h * theta]])
    old = np.zeros((2, 2 + count))
    old[0, :2] = L * (step.stiffness - law.stiffness) - (1.0 - theta) * k_s, M / h
    old[0, 2:] = -L * step.weights
    old[1, :2] = 1.0, h * (1.0 - theta)
    whole = np.zeros((2 + count, 2 + count))
    whole[:2] = np.linalg.solve(new, old)
    whole[2:, 2:] = np.diag(step.held)
    whole[2:] += step.ramp[:, None] * (whole[0] - np.eye(2 + count)[0])
    return whole


def test_no_implicit_step_amplifies():
    """On Kelvin-Voigt and on any arms."""
    rng = np.random.default_rng(3)
    for k in range(1000):
        arms = 10.0 ** rng.uniform(-2, 2, (int(rng.integers(1, 6)) if k % 2 else 0, 2))
        law, (M, L, k_s, h) = Element.of(1.0, 1.0, arms), 10.0 ** rng.uniform([-5, -2, -3, -4], 3)
        for theta in (0.5, exponential_fit(h * law.step(h).damping * L / M), 1.0)[1 - k % 2 :]:
            radius = np.abs(np.linalg.eigvals(step_matrix(law, M, L, k_s, h, theta))).max()
            assert radius <= 1.0 + 1e-9


@pytest.mark.parametrize(("fitted", "order"), [(False, 1), (True, 2)])
def test_orders_by_the_eigenvalues_of_a_step(fitted, order):
    epsilon, b, kappa = 0.2, 0.9, 0.4
    exact = max(np.roots([epsilon, b, b + kappa]), key=lambda rate: rate.imag)
    errors = []
    for h in (0.04, 0.02, 0.01):
        theta = exponential_fit(h * b / epsilon) if fitted else 1.0
        matrix = step_matrix(Element.of(1.0, 1.0), epsilon, b, kappa, h, theta)
        values = np.linalg.eigvals(matrix).astype(complex)
        errors.append(min(abs(np.log(values) / h - exact)))
    assert np.log2(errors[1] / errors[2]) == pytest.approx(order, abs=0.05)


def test_sawtooth_and_kink_by_brute_force():
    """A pressure 3 - 2 x from an edge on, and two straight lines, integrated without the theorems."""
    dx, share = 0.01, 0.3
    x = dx * (np.arange(100) + share)
    end = x[-1] + 0.5 * dx
    excess = dx * (3.0 - 2.0 * x).sum() - (3.0 * end - end**2)
    first = (share - 0.5) * dx
    assert excess == pytest.approx(-(3.0 * first - first**2), rel=1e-9)
    outside, inside = -0.2, 0.7
    fine = np.linspace(0.0, dx, 100_001)
    area = np.trapezoid(np.maximum(outside + (inside - outside) * fine / dx, 0.0), fine)
    kink = edges.KINK.subs({edges._spacing: dx, edges._inside: inside, edges._outside: outside})
    assert area - 0.5 * dx * inside == pytest.approx(float(kink), rel=1e-9)


@pytest.mark.parametrize(("outside", "inside"), [(-0.2, 0.7), (-1e-9, 0.3), (-0.8, 1e-6)])
def test_correction_of_the_code_is_the_derived_one(outside, inside):
    places = {edges._spacing: 0.02, edges._inside: inside, edges._outside: outside}
    correction = edges.KINK + edges.END
    rise = inside - outside
    area, rate, bent = (0.02 * each for each in kink_area(outside - rise * np.arange(3.0)))
    assert area == pytest.approx(float(correction.subs(places)), rel=1e-12)
    # With the depth the overlap rises by the same everywhere.
    rises = sp.diff(correction, edges._inside) + sp.diff(correction, edges._outside)
    assert rate == pytest.approx(float(rises.subs(places)), rel=1e-12)
    faster = sp.diff(rises, edges._inside) + sp.diff(rises, edges._outside)
    assert bent == pytest.approx(float(faster.subs(places)), rel=1e-12)


def test_correction_leaves_out_what_the_derivation_says(by_label):
    """A bent overlap, summed by the code's own rule and integrated by a formula."""
    dx, share, m, bend = 0.01, 0.3, 0.4, 5.0
    overlap = lambda x: m * (x - share * dx) + 0.5 * bend * (x - share * dx) ** 2  # noqa: E731
    nodes = dx * np.arange(1, 40)
    y = nodes[-1] - share * dx
    area = m * y**2 / 2 + bend * y**3 / 6
    sums = dx * overlap(nodes).sum() - dx * overlap(nodes[-1]) / 2
    sums -= dx**2 / 12 * (m + bend * y)
    step = by_label["element-bent"].steps[-1].claim
    places = {edges._spacing: dx, edges._share: share, edges._slope: m, edges._bend: bend}
    left = float(step.rhs.subs(places))
    rise = overlap(dx) - overlap(0.0)
    added = dx * kink_area(overlap(0.0) - rise * np.arange(3.0))[0]
    assert area - sums - added == pytest.approx(left, rel=1e-6)


def test_what_the_rule_over_strips_has_too_much_is_hurwitz_zeta_function():
    start, strip = sp.lambdify(strips._v, strips.START, "mpmath"), 300
    with mp.workdps(30):
        for v in (mp.mpf("0.01"), mp.mpf("0.4"), mp.mpf(1)):
            # START less all Q up to a strip; what follows is between zero and a bound.
            whole = start(v + strip) + mp.fsum((v + j) ** 1.5 for j in range(strip))
            assert 0 < whole - mp.zeta(-1.5, v) < (strip - 1) ** -1.5 / 1920


@pytest.mark.parametrize("share", [0.1, 0.5, 0.9])
def test_order_of_the_rule_over_the_strips_of_a_ball(share):
    """At a given place of the rim the error falls as the derivation says, with its factor."""
    l, left = 0.7, []
    tail = 2 * (1 + l * l) ** 2 * np.arctan(1 / l) - 2 * l**3 - 10 * l / 3
    whole = (np.pi + 16 * l / 3 + tail) / 4  # F20
    counts = np.array([400, 1600])
    for count in counts:
        dy = 1.0 / (count + share)
        bent = 1.0 - (dy * np.arange(count + 1)) ** 2
        loads = 2 / 3 * (bent**1.5 + (bent + l * l) ** 1.5 - l**3)
        surplus = float(weigh(np.empty(count + 1), dy, 1.0) @ loads) - whole
        left.append(surplus / (2 * 4 * np.sqrt(2) / 3 * dy**2.5))
    due = float(mp.zeta(-1.5, share)) + float(strips.SECOND.subs(strips._share, share))
    assert left == pytest.approx([due, due], rel=0.1)
    assert 2.0 * left[1] - left[0] == pytest.approx(due, rel=0.01)  # without the order 3
