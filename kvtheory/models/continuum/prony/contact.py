r"""The contact of a parabola with a Prony series: accumulators, and the history of the leading edge (F23).

Scaled form, with k_i = K_i/K and T_i = tau_i/tau: u = d - xi^2 in the contact, p = u + sum s_i. An element at
X = xi - Y that entered at sigma, where the leading edge l = -sqrt(d) was at X, has

    s_i = k_i {A_i - xi B_i - e^-(s - sigma)/T_i [A_i - l B_i](sigma)},

    A_i' = d' + lambda B_i - A_i/T_i,   B_i' = 2 lambda - B_i/T_i,

A_i and B_i starting at zero; the elements in contact at rest lack the term in brackets. Along the contact

    ds_i/dxi = -k_i {B_i + e^-(s - sigma)/T_i [2 l - B_i](sigma)},

and the trailing edge is p = 0. Its velocity through the material is -p'/(dp/dxi), p' at constant X. The
moments F_i and M_i of s_i over the contact, from which both forces follow, obey, with I_n = int xi^n dxi,

    F_i' = k_i (d' I_0 - 2 lambda I_1) + s_i(r) (r' - lambda) - F_i/T_i,
    M_i' = lambda F_i + k_i (d' I_1 - 2 lambda I_2) + r s_i(r) (r' - lambda) - M_i/T_i.

A step stores polynomials over its length, a row for each quantity; the memory is evaluated from them, also
within the step that is being solved. Where the history has a kink, the step that begins there says so: an
element is found among the steps between two kinks, whose polynomials are continued beyond, and the instant at
which the trailing edge passes a kink ends a step.
"""

import math
from typing import Any

from kvtheory.scene.base_motion import evaluate

RATE, ALONG, EDGE, PER_ARM = 0, 1, 2, 3
"""Rows of a step: d', x', r; then, for each arm, A_i, B_i, s_i(r), F_i and M_i."""
DEPTHS, SLIDES, STRESSES, FORCES, MOMENTS = range(5)
"""Rows of an arm."""
OWN = 5

NEWTON_STEPS = 40
EDGE_ERROR = 1e-15
"""Allowed error of the trailing edge, relative to 1 + Y."""
AT_REST = -1
"""Number of the step in which an element entered that was in contact at rest."""

Run = Any


def value(row: Any, theta: float) -> float:
    """Return a polynomial at `theta`."""
    total = 0.0
    for k in range(len(row) - 1, -1, -1):
        total = total * theta + row[k]
    return total


def integral(row: Any, theta: float) -> float:
    """Return the integral of a polynomial from 0 to `theta`."""
    total = 0.0
    for k in range(len(row) - 1, -1, -1):
        total = total * theta + row[k] / (k + 1)
    return total * theta


def motion(run: Run, index: int, s: float) -> tuple[float, float, float, float, float]:
    """Return d, d', Y, lambda and theta at `s`, from a step."""
    step, rows = run.steps[index], run.rows[index]
    theta = (s - step.start) / step.span
    Y, number, _ = evaluate(run.pieces[step.piece], s)
    d = step.depth + step.span * integral(rows[RATE], theta)
    if run.given.sprung:
        Y -= step.along + step.span * integral(rows[ALONG], theta)
        number -= value(rows[ALONG], theta)
    return d, value(rows[RATE], theta), Y, number, theta


def entered(run: Run, index: int, sigma: float) -> int:
    """Return the step in which an element entered at `sigma`, between the same kinks as the step `index`."""
    steps, last = run.steps, run.now.steps
    while index < last and sigma >= steps[index + 1].start and not steps[index + 1].kinked:
        index += 1
    while index > 0 and sigma < steps[index].start and not steps[index].kinked:
        index -= 1
    return index


def arms(
    run: Run, s: float, xi: float, index: int, sigma: float, l: float, theta: float, here: Any
) -> tuple[float, float, float]:
    """Return sum s_i, its slope over xi and sum s_i/T_i of an element, and write s_i.

    The step `index` is that in which the element entered, at `sigma` and theta, where the leading edge was
    at `l`. `here` has A_i, B_i at present, and s_i.
    """
    total = slope = relaxing = 0.0
    for i in range(len(run.arms)):
        k, T = run.arms[i, 0], run.arms[i, 1]
        row = here[i]
        A, B = row[DEPTHS], row[SLIDES]
        stress, change = A - xi * B, B
        if index != AT_REST:
            rows, first = run.rows[index], PER_ARM + OWN * i
            A, B = value(rows[first + DEPTHS], theta), value(rows[first + SLIDES], theta)
            fall = math.exp(min((sigma - s) / T, 1.0))
            stress -= fall * (A - l * B)
            change += fall * (2.0 * l - B)
        row[STRESSES] = k * stress
        total += k * stress
        slope -= k * change
        relaxing += k * stress / T
    return total, slope, relaxing


def trailing(
    run: Run, s: float, d: float, v: float, Y: float, number: float, r: float, index: int,
    sigma: float, here: Any,
) -> tuple[float, float, int, float, float]:  # fmt: skip
    """Return r, r' - lambda, the step and the instant at which the element there entered, and p' there.

    By Newton's method from a guess of `r`, of elements that were in contact at rest, or of `sigma`. NaN if it
    does not converge.
    """
    l = theta = 0.0
    for _ in range(NEWTON_STEPS):
        if index != AT_REST:
            index = entered(run, index, sigma)
            d_0, v_0, Y_0, number_0, theta = motion(run, index, sigma)
            if not d_0 > 0.0:
                return math.nan, math.nan, index, sigma, math.nan
            l = -math.sqrt(d_0)
            r = l - Y_0 + Y
        total, slope, relaxing = arms(run, s, r, index, sigma, l, theta, here)
        p, slope = d - r * r + total, slope - 2.0 * r
        move = -p / slope
        if abs(move) <= EDGE_ERROR * (1.0 + abs(Y)):
            loading = (1.0 + run.given.glass) * (v - 2.0 * r * number)
            rate = loading - relaxing
            return r, -rate / slope, index, sigma, rate
        if index == AT_REST:
            r += move
        else:
            sigma = min(sigma + move / (0.5 * v_0 / l - number_0), s)
    return math.nan, math.nan, index, sigma, math.nan
