"""Steady sliding of a power law or a wedge in ball arithmetic, h = slope |x|^n/(n L^(n-1)), n >= 1.

From the definitions: h(a) = delta, no pressure delta - h - l_r h' at the trailing edge, W = int p dx by its
antiderivative, and F by the energy balance F = u_TE^2/2 + l_r int h'^2 dx.
"""

from dataclasses import dataclass

from flint import arb

from tests.reference import WIDTH, steady


@dataclass
class PowerLaw:
    slope: arb
    length: arb
    exponent: arb

    def height(self, x):
        return self.rise(x) * x / self.exponent

    def rise(self, x):
        """h' at x >= 0."""
        tip = self.slope if self.exponent == 1 else arb(0)
        return self.slope * (x / self.length) ** (self.exponent - 1) if x != 0 else tip

    def static_depth(self, weight):
        n, L = self.exponent, self.length
        a_0 = ((n + 1) * L ** (n - 1) * weight / (2 * self.slope)) ** (1 / (n + 1))
        return self.height(a_0)

    def edges(self, l_r, depth):
        n, L = self.exponent, self.length
        a = L * (n * depth / (self.slope * L)) ** (1 / n)
        return a, self.trailing_edge(l_r, a)

    def trailing_edge(self, l_r, a):
        """Enclose x_TE > 0 with h + l_r h' = h(a): for a wedge it may be 0, the tip."""
        n, c = self.exponent, self.exponent * l_r / a
        if n == 1:
            return (a - l_r).max(arb(0))
        if l_r == 0:
            return a

        def excess(t):
            return (n - 1) * t + (t.exp() + c).log()

        t = (arb(0) if c < 1 else -c.log() / (n - 1)).mid()
        for _ in range(400):
            share = t.exp() / (t.exp() + c)
            step = (excess(t) / (n - 1 + share)).mid()
            t = (t - step).mid()
            if abs(step) < WIDTH:
                break
        for widening in range(0, 200, 20):  # the ball of c may itself be wider
            width = WIDTH * arb(2) ** widening
            if excess(t - width) < 0 < excess(t + width):
                return a * arb(t, width).exp()
        raise ArithmeticError("the trailing edge was not enclosed")

    def load(self, l_r, depth):
        edges = a, x_te = self.edges(l_r, depth)
        below = sum(self.height(x) * x / (self.exponent + 1) for x in edges)
        u_te = depth - self.height(x_te)
        return depth * (x_te + a) - below + l_r * u_te, x_te + a + l_r

    def contact(self, l_r, depth, load):
        n, (a, x_te) = self.exponent, self.edges(l_r, depth)
        lost = l_r * sum(self.rise(x) ** 2 * x / (2 * n - 1) for x in (x_te, a))
        x_peak = a.min((n - 1) * l_r)
        peak = depth - self.height(x_peak) + l_r * self.rise(x_peak)
        return a, x_te, (depth - self.height(x_te)) ** 2 / 2 + lost, lost, peak


at_depth, at_load = steady(PowerLaw)
