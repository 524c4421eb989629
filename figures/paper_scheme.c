/* The paper's scheme in plain C, to measure the simulator against: a parabola under a dead weight on
   Kelvin-Voigt elements, Runge-Kutta of order 4 with dt = 2 dx/V, contact by Eqs. 20-25. */
#include <math.h>
#include <stdlib.h>

static double force(int n, double first, double dx, const double *u, const char *touched, double decay,
                    double R, double K, double C, double V, double depth, double rate, double *friction)
{
    double sum = 0.0, along = 0.0;
    for (int i = 0; i < n; i++) {
        double x = first + i * dx, g = depth - x * x / (2.0 * R);
        if (touched[i] || g > u[i] * decay) {
            double p = K * g + C * (rate - V * x / R);
            if (p >= 0.0) {
                sum += p;
                along += p * x;
            }
        }
    }
    *friction = -dx * along / R;
    return dx * sum;
}

/* Write depth and friction force before each of so many steps and after the last; return the element updates.
   The base moves on by two elements in a step. */
long run(double R, double K, double tau, double M, double W, double V, double dx, double depth, long steps,
         double *depths, double *frictions)
{
    double h = 2.0 * dx / V, C = K * tau, rate = 0.0, half = exp(-0.5 * h / tau), whole = exp(-h / tau);
    int m = (int)ceil(sqrt(2.0 * R * depth) / dx) + 4, n = 2 * m + 1;
    double *u = calloc(n, sizeof *u), first = -m * dx;
    char *touched = calloc(n, 1);
    for (int i = 0; i < n; i++) {
        double x = first + i * dx, g = depth - x * x / (2.0 * R);
        touched[i] = g > 0.0;
        u[i] = g > 0.0 ? g : 0.0;
    }
    double last;
    for (long k = 0; k < steps; k++) {
        depths[k] = depth;
        double a[4], v[4], d = depth, w = rate, share[4] = {0.0, 0.5, 0.5, 1.0};
        for (int s = 0; s < 4; s++) {
            double back = s ? share[s] * h : 0.0;
            d = depth + (s ? back * v[s - 1] : 0.0);
            w = rate + (s ? back * a[s - 1] : 0.0);
            v[s] = w;
            a[s] = (W - force(n, first + V * back, dx, u, touched, s == 0 ? 1.0 : s == 3 ? whole : half,
                              R, K, C, V, d, w, s ? &last : &frictions[k])) / M;
        }
        depth += h * (v[0] + 2.0 * v[1] + 2.0 * v[2] + v[3]) / 6.0;
        rate += h * (a[0] + 2.0 * a[1] + 2.0 * a[2] + a[3]) / 6.0;
        for (int i = n - 1; i >= 0; i--) { /* two new elements come in, two old ones leave */
            int from = i - 2;
            double x = first + i * dx, g = depth - x * x / (2.0 * R);
            double free_u = from >= 0 ? u[from] * whole : 0.0, p = K * g + C * (rate - V * x / R);
            int meets = from >= 0 && touched[from] ? 1 : g > free_u;
            touched[i] = meets && p >= 0.0;
            u[i] = touched[i] ? g : free_u;
        }
    }
    depths[steps] = depth;
    force(n, first, dx, u, touched, 1.0, R, K, C, V, depth, rate, &frictions[steps]);
    free(u);
    free(touched);
    return 4 * steps * n;
}
