// Steady sliding of a true circle on Kelvin-Voigt elements, as kvtheory.models.steady.quadrature has it:
// W = K (int u dx + l_r u_TE), F = K (u_TE^2/2 + l_r int h'^2 dx). With the angle of the circle as variable
// the first integrand is smooth up to the edge, and the second integral is known.

const circle_height = (R, x) => x * (x / (R + Math.sqrt((R - x) * (R + x))));
const circle_slope = (R, x) => x / Math.sqrt((R - x) * (R + x));

/** int h'^2 dx/R from the lowest point to where the slope is `slope`; where the closed form cancels, the integral. */
const slope_integral = (slope) =>
  (slope > 1 ? circle_steepness(slope) : integral((y) => y * y / (1 + y * y) ** 1.5, 0, slope));

/** The angle at which h + l_r h' = delta behind the lowest point: Newton's method on a convex function, from beyond. */
function trailing_angle(R, delta, l_r, front) {
  let t = Math.min(front, Math.atan2(delta, l_r));
  for (let k = 0; k < 60; k++) {
    const slope = Math.tan(t), off = 2 * R * Math.sin(t / 2) ** 2 + l_r * slope - delta;
    const step = off / (R * Math.sin(t) + l_r * (1 + slope * slope));
    t -= step;
    if (!(Math.abs(step) > 4 * EPS * t)) break;
  }
  return t;
}

/** The contact at a depth, between two angles; forces are over K. */
function circle_contact(R, delta, l_r) {
  const front = 2 * Math.asin(Math.sqrt(delta / (2 * R))), back = l_r > 0 ? trailing_angle(R, delta, l_r, front) : front;
  const a = Math.sqrt(delta * (2 * R - delta)), slope = Math.tan(back), left = l_r * slope;
  const under = (t) => 2 * R * Math.sin((front + t) / 2) * Math.sin((front - t) / 2) * R * Math.cos(t);
  const compressed = integral(under, -front, back), steepness = R * (slope_integral(a / (R - delta)) + slope_integral(slope));
  return {
    delta, a, x: R * Math.sin(back), left, steepness, compressed, load: compressed + l_r * left,
    lost: l_r * steepness, friction: 0.5 * left * left + l_r * steepness,
  };
}

/** The depth at which load + spring depth = wanted, all over K; NaN if the circle goes under before. */
function circle_depth(R, l_r, wanted, spring) {
  const deepest = R * (1 - EPS);
  if (!(circle_contact(R, deepest, l_r).load + spring * R > wanted)) return NaN;
  let delta = Math.min(0.5 * R, Math.cbrt(1.5 * R * wanted) ** 2 / (2 * R));  // of the parabola at rest
  for (let k = 0; k < 60; k++) {
    const found = circle_contact(R, delta, l_r), total = found.load + spring * delta;
    const step = Math.log(total / wanted) * total / (found.x + found.a + l_r + spring) / delta;
    delta = Math.min(delta * Math.exp(-step), deepest);
    if (Math.abs(step) < 1e-9) break;
  }
  return delta;
}

function circle_at_rest(scene) {
  const R = scene.shape[1], delta = scene.depth ?? circle_depth(R, 0, scene.weight / scene.K, 0);
  const { a, load } = circle_contact(R, delta, 0);
  return { depth: delta, half_length: a, load: scene.weight ?? scene.K * load };
}

function slide_circle(scene, rest) {
  const R = scene.shape[1], K = scene.K, l_r = Math.abs(scene.V) * scene.tau, spring = scene.spring / K;
  const wanted = rest.load / K + (spring > 0 ? spring * rest.depth : 0);  // at rest it may go under
  const delta = scene.depth ?? circle_depth(R, l_r, wanted, spring);
  const found = circle_contact(R, delta, l_r), { a, x } = found;
  const turn = circle_peak_place(Math.asin(Math.min(1, 1.5 * Math.sqrt(3) * l_r / R)) / 3);
  const pressure = (y) => delta - circle_height(R, y) + l_r * circle_slope(R, y);
  return {
    depth: delta, half_length: a, retardation_length: l_r, leading_edge: -a, trailing_edge: x,
    load: K * found.load, friction_force: K * found.friction, friction_coefficient: found.friction / found.load,
    peak_pressure: K * Math.max(l_r * (a / (R - delta)), R * turn < a ? pressure(R * turn) : 0),
    dissipated_in_contact: found.friction > 0 ? found.lost / found.friction : 1,
    pressure: (X) => K * Math.max(0, pressure_at_side(R, delta, l_r, X - a)), parts: found,
  };
}

/** Pressure over K at x of the contact, from -a on. */
const pressure_at_side = (R, delta, l_r, x) => delta - circle_height(R, x) - l_r * circle_slope(R, x);
