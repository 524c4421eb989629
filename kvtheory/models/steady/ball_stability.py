r"""The numbers of the rates of a ball on a spring in the drive (theorem F22): sums over its strips.

A strip of the half length A has x_TE = sqrt(A^2 + l_r^2) - l_r and, per unit width, by F22

    dW/d(delta) = K (A + x_TE + l_r),                 dF/d(delta) = K (l_r/R) (A + x_TE),
    dW/d(ddelta/dt) = K tau (A + x_TE),               dF/dV = K tau (A^3 + x_TE^3)/(3 R^2),
    dW/dV = dF/d(ddelta/dt) = K tau (l_r/R) x_TE.

Strips that the motion lifts off or presses down carry nothing to first order. With A = a sqrt(1 - v^2),
y = v a sqrt(R'/R), l = l_r/a and the tail T of the load (derivation F20-tail), on either side of the middle
plane, in units of a and a^3,

    int A dv = pi/4,    X_1 = int x_TE dv = (l/3 + T/4)/(1 + l^2),
    int A^3 dv = 3 pi/16,    X_3 = int x_TE^3 dv = (3 T (1 + 5 l^2)/16 - l)/(1 + l^2),

by derivation F20-slopes. The last one loses digits for l >> 1, where it does not count beside 3 pi/16.
"""

from collections.abc import Mapping

import numpy as np
from numpy.typing import NDArray

from kvtheory.models.steady import ball
from kvtheory.models.steady import closed_forms as cf
from kvtheory.models.steady.spots import stretch_of
from kvtheory.models.steady.stability import Numbers

Array = NDArray[np.float64]
Values = Mapping[str, Array]


def numbers(values: Values, velocity: Array | None = None) -> Numbers:
    """Return the numbers of a scene with a ball, as `stability.numbers` does; `unit` is in N/m."""
    R, K, c = values["indenter.radius"], values["foundation.stiffness"], stretch_of(values)
    tau = values["foundation.retardation_time"]
    V = np.abs(values["drive.velocity"] if velocity is None else velocity)
    spring = values.get("support.stiffness", np.zeros_like(tau))
    depth = values.get("support.depth")
    held = depth is not None
    if depth is None:
        depth = ball.depth_at_load(R, c, K, tau, V, values["support.weight"], spring)
    a = np.sqrt(2.0 * R * depth)
    l = V * tau / a
    _, T = ball.angle_and_tail(l)
    A_1, A_3 = np.pi / 4.0, 3.0 * np.pi / 16.0
    X_1, X_3 = cf.ball_trailing_edges(l, T), cf.ball_cubed_trailing_edges(l, T)
    unit = 2.0 * K * a * (a * c)
    along = tau * unit * (a / R) ** 2 * ((A_3 + X_3) / 3.0)  # dF/dV, in N s/m
    across = tau * unit * (A_1 + X_1)  # dW/d(ddelta/dt), in N s/m
    coupled = l * X_1 / (A_1 + X_1)
    damped = along + values["drive.damping"]
    T_x = values["drive.mass"] / (damped * tau)
    S_c = (A_1 + X_1) / X_1
    g = coupled * (3.0 * l * X_1 / (A_3 + X_3)) * (along / damped)
    if held:
        endless = np.full_like(g, np.inf)
        return Numbers(np.zeros_like(g), T_x, endless, S_c, g, 1.0 - g, endless, damped / tau)
    S_z = (A_1 + X_1 + l) / (A_1 + X_1) + spring * tau / across
    return Numbers(
        T_z=values["support.mass"] / (across * tau),
        T_x=T_x,
        S_z=S_z,
        S_c=S_c,
        g=g,
        h=1.0 - g,
        e=S_z - g * S_c,
        unit=damped / tau,
    )
