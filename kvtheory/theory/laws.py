r"""Laws of the foundation: moments and responses of a relaxation function G(t).

`Prony` is a spring, a damper and Maxwell arms in parallel, G = K + C delta(t) + sum K_i e^(-t/tau_i); with a
damper alone it is Kelvin-Voigt. `Fractional` is a spring and a springpot. `over` turns a law in time into one
in the distance X = V t travelled in the contact, which all that follows is about.

Steady sliding of a parabola needs four moments over a contact of length c (theorem F17): with w the distance
to the trailing edge over c and g(w) = G(c w/V),

    P = int g (1 - w),   Q = int g w,   D = int g w (1 - w)/2,   E = int g (1 - 3 w + 2 w^3)/12,

all over 0 < w < 1, none negative if G falls and is convex. No sum in them cancels.

Stability needs the response to small motions e^(st) (theorem F24). A depth delta_1 e^(st) and a displacement
X_1 e^(st) along x change the forces of a parabola by

    F_z1 = A delta_1 + B X_1,    F_x1 = C delta_1 + D X_1.

With the half length at rest (1/2 + eta) c, sigma = s c/V, z = c/(V tau_i), m = z + sigma and
phi_n(-m) = int_0^1 e^(-m v) (1 - v)^(n-1)/(n-1)! dv, each arm adds

    A:   K_i c [phi_1 + sigma phi_2],
    B:   K_i (c^2/R) z [Delta_3 - (1/2 + eta) Delta_2],
    C:  -K_i (c^2/R) [(1/2 - eta) (phi_1 + sigma phi_2) - phi_2 - sigma phi_3],
    D:  -K_i (c^3/R^2) z [Delta_3 - Delta_4 - (1/4 - eta^2) Delta_2],

all phi at -m, Delta_n = phi_n(-z) - phi_n(-m), to K c in A and K eta c^2/R in C. Nothing cancels for stiff,
fast arms; a small sigma is taken out of Delta_n as a factor. A damper is their limit.
"""

import math
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from kvtheory.theory import closed_forms as cf
from kvtheory.theory.powers import power

Array = NDArray[np.float64]
Complex = NDArray[np.complex128]

RELATIVE_ERROR = 24 * float(np.finfo(float).eps)
"""5.3e-15, of results that follow from the moments: twice the largest error found against 50 digits."""
FRACTION_TERMS = 10
"""Terms of the continued fraction for z <= 4: the next one is below rounding."""
FAR = 1e150
"""z of an arm that relaxes immediately: its square is still finite."""
NEAR = 2.0
"""Arguments of phi below which the recurrence upwards loses digits, and the power series does not."""
INVERSE_FACTORIALS = [1.0 / math.factorial(n) for n in range(26)]


class Moments(NamedTuple):
    """Moments of the relaxation function over a contact of length c, in N/m^3."""

    P: Array
    Q: Array
    D: Array
    E: Array
    end: Array
    """G at the trailing edge."""
    end_slope: Array
    """c dG/dc there."""
    arms: tuple[Array, ...] = ()
    """P, Q and E over the stiffness, and z, of each arm."""

    @property
    def eta(self) -> Array:
        """(P - Q)/(2 (P + Q)): the half length at rest is (1/2 + eta) c."""
        return 0.5 * (self.P - self.Q) / (self.P + self.Q)


class Prony(NamedTuple):
    """G = K + C delta(t) + sum K_i e^(-t/tau_i); arms along the first axis of `stiffness` and `time`."""

    K: Array
    stiffness: Array
    time: Array
    """Relaxation times; lengths of a law in distance."""
    damping: Any = None
    """C, or None without a damper."""

    def over(self, V: Array) -> "Prony":
        """Return the law in the distance travelled at a velocity V >= 0; at rest all arms are relaxed."""
        moving = V != 0.0
        lengths = np.where(moving, V * self.time, 1.0)
        damping = None if self.damping is None else self.damping * V
        return Prony(self.K, self.stiffness * moving, lengths, damping)

    def at(self, *index: Any) -> "Prony":
        """Return the laws of some scenes, by an index of their last axis."""
        K, stiffness, time = (each[(..., *index)] for each in self[:3])
        damping = None if self.damping is None else self.damping[(..., *index)]
        return Prony(K, stiffness, time, damping)

    def moments(self, c: Array) -> Moments:
        """Return the moments over a contact of length c."""
        K, z = self.K, np.minimum(c / self.time, FAR)
        P, Q, D, E, end = exponential_moments(z)
        rows = self._sum(P), self._sum(Q), self._sum(D), self._sum(E)
        first, last = 0.5 * K + rows[0], rows[3]
        if self.damping is not None:
            first, last = first + self.damping / c, last + self.damping / (12.0 * c)
        second, third = 0.5 * K + rows[1], K / 12.0 + rows[2]
        ends = K + self._sum(end), -self._sum(z * end)
        return Moments(first, second, third, last, *ends, (P, Q, E, z))

    def dissipated(self, M: Moments, c: Array, work: Array) -> tuple[Array, Array]:
        """Return the share of the work that is lost in the contact, all terms positive, and its error."""
        (P, Q, E, z), eta = M.arms, M.eta
        lost = self._sum(cf.arm_lost(P + Q, 0.5 * (P - Q), E, P, eta, z))
        if self.damping is not None:
            lost = lost + self.damping / c * (1.0 / 12.0 + eta * eta)
        return lost / work, np.full_like(work, RELATIVE_ERROR)

    def modulus(self, X: Array) -> tuple[Array, Array, Array]:
        """Return G, X dG/dX and the mean of G up to X > 0."""
        z = np.minimum(X / self.time, FAR)
        end = np.exp(-z)
        mean = self.K + self._sum(-np.expm1(-z) / np.maximum(z, np.finfo(float).tiny))
        mean = mean if self.damping is None else mean + self.damping / X
        return self.K + self._sum(end), -self._sum(z * end), mean

    def least_peak(self, a: Array) -> Array:
        """Return a distance at which the pressure still rises, or at which it is its limit at X = 0."""
        least = 0.25 * a if self.damping is None else np.finfo(float).eps * a
        return np.minimum(least, 0.5 * self.time.min(axis=0, initial=np.inf))

    def response(self, c: Array, eta: Array, sigma: Complex) -> tuple[Complex, ...]:
        """Return A/c, B R/c^2, C R/c^2 and D R^2/c^3."""
        A, C = self.K * np.ones_like(sigma), self.K * eta * np.ones_like(sigma)
        B, D = np.zeros_like(sigma), np.zeros_like(sigma)
        square = (0.5 - eta) * (0.5 + eta)
        first = phi(np.where(np.abs(sigma) < 1.0, sigma, 1.0).astype(complex))[0]
        for stiffness, length in zip(self.stiffness, self.time, strict=True):
            z = c / length
            one, two, three, _ = phi(z + sigma)
            second, third, fourth = differences(z, sigma, first)
            whole = one + sigma * two
            A += stiffness * whole
            C -= stiffness * ((0.5 - eta) * whole - two - sigma * three)
            B += stiffness * z * (third - (0.5 + eta) * second)
            D -= stiffness * z * (third - fourth - square * second)
        if self.damping is not None:
            share = self.damping / c
            A += share * (1.0 + sigma)
            B -= share * eta * sigma
            C += share * (0.5 + eta + eta * sigma)
            D -= share * (1.0 / 12.0 + eta * eta) * sigma
        return A, B, C, D

    def _sum(self, rows: Array) -> Array:
        total: Array = (self.stiffness * rows).sum(axis=0)
        return total


def exponential_moments(z: Array) -> tuple[Array, Array, Array, Array, Array]:
    """Return P, Q, D, E and the end value of g = e^(-z w), z >= 0, to a few units in the last place.

    They follow from A = e^(-z/2) i_0 and t_n, where i_n(z/2) = i_(n-1)(z/2) (z/2) t_(n-1) are the modified
    spherical Bessel functions. For z <= 4 the t_n are continued fractions of positive terms; beyond, t_0 =
    (coth(z/2) - 2/z) 2/z and what follows from it lose no digits (derivation F17-arm).
    """
    x, fall = 0.5 * z, np.expm1(-z)  # e^-z - 1
    near = x <= 2.0
    square, far = np.where(near, x * x, 0.0), np.where(near, 3.0, x)
    t = np.full_like(x, 1.0 / (2.0 * FRACTION_TERMS + 3.0))
    for n in range(FRACTION_TERMS - 1, 0, -1):
        np.multiply(square, t, out=t)
        t += 2.0 * n + 3.0
        np.reciprocal(t, out=t)
    rest = 1.0 / far + 2.0 * (1.0 + fall) / np.where(near, -1.0, fall)  # 1 - coth x + 1/x
    t_0 = np.where(near, 1.0 / (3.0 + square * t), (1.0 - rest) / far)
    t_1 = np.where(near, t, (1.0 / t_0 - 3.0) / (far * far))
    moving = z > 0.0
    A = np.where(moving, -fall / np.where(moving, z, 1.0), 1.0)
    Q = 0.5 * A * np.where(near, 1.0 - x * t_0, rest)
    ahead, bulge, twist = (
        cf.arm_ahead(A, t_0, x),
        cf.arm_bulge(A, t_0),
        cf.arm_twist(A, t_0, t_1, x),
    )
    return ahead, Q, bulge, twist, 1.0 + fall


class Fractional:
    """G = K [1 + (t/tau)^(-alpha)/Gamma(1 - alpha)]: each moment is a Gamma function."""

    def __init__(
        self, K: Array, time: Array, order: Array, known: list[Array] | None = None
    ) -> None:
        self.K, self.time, self.alpha = K, time, order
        if known is None:
            from scipy.special import rgamma

            known = [rgamma(n - order) for n in range(1, 5)]
            names = ("ahead", "behind", "bulge", "twist")
            known += [known[1] * getattr(cf, f"springpot_{name}")(1.0 - order) for name in names]
            known[-1] *= order  # not 1 - (1 - order), which loses the digits of a low one
        self.known = known
        """1/Gamma(n - alpha) for n = 1 to 4, and the moments P, Q, D, E over K (tau/c)^alpha."""

    def over(self, V: Array) -> "Fractional":
        """Return the law in the distance travelled at a velocity V >= 0."""
        return Fractional(self.K, self.time * V, self.alpha, self.known)

    def at(self, *index: Any) -> "Fractional":
        """Return the laws of some scenes, by an index of their last axis."""
        own = (self.K, self.time, self.alpha, *self.known)
        K, time, order, *known = (each[(..., *index)] if np.ndim(each) else each for each in own)
        return Fractional(K, time, order, known)

    def moments(self, c: Array) -> Moments:
        """Return the moments over a contact of length c."""
        K, part = self.K, self._part(c)
        P, Q, D, E = (part * share for share in self.known[4:])
        end = part * self.known[0]
        return Moments(0.5 * K + P, 0.5 * K + Q, K / 12.0 + D, E, K + end, -self.alpha * end)

    def dissipated(self, M: Moments, c: Array, work: Array) -> tuple[Array, Array]:
        """Return the share of the work lost in the contact, and its error: it cancels towards order 0."""
        eta, rest, two = M.eta, 1.0 - self.alpha, 2.0**-self.alpha
        third, fourth = self.known[2:4]
        none = 2.0 * np.expm1(rest * math.log(2.0)) * third  # (w + w')^-alpha over both w
        once = rest * (4.0 * two - 1.0) * fourth  # and times w
        both = 2.0 * (1.0 - 2.0 * two * self.alpha) * third / (4.0 - self.alpha)  # and times w w'
        shift = eta - 0.5
        stored = both + shift * (2.0 * once + shift * none)
        size = 2.0 * third + np.abs(shift) * (2.0 * once + np.abs(shift) * none)
        spring, part = 0.5 * self.K * eta * eta, 0.5 * self._part(c)
        lost = 1.0 - (spring + part * stored) / work
        least = np.maximum(lost, np.finfo(float).eps)
        return lost, RELATIVE_ERROR * (1.0 + (spring + part * size) / (work * least))

    def modulus(self, X: Array) -> tuple[Array, Array, Array]:
        """Return G, X dG/dX and the mean of G up to X > 0."""
        part, mean = self._part(X), self.known[1]
        end = part * self.known[0]
        return self.K + end, -self.alpha * part * self.known[0], self.K + part * mean

    def least_peak(self, a: Array) -> Array:
        """Return a distance at which the pressure still rises, or at which it is its limit at X = 0."""
        return np.maximum((1.0 - self.alpha), np.finfo(float).eps) * 0.25 * a

    def _part(self, X: Array) -> Array:
        part: Array = self.K * power(self.time / X, self.alpha)
        return part


Law = Prony | Fractional


def phi(m: Complex) -> list[Complex]:
    """Return phi_1 to phi_4 at -m."""
    near = np.abs(m) < NEAR
    far = np.where(near, NEAR, m)
    found: list[Complex] = [np.asarray((1.0 - np.exp(-far)) / far, complex)]
    for n in range(1, 4):
        found.append((INVERSE_FACTORIALS[n] - found[-1]) / far)
    if near.any():
        for each, value in zip(found, power_series(-m[near]), strict=True):
            each[near] = value
    return found


def power_series(x: Any) -> list[Any]:
    """Return phi_1 to phi_4 at x by Horner's scheme."""
    value = np.full_like(x, INVERSE_FACTORIALS[-1])
    for coefficient in INVERSE_FACTORIALS[-2:3:-1]:
        value *= x
        value += coefficient
    found = [value]
    for coefficient in INVERSE_FACTORIALS[3:0:-1]:
        found.append(found[-1] * x + coefficient)
    return found[::-1]


def divided_differences(x: Any, y: Any) -> list[Any]:
    """Return those of phi_1 to phi_4 between x and y, by Horner's scheme, too."""
    value, divided, found = 0.0, 0.0, []
    for coefficient in INVERSE_FACTORIALS[:0:-1]:
        divided = divided * y + value
        value = value * x + coefficient
        found.append(divided)
    return found[:-5:-1]


def differences(z: Array, sigma: Complex, first: Complex) -> tuple[Complex, ...]:
    """Return phi_n(-z) - phi_n(-z - sigma) for n = 2, 3, 4, relative to their own size.

    `first` is phi_1(-sigma) where |sigma| < 1.
    """
    z = np.broadcast_to(z, sigma.shape)
    m = z + sigma
    fast = z >= np.abs(m)
    pivot = np.where(fast, z, m)
    near = np.abs(pivot) < NEAR
    pivot = np.where(near, NEAR, pivot)
    others = phi(np.where(fast, m, z).astype(complex))
    small, fall = np.abs(sigma) < 1.0, np.exp(-z)
    found = [np.where(small, fall * first, (fall - np.exp(-m)) / np.where(small, 1.0, sigma))]
    for n in range(4):
        found.append((others[n] - found[-1]) / pivot)
    if near.any():
        between = divided_differences(-z[near], -m[near])
        for each, divided in zip(found[1:], between, strict=True):
            each[near] = divided
    return tuple(sigma * each for each in found[2:])


class ElementStep(NamedTuple):
    """The response of an element over a time step h, or over several along the first axis."""

    h: Any
    fall: Array  # decay factors of the modes of a free element
    held: Array  # those of the arms at constant compression
    weights: Array  # ratios of their mean to their initial force then
    ramp: Array  # what a unit ramp adds to the arms
    stiffness: Any  # and to the mean pressure
    damping: Any  # of the damper which, beside a spring, responds to a ramp in the same way


class Element(NamedTuple):
    """One element of the foundation: a spring K (N/m^3), a damper C (N s/m^3), and arms K_i, tau_i (s).

    At a compression u its pressure is p = K u + C u' + sum s_i, s_i' = K_i u' - s_i/tau_i. Detached, p
    vanishes and u is a sum of modes that decay at the `rates` with the `shares`; `to_modes` and `from_modes`
    convert between them and the compressions of all dampers: of those of the arms, y_i = u - s_i/K_i, and,
    last, u of the damper C, if there is one. Without arms, u itself is the one mode.

    >>> element = Element.of(2.0, 0.2)
    >>> element.retardation_time, element.longest_time, element.pressure(1.0, 5.0)
    (0.1, 0.1, 3.0)
    """

    stiffness: float
    damping: float
    arm_stiffness: Array
    arm_time: Array
    rates: Array
    shares: Array
    to_modes: Array
    from_modes: Array

    @classmethod
    def of(cls, stiffness: float, damping: float, arms: Any = ()) -> "Element":
        """Return an element with a damper, with arms (K_i, tau_i), or with both.

        y_i' = (u - y_i)/tau_i is symmetric with the weights sqrt(K_i tau_i); its inverse has the
        retardation times for eigenvalues, each longer than that of an arm. The damper is an arm of no
        relaxation time with the weight sqrt(C), and the sum of all rates is (K + sum K_i)/C + sum 1/tau_i.
        """
        K, C, one = float(stiffness), float(damping), np.ones(1)
        K_i, tau_i = np.array(arms, dtype=float).reshape(-1, 2).T.copy()
        if not K_i.size:
            return cls(K, C, K_i, tau_i, one * (K / C), one, np.eye(1), np.eye(1))
        glassy, damped = K + K_i.sum(), [C] if C else []
        weight = np.sqrt([*(K_i * tau_i), *damped])
        each = np.append(tau_i, np.zeros(len(damped)))
        times, vectors = np.linalg.eigh(np.diag(each) + np.outer(weight, weight) / K)
        back, to_modes = (
            np.ascontiguousarray(m) for m in (vectors / weight[:, None], vectors.T * weight)
        )
        least = 1.0 / (glassy / C + (1.0 / tau_i).sum()) if C else tau_i.min()
        shares = back[-1].copy() if C else K_i / glassy @ back
        return cls(K, C, K_i, tau_i, 1.0 / np.maximum(times, least), shares, to_modes, back)

    @property
    def retardation_time(self) -> float:
        """(C + sum K_i tau_i)/K, in s."""
        return (self.damping + float(self.arm_stiffness @ self.arm_time)) / self.stiffness

    @property
    def longest_time(self) -> float:
        """The longest retardation time, in s."""
        return 1.0 / float(self.rates.min())

    def stiffness_within(self, time: float) -> float:
        """Return the effective stiffness for loading over this time; faster arms act as dampers."""
        return self.stiffness + float(self.arm_stiffness @ (self.arm_time / (self.arm_time + time)))

    def pressure(self, g: Any, g_rate: Any) -> Any:
        """Return p of elements on the indenter whose arms are relaxed (Eqs. 6, 7, 12)."""
        return self.stiffness * g + self.damping * g_rate

    def step(self, h: Any) -> ElementStep:
        """Return the law over steps of the lengths h, exact for a compression that is linear in time.

        The mean pressure of a damper is that with the weight e^(t/tau): k (g - u e^(-h/tau)), k =
        K/(1 - e^(-h/tau)), whatever the history of u between. That of arms is the plain mean: with
        z_i = h/tau_i, phi_1 = (1 - e^(-z))/z and phi_2 = (1 - phi_1)/z, an arm has over a ramp the mean
        phi_1 s_i + phi_2 K_i (u_1 - u_0) and ends at e^(-z) s_i + phi_1 K_i (u_1 - u_0); a damper beside
        arms has the mean C (u_1 - u_0)/h.
        """
        h = np.asarray(h, dtype=float)
        z, K_i = h[..., None] / self.arm_time, self.arm_stiffness
        phi_1, phi_2 = (each.real.copy() for each in phi(z.astype(complex))[:2])
        ramp, stiffness = phi_1 * K_i, np.full(h.shape, 0.5 * self.stiffness)
        with np.errstate(divide="ignore"):
            if self.damping and K_i.size:
                stiffness = stiffness + self.damping / h
            elif self.damping:
                stiffness = -self.stiffness / np.expm1(-h * self.stiffness / self.damping)
        return ElementStep(
            h, np.exp(-h[..., None] * self.rates), np.exp(-z), phi_1, ramp,
            stiffness + phi_2 @ K_i, self.damping + h * ((2.0 * phi_2 - phi_1) @ K_i),
        )  # fmt: skip
