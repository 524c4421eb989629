// Steady sliding of a ball: its strips along x are parabolas (F20, F17), as kvtheory.models.steady has them.

/** Nodes from -1 to 1 and weights of Gauss's rule, by Newton's method on Legendre's polynomial. */
function gauss(count) {
  return Array.from({ length: count }, (_, k) => {
    let x = Math.cos(Math.PI * (k + 0.75) / (count + 0.5)), slope = 1;
    for (let step = 0; step < 8; step++) {
      let before = 1, here = x;
      for (let n = 2; n <= count; n++) [before, here] = [here, ((2 * n - 1) * x * here - (n - 1) * before) / n];
      slope = count * (before - x * here) / ((1 - x) * (1 + x));
      x -= here / slope;
    }
    return [x, 2 / ((1 - x) * (1 + x) * slope * slope)];
  });
}

const GAUSS = gauss(24);

/** The integral of a smooth function. */
function integral(f, from, to) {
  const half = (to - from) / 2, middle = (to + from) / 2;
  return half * GAUSS.reduce((sum, [x, w]) => sum + w * f(middle + half * x), 0);
}

/** theta = arctan(1/l) and the tail T, whose closed form cancels for a large l (F20-tail). */
function angle_and_tail(l) {
  const theta = Math.atan2(1, l);
  if (l <= 1) return [theta, ball_tail(l, theta)];
  return [theta, integral((v) => (1 - v * v) ** 2 / (1 + (v / l) ** 2), -1, 1) / l];
}

function ball_at_rest(scene) {
  const R = scene.shape[1], spring = Math.PI * scene.K * R * scene.stretch;  // W = spring delta^2
  const depth = scene.depth ?? Math.sqrt(scene.weight / spring);
  return { depth, half_length: Math.sqrt(2 * R * depth), load: scene.weight ?? spring * depth * depth };
}

/** The root s = a/a_0 of f(s) + kappa (s^2 - 1) = 1, by Halley's method in logarithms. */
function ball_scaled_root(lam, kappa) {
  let s = Math.cbrt((1 + kappa) / (1 + kappa + lam * (8 / (3 * Math.PI))));
  for (let k = 0; k < 12; k++) {
    const [theta, tail] = angle_and_tail(lam / s), held = kappa * s * s, total = ball_scaled_load(s, lam, tail) + held;
    const rise = (ball_scaled_load_slope(s, lam, theta) + 2 * held) / total;
    const curve = (ball_scaled_load_curvature(s, lam, theta) + 4 * held) / total - rise * rise;
    const off = Math.log(total / (1 + kappa)), step = off / (rise - 0.5 * off * (curve / rise));
    s *= Math.exp(-step);
    if (Math.abs(step) < 1e-5) break;
  }
  return s;
}

function slide_ball(scene, rest) {
  if (!scene.kelvin_voigt) return slide_viscoelastic_ball(scene, rest);
  const R = scene.shape[1], l_r = Math.abs(scene.V) * scene.tau, kappa = scene.spring * (rest.depth / rest.load);
  const s = scene.depth === undefined ? ball_scaled_root(l_r / rest.half_length, kappa) : 1;
  const delta = s * s * rest.depth, a = Math.sqrt(2 * R * delta), l = l_r / a, q = trailing_edge_ratio(l);
  const [, tail] = angle_and_tail(l), pressure = scene.K * delta, force = pressure * a * (a * scene.stretch);
  return {
    depth: delta, half_length: a, retardation_length: l_r, leading_edge: -a, trailing_edge: a * q,
    load: force * ball_load_factor(l, tail),
    friction_force: force * ((a / R) * ball_friction_force_factor(l, tail)),
    friction_coefficient: (a / R) * ball_friction_coefficient_factor(l, tail),
    peak_pressure: pressure * peak_pressure_factor(l),
    dissipated_in_contact: ball_dissipated_in_contact(l, tail), l, q, tail,
  };
}

// On any other foundation: one double-exponential quadrature over strips, with the length of their contact
// as the variable.

/** Nodes from 0 to 1, their distances from 1, and weights; the sums grow with more than the fourth power of a node. */
function strips_of(per_unit) {
  const count = Math.ceil(6 * per_unit);
  return Array.from({ length: count }, (_, k) => {
    const t = k / per_unit - 2.1, fall = Math.exp(-Math.PI * Math.sinh(t)), node = 1 / (1 + fall);
    return [node, fall * node, Math.PI / per_unit * Math.cosh(t) * node * fall * node];
  });
}

const STRIPS = { exact: strips_of(16), rough: strips_of(4) };

/** Where a strip whose contact is c long begins and ends, by its half length at rest, and what it is made of. */
function strip(law, c) {
  const M = law.moments(c), [share, rise] = growth(M);
  return { M, a: c * share, share, rise, eta: 0.5 * (M.P - M.Q) / (M.P + M.Q) };
}

/** Sums over the strips of a ball whose middle plane has a contact of length c. */
function strip_sums(law, scene, length, lost = false) {
  const R = scene.shape[1], { stretch } = scene;
  const first = law.moments(length), [share, slope, bend] = growth(first), a_0 = length * share;
  const sums = { a: a_0, load: 0, friction: 0, lost: 0, growth: 0, middle: [share, slope] };
  for (const [node, gap, weight] of scene.rough ? STRIPS.rough : STRIPS.exact) {
    const c = length * node, { M, a, rise, eta } = strip(law, c);
    const behind = gap < 5e-6 ? length * gap * (slope - 0.5 * bend * gap) : a_0 - a;
    const dy = 2 * stretch * a * rise * (length * weight) / Math.sqrt(behind * (a_0 + a)), size = c * (c / R);
    const work = moments_work(M.E, M.P, eta), rubbed = dy * size * size * work;
    sums.load += dy * size * c * moments_load(M.D, M.P, eta);
    sums.friction += rubbed;
    if (lost && work > 0) sums.lost += rubbed * law.dissipated(c, eta, work);
    sums.growth += dy * size * M.P / a;  // of dW/da_0 over a_0
  }
  sums.growth *= a_0 * slope * length / sums.load;
  return sums;
}

/** Length of the contact in the middle plane under a load: Newton's method in logarithms, from rest. */
function ball_length_at_load(law, scene, rest) {
  const R = scene.shape[1], wanted = rest.load + scene.spring * rest.depth;
  let c = 2 * rest.half_length;
  for (let k = 0; k < 60; k++) {
    const found = strip_sums(law, scene, c), held = scene.spring * found.a * (found.a / (2 * R));
    const [share, slope] = found.middle, total = found.load + held;
    const step = Math.log(total / wanted) / ((found.growth * found.load + 2 * (slope / share) * held) / total);
    c *= Math.exp(-step);
    if (Math.abs(step) < (scene.rough ? 1e-4 : 1e-8)) break;
  }
  return c;
}

function slide_viscoelastic_ball(scene, rest) {
  const law = law_of(scene);
  const c = scene.depth === undefined ? ball_length_at_load(law, scene, rest) : length_at_half(law, rest.half_length);
  const found = strip_sums(law, scene, c, !scene.rough);
  return {
    ...plane_state(scene, rest, law, c), load: found.load, friction_force: found.friction,
    friction_coefficient: found.friction / found.load,
    dissipated_in_contact: found.friction > 0 ? found.lost / found.friction : 1,
  };
}

function ball_limits(scene) {
  if (!scene.kelvin_voigt) return {};
  const R = scene.shape[1], rest = at_rest(scene), a_0 = rest.half_length, fixed = scene.depth !== undefined;
  const kappa = fixed ? 0 : scene.spring * (rest.depth / rest.load), lift = rest.load * (1 + kappa);
  const half_length = (V) => (fixed ? a_0 : Math.cbrt(1.5 * R * lift / (scene.K * V * scene.tau * scene.stretch)));
  return {
    low: (V) => V * scene.tau / R,
    high: (V) => BALL_CROSSING * half_length(V) / R,
    half_length,
    critical: a_0 * (fixed ? BALL_CROSSING : ball_crossing_at_load(kappa)) / scene.tau,
  };
}

/** Outline of the contact seen from above, in m, for V > 0: leading and trailing edge at each y >= 0. */
function footprint(scene, state) {
  const R = scene.shape[1], a = state.half_length;
  if (scene.kelvin_voigt) {
    return Array.from({ length: 61 }, (_, k) => {
      const angle = Math.PI * k / 120, A = a * Math.cos(angle), l_r = state.retardation_length;
      return [a * scene.stretch * Math.sin(angle), -A, A > 0 ? A * (A / (Math.hypot(A, l_r) + l_r)) : 0];
    });
  }
  const law = law_of(scene);
  return Array.from({ length: 61 }, (_, k) => {
    const c = state.length * Math.cos(Math.PI * k / 120), A = k < 60 ? Math.min(a, strip(law, c).a) : 0;
    return [scene.stretch * Math.sqrt((a - A) * (a + A)), -A, Math.max(0, c - A)];
  });
}
