// Steady sliding: closed forms and one root, as kvtheory.models.steady has them. SI throughout.
//
// A scene is { indenter, shape: [slope, L, n], stretch, K, tau, arms: [[K_i, tau_i], ...], order, V } with what
// carries the indenter, { depth } or { weight, spring, mass }, and the spring of its drive, if it has one:
// { drive: { stiffness, damping, mass } }. The shape is h = slope |x|^n/(n L^(n-1)), of a ball and of a circle
// the parabola at its lowest point; a ball is sqrt(R'/R) = stretch times wider than long.

const EPS = 2 ** -52, TINY = 2 ** -1022;

/** base^(1/degree), with a Newton step against the rounding of 1/degree. */
function root_of(base, degree) {
  const found = base ** (1 / degree);
  return found * (1 - (found ** degree / base - 1) / degree);
}

/** q = x_TE/a and Q = q^(n-1), from q^n + n l q^(n-1) = 1; of a wedge, n = 1, their limits. */
function trailing_edge(n, l) {
  const c = n * l, m = n - 1;
  if (m === 0) return [Math.max(0, 1 - l), 1 / (Math.max(0, 1 - l) + c)];
  let q = c > 1 ? c ** (-1 / m) : 1;
  if (q < TINY) return [0, 1 / c];
  for (let k = 0; k < 80; k++) {
    const residual = Math.log(q ** m * (q + c)), step = residual / (m + q / (q + c));
    q *= Math.exp(-step);
    if (Math.abs(step) < 1e-8 || Math.abs(residual) < 8 * EPS) break;
  }
  return [q, 1 / (q + c)];
}

/** The root s = a/a_0 of f(s) + kappa (s^n - 1) = 1, and the depth s^n. */
function scaled_root(n, lam, kappa) {
  const whole = 1 + kappa;
  if (n === 1) {
    const peeling = lam * (1.5 * lam + kappa) < whole;
    const s = peeling ? wedge_scaled_depth_peeling(kappa, lam) : wedge_scaled_depth_peeled(kappa, lam);
    return [s, s];
  }
  let s = (whole / (kappa + Math.hypot(1, lam / power_law_static_load(n)))) ** (1 / n), depth = s;
  for (let k = 0; k < 40; k++) {
    const [q] = trailing_edge(n, lam / s), power = s ** n;
    const total = power_law_scaled_load(n, s, s * q, lam) + kappa * power;
    const slope = s * power_law_scaled_load_slope(n, s, s * q, lam) + n * kappa * power;
    const step = Math.log(total / whole) * (total / slope);
    depth = power * (whole / total) * Math.exp((slope / total - n) * step);
    s *= Math.exp(-step);
    if (Math.abs(step) <= 1e-8) break;
  }
  return [s, depth];
}

/** Depth, half length and load at rest. */
const at_rest = (scene) => (OWN[scene.indenter]?.at_rest || line_at_rest)(scene);

function line_at_rest(scene) {
  const [slope, L, n] = scene.shape, K = scene.K;
  if (scene.depth !== undefined) {
    const a = L * root_of(n * scene.depth / (slope * L), n);
    return { depth: scene.depth, half_length: a, load: K * scene.depth * a * power_law_static_load(n) };
  }
  const a = L * root_of((n + 1) * (scene.weight / K) / (2 * slope * L * L), n + 1);
  return { depth: scene.weight / (K * a * power_law_static_load(n)), half_length: a, load: scene.weight };
}

function slide_line(scene, rest) {
  const [, , n] = scene.shape, K = scene.K, l_r = Math.abs(scene.V) * scene.tau;
  let a = rest.half_length, delta = rest.depth;
  if (scene.depth === undefined) {
    const [s, depth] = scaled_root(n, l_r / a, scene.spring * (delta / rest.load));
    a *= s;
    delta *= depth;
  }
  const l = l_r / a, [q, Q] = trailing_edge(n, l), pressure = K * delta;
  return {
    depth: delta, half_length: a, retardation_length: l_r, leading_edge: -a, trailing_edge: a * q,
    load: pressure * a * power_law_load(n, l, q, Q),
    friction_force: pressure * delta * power_law_friction_force(n, l, q, Q),
    friction_coefficient: (delta / a) * power_law_friction_coefficient(n, l, q, Q),
    peak_pressure: pressure * power_law_peak_pressure(n, l),
    dissipated_in_contact: power_law_dissipated_in_contact(n, l, q, Q),
    l, q, Q,
  };
}

// Any linear viscoelastic foundation under a parabola: moments of the relaxation function (F17).

/** P, Q, D, E, the end value and the mean of e^(-z w). */
function arm_moments(z) {
  const fall = Math.expm1(-z), x = z / 2, near = x <= 2;
  let t_1 = 1 / 23;
  for (let k = 9; k > 0; k--) t_1 = 1 / (2 * k + 3 + x * x * t_1);
  const t_0 = near ? 1 / (3 + x * x * t_1) : arm_ratio(z);
  if (!near) t_1 = arm_next_ratio(t_0, z);
  const A = z > 0 ? -fall / z : 1;
  return {
    P: arm_ahead(A, t_0, x), Q: near ? arm_behind(A, t_0, x) : 0.5 * A * arm_rest(z),
    D: arm_bulge(A, t_0), E: arm_twist(A, t_0, t_1, x), end: 1 + fall, A,
  };
}

/** 1/Gamma(1 + x) for x >= 0, by Stirling's series beyond 12. */
function rgamma1(x) {
  let y = x + 1, product = 1;
  for (; y < 12; y++) product *= y;
  const i = 1 / (y * y);
  const tail = (1 / 12 - i * (1 / 360 - i * (1 / 1260 - i * (1 / 1680 - i * (1 / 1188 - i * 691 / 360360))))) / y;
  return product / (Math.sqrt(2 * Math.PI / y) * Math.exp(y * (Math.log(y) - 1) + tail));
}

/** A Prony series: spring, damper and arms, of which those relax at once that the contact is far longer than. */
function prony(scene) {
  const speed = Math.abs(scene.V), K = scene.K, damper = speed * scene.damping;
  const arms = speed > 0 ? scene.arms.map(([stiffness, time]) => [stiffness, speed * time]) : [];
  const number = (c, length) => Math.min(c / length, 1e150);
  return {
    moments(c) {
      const M = { P: 0.5 * K + damper / c, Q: 0.5 * K, D: K / 12, E: damper / (12 * c), end: K, end_slope: 0 };
      for (const [stiffness, length] of arms) {
        const z = number(c, length), own = arm_moments(z);
        M.P += stiffness * own.P;
        M.Q += stiffness * own.Q;
        M.D += stiffness * own.D;
        M.E += stiffness * own.E;
        M.end += stiffness * own.end;
        M.end_slope -= stiffness * z * own.end;
      }
      return M;
    },
    dissipated(c, eta, work) {
      let lost = damper / c * (1 / 12 + eta * eta);
      for (const [stiffness, length] of arms) {
        const z = number(c, length), m = arm_moments(z);
        lost += stiffness * arm_lost(m.A, 0.5 * (m.P - m.Q), m.E, m.P, eta, z);
      }
      return lost / work;
    },
    /** What each arm still bears at the trailing edge, per unit area. */
    borne(R, c, half_share) {
      return arms.map(([stiffness, length]) => {
        const m = arm_moments(number(c, length));
        return [stiffness, length, stiffness * (c * c / R) * (half_share * m.A - m.P)];
      });
    },
  };
}

/** A spring beside a springpot. */
function springpot(scene) {
  const length = Math.abs(scene.V) * scene.tau, alpha = scene.order, K = scene.K, nu = 1 - alpha;
  const part = (X) => (length > 0 ? K * (length / X) ** alpha * rgamma1(nu) : 0);
  return {
    moments(c) {
      const p = part(c);
      return {
        P: 0.5 * K + p * springpot_ahead(nu), Q: 0.5 * K + p * springpot_behind(nu),
        D: K / 12 + p * springpot_bulge(nu), E: alpha * p * springpot_twist(nu),
        end: K + p * nu, end_slope: -alpha * p * nu,
      };
    },
    /** What is lost in the contact: what is not left at its edge. */
    dissipated(c, eta, work) {
      const two = 2 ** -alpha, third = rgamma1(1 + nu), fourth = rgamma1(2 + nu), shift = eta - 0.5;
      const none = 2 * Math.expm1(nu * Math.LN2) * third;
      const once = nu * (4 * two - 1) * fourth;
      const both = 2 * (1 - 2 * two * alpha) * third / (4 - alpha);
      const stored = both + shift * (2 * once + shift * none);
      const own = 0.5 * K * (length / c) ** alpha;
      return 1 - (0.5 * K * eta * eta + own * stored) / work;
    },
    borne: () => null,
  };
}

function growth(M) {
  const A = M.P + M.Q, share = M.P / A, end = M.end / A;
  return [share, 1 - share * end, 2 * share * end * end - end - share * (M.end_slope / A)];
}

/** Length of the contact whose half length at rest is a. */
function length_at_half(law, a) {
  let c = 1.5 * a;
  for (let k = 0; k < 12; k++) {
    const [share, slope, bend] = growth(law.moments(c)), off = share - a / c;
    const step = off / (slope - 0.5 * off * (bend / slope));
    c = Math.min(Math.max(c * (1 - step), a), 2 * a);
    if (Math.abs(step) < 1e-6) break;
  }
  return c;
}

/** Length of the contact under a load, on a spring that is relaxed at the static depth. */
function length_at_load(law, R, rest, spring) {
  const load = rest.load, wanted = 1 + spring * rest.depth / load;
  let c = 2 * rest.half_length;
  for (let k = 0; k < 12; k++) {
    const M = law.moments(c), [share, slope, bend] = growth(M);
    const size = c * c * (c / (R * load)), own = spring * (c / (R * load)) * c;
    const total = size * (M.D + (share - 0.5) * M.P) + 0.5 * own * share * share;
    const rise = slope * (size * M.P + own * share) / total;
    const curve = size * (bend * M.P + slope * (M.P + M.Q)) + own * (slope * slope + share * bend);
    const off = Math.log(total / wanted);
    const step = off / (rise - 0.5 * off * ((curve / total + rise) / rise - rise));
    c *= Math.exp(-step);
    if (Math.abs(step) < 1e-6) break;
  }
  return c;
}

const law_of = (scene) => (scene.arms ? prony(scene) : springpot(scene));

function slide_viscoelastic(scene, rest) {
  const law = law_of(scene), R = scene.shape[1];
  const c = scene.depth === undefined ? length_at_load(law, R, rest, scene.spring) : length_at_half(law, rest.half_length);
  return plane_state(scene, rest, law, c);
}

/** The state of a parabola, or of the middle plane of a ball, whose contact is c long. */
function plane_state(scene, rest, law, c) {
  const R = scene.shape[1], fixed = scene.depth !== undefined;
  const M = law.moments(c), A = M.P + M.Q, share = M.P / A, eta = 0.5 * (M.P - M.Q) / A;
  const a = fixed ? rest.half_length : c * share;
  const load = moments_load(M.D, M.P, eta), work = moments_work(M.E, M.P, eta);
  const l_r = Math.abs(scene.V) * mean_time(scene);
  const pressure = (X) => {
    const m = law.moments(X);
    return X > 0 ? (a * (m.P + m.Q) - X * m.P) * (X / R) : 0;
  };
  return {
    depth: fixed ? scene.depth : a * (a / (2 * R)), half_length: a, retardation_length: l_r,
    leading_edge: -a, trailing_edge: c * (M.Q / A), load: c * c * (c / R) * load,
    friction_force: (c * (c / R)) ** 2 * work, friction_coefficient: (c / R) * (work / load),
    peak_pressure: scene.rough ? NaN : greatest(pressure, a),
    dissipated_in_contact: work > 0 ? law.dissipated(c, eta, work) : 1,
    pressure, borne: law.borne(R, c, share), length: c,
  };
}

/** Greatest value of a concave function on (0, end], by golden section in the logarithm of its place. */
function greatest(f, end) {
  const golden = (Math.sqrt(5) - 1) / 2, at = (y) => f(Math.exp(y));
  let low = Math.log(end) - 40, high = Math.log(end);
  let one = high - golden * (high - low), two = low + golden * (high - low), f1 = at(one), f2 = at(two);
  for (let k = 0; k < 52; k++) {
    if (f1 > f2) [high, two, f2] = [two, one, f1], one = high - golden * (high - low), f1 = at(one);
    else [low, one, f1] = [one, two, f2], two = low + golden * (high - low), f2 = at(two);
  }
  return Math.max(f1, f2, f(end));
}

/** C = int (G - K) dt of a Prony series. */
function damping(scene) {
  return scene.arms.reduce((sum, [stiffness, time]) => sum + stiffness * time, scene.damping);
}

/** C/K: the retardation time, or what takes its place. */
const mean_time = (scene) => (scene.arms ? damping(scene) / scene.K : scene.tau);

const MIRRORED = ["leading_edge", "trailing_edge", "friction_force", "friction_coefficient"];

/** Shapes with rules of their own; the others are power laws, or a parabola on what is not Kelvin-Voigt. */
const OWN = {
  sphere: { at_rest: ball_at_rest, slide: slide_ball, limits: ball_limits },
  circle: { at_rest: circle_at_rest, slide: slide_circle, limits: () => ({}) },
};

/** The steady state; a reversed drive is the mirror image. */
function slide(scene) {
  const rest = at_rest(scene), line = scene.kelvin_voigt ? slide_line : slide_viscoelastic;
  const state = (OWN[scene.indenter]?.slide || line)(scene, rest);
  if (scene.V < 0) for (const name of MIRRORED) state[name] = -state[name];
  return { ...state, rest };
}

/** Asymptotes of the friction coefficient over |V|, and where they meet, as far as they are known. */
const limits = (scene) => (OWN[scene.indenter]?.limits || line_limits)(scene);

function line_limits(scene) {
  const [slope, L, n] = scene.shape, rest = at_rest(scene), K = scene.K, fixed = scene.depth !== undefined;
  if (scene.kelvin_voigt) {
    const kappa = fixed ? Infinity : scene.spring * (rest.depth / rest.load), a_0 = rest.half_length;
    const lift = fixed ? 0 : rest.load * (1 + kappa), tilt = (depth) => depth / (L * root_of(n * depth / (slope * L), n));
    const crossing = fixed ? power_law_crossing(n) : power_law_crossing_at_load(n, kappa);
    return {
      low: (V) => (rest.depth / a_0) * (V * scene.tau / a_0) * power_law_low(n),
      high: (V) => power_law_high(n) * tilt(fixed ? rest.depth : lift / (K * V * scene.tau)),
      critical: a_0 * crossing / scene.tau,
    };
  }
  if (!scene.arms) return {};
  if (scene.damping > 0) {  // it is all that resists at high velocity
    const lift = fixed ? 0 : rest.load + scene.spring * rest.depth, low = damping(scene) / (L * K);
    const high = (V) => Math.sqrt((8 / 9) * (fixed ? rest.depth : lift / (scene.damping * V)) / L);
    return { low: (V) => low * V, high, critical: (high(1) / low) ** (fixed ? 1 : 2 / 3), damper: true };
  }
  const C = damping(scene), glassy = scene.arms.reduce((sum, [stiffness]) => sum + stiffness, K);
  const slope_0 = scene.arms.reduce((sum, [stiffness, time]) => sum + stiffness / time, 0);
  let s = 1;
  if (!fixed) {
    const kappa = scene.spring * (rest.depth / rest.load), g = glassy / K;
    for (let k = 0; k < 60; k++) s -= (g * s * s * s + kappa * (s * s - 1) - 1) / (3 * g * s * s + 2 * kappa * s);
  }
  const a = s * rest.half_length, high = 0.4 * a * a / L * (slope_0 / glassy), low = C / (L * K);
  return { low: (V) => low * V, high: (V) => high / V, critical: Math.sqrt(high / low), glassy: [a, slope_0 / glassy] };
}

/** Speed and friction at each maximum, the highest first: parabolas over ever closer speeds from points of the curve. */
function maxima(scene, points) {
  const friction = (V) => slide({ ...scene, V }).friction_coefficient;
  const found = [];
  for (let best = 1; best < points.length - 1; best++) {
    if (!(points[best][1] > points[best - 1][1] && points[best][1] >= points[best + 1][1])) continue;
    let place = Math.log(points[best][0]);
    for (let h = Math.log(points[best + 1][0]) - place, k = 0; k < 4; k++, h /= 8) {
      const [low, top, high] = [-h, 0, h].map((step) => friction(Math.exp(place + step)));
      const off = 0.5 * h * (high - low) / (2 * top - low - high);
      place += Math.min(h, Math.max(-h, off)) || 0;
    }
    const V = Math.exp(place);
    found.push({ V, friction: friction(V) });
  }
  return found.sort((a, b) => b.friction - a.friction);
}
