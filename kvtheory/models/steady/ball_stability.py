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

import numpy as np

from kvtheory.models.steady import ball
from kvtheory.models.steady.stability import Numbers
from kvtheory.scene.model import Scene
from kvtheory.theory import closed_forms as cf


def numbers(scene: Scene) -> Numbers:
    """Return the numbers of a scene with a ball, as `stability.numbers` does; `unit` is in N/m."""
    foundation, support, drive = scene.foundation, scene.support, scene.drive
    R, K, tau = scene.indenter.radius, foundation.stiffness, foundation.retardation_time
    a = np.sqrt(2.0 * R * ball.depth(scene))
    l = np.abs(drive.final_velocity) * tau / a
    _, T = ball.angle_and_tail(l)
    A_1, A_3 = np.pi / 4.0, 3.0 * np.pi / 16.0
    X_1, X_3 = cf.ball_trailing_edges(l, T), cf.ball_cubed_trailing_edges(l, T)
    unit = 2.0 * K * a * (a * scene.indenter.stretch)
    along = tau * unit * (a / R) ** 2 * ((A_3 + X_3) / 3.0)  # dF/dV, in N s/m
    across = tau * unit * (A_1 + X_1)  # dW/d(ddelta/dt), in N s/m
    coupled = l * X_1 / (A_1 + X_1)
    damped = along + drive.damping
    T_x = scene.drive_mass / (damped * tau)
    S_c = (A_1 + X_1) / X_1
    g = coupled * (3.0 * l * X_1 / (A_3 + X_3)) * (along / damped)
    if scene.held:
        endless = np.full_like(g, np.inf)
        return Numbers(np.zeros_like(g), T_x, endless, S_c, g, 1.0 - g, endless, damped / tau)
    S_z = (A_1 + X_1 + l) / (A_1 + X_1) + support.spring * tau / across
    return Numbers(
        T_z=support.mass / (across * tau),
        T_x=T_x,
        S_z=S_z,
        S_c=S_c,
        g=g,
        h=1.0 - g,
        e=S_z - g * S_c,
        unit=damped / tau,
    )
