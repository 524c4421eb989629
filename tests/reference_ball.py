"""Steady sliding of a ball in ball arithmetic: the sums over its strips as books print them, with so many
digits that their cancellation does not matter; `integrals` encloses the double integrals of the pressure.
"""

from dataclasses import dataclass

from flint import acb, arb, ctx

from tests.reference import Parabola, steady


@dataclass
class Ball:
    radius: arb
    across: arb

    def static_depth(self, weight):
        return (weight / (arb.pi() * (self.radius * self.across).sqrt())).sqrt()

    def _theta(self, l_r, a):
        return (a / l_r).atan() if l_r > 0 else arb.pi() / 2

    def load(self, l_r, depth):
        """sqrt(R'/R) [pi a^4 + 2 a^3 l - 2 a l^3 + 2 (a^2 + l^2)^2 arctan(a/l)]/(8 R), and its slope."""
        R, l = self.radius, l_r
        a = (2 * R * depth).sqrt()
        theta, r = self._theta(l, a), a * a + l * l
        scale = (self.across / R).sqrt() / (8 * R)
        load = scale * (arb.pi() * a**4 + 2 * a**3 * l - 2 * a * l**3 + 2 * r * r * theta)
        slope = scale * (4 * arb.pi() * a**3 + 8 * a * a * l + 8 * a * r * theta)
        return load, slope * R / a

    def contact(self, l_r, depth, load):
        R, l, stretch = self.radius, l_r, (self.across / self.radius).sqrt()
        a, x_te, _, _, peak = Parabola(R).contact(l, depth, load)
        friction = l / R * (load - 2 * l * a**3 / (3 * R) * stretch)
        behind = 2 * a**3 / 3 + a * l * l - l * (a * a + l * l) * self._theta(l, a)
        return a, x_te, friction, friction - l * l / R**2 * behind * stretch, peak


at_depth, at_load = steady(Ball)


def integrals(radius, across, stiffness, retardation_time, velocity, depth):
    """Enclose W and F as integrals over the strips, each by its antiderivatives, for V > 0: y = b sin(t)."""
    with ctx.workprec(100):
        R, S, K, tau, V, depth = map(
            arb, (radius, across, stiffness, retardation_time, velocity, depth)
        )
        l_r, b = V * tau, (2 * S * depth).sqrt()

        def strip(t, power):
            d = depth * t.cos() ** 2
            a = (2 * R * depth).sqrt() * t.cos()
            x_te = (2 * R * d + l_r * l_r).sqrt() - l_r
            sums = [x_te**n - (-a) ** n for n in range(5)]
            load = d * sums[1] - sums[3] / (6 * R) - l_r * sums[2] / (2 * R)
            friction = -(d * sums[2] / 2 - sums[4] / (8 * R) - l_r * sums[3] / (3 * R)) / R
            return (friction if power else load) * b * t.cos() * K

        ends = acb(0), acb(arb.pi() / 2)
        return [2 * acb.integral(lambda t, _, n=n: strip(t, n), *ends).real for n in (0, 1)]
