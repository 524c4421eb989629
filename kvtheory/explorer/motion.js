// The start from rest of a parabola on a Kelvin-Voigt foundation: depth and rate, and two edges in closed form
// (F11); with a spring in the drive also how far and how fast it has moved along x (F22). Scaled by the state at
// rest; it holds until an edge would need to know the past.
//
// number: { lam, epsilon, kappa, along }, along: { epsilon, damping, kappa } or nothing under a rigid drive.

/** Steps of the linearly implicit Euler method from which one step is extrapolated. */
const ORDER = 4;

/** d'' and x'' and what the forces are made of, at [d, d', x, x']. */
function start_law([d, v, x, w], number) {
  const lam = number.lam - w, a = Math.sqrt(d), rho = Math.sqrt(d + v + lam ** 2), r = peeling_edge(d, v, lam);
  const f_z = peeling_normal_force(r + a, rho), f_x = peeling_friction_force(r + a, r, rho), { along } = number;
  const rate = number.kappa === Infinity ? 0 : (1 - f_z - number.kappa * (d - 1)) / number.epsilon;
  const rate_along = along ? (f_x - along.damping * w - along.kappa * x) / along.epsilon : 0;
  return { lam, a, r, rho, f_z, f_x, rate, rate_along };
}

/** One step of h with `parts` linearly implicit Euler steps, first along x and then across. */
function euler(y, h, parts, number) {
  const k = h / parts, { along } = number;
  let [d, v, x, w] = y;
  for (let i = 0; i < parts; i++) {
    let now = start_law([d, v, x, w], number);
    if (along) {
      const damped = along.damping + now.r ** 3 + now.a ** 3;  // as at the steady state
      w += (now.rate_along * along.epsilon - k * along.kappa * w) * k / (along.epsilon + k * damped + k * k * along.kappa);
      x += k * w;
      now = start_law([d, v, x, w], number);
    }
    if (number.kappa < Infinity) {
      const by_d = -(force_per_depth(now.a, now.r, now.lam, v) + number.kappa) / number.epsilon;
      const by_v = -force_per_rate(now.a, now.r) / number.epsilon;
      v += (now.rate + k * by_d * v) * k / (1 - k * by_v - k * k * by_d);
      d += k * v;
    }
  }
  return [d, v, x, w];
}

/** One step, extrapolated, and how far the last two extrapolations are apart. */
function extrapolated(y, h, number) {
  const table = [];
  for (let j = 0; j < ORDER; j++) {
    let row = [euler(y, h, j + 1, number)];
    for (let k = 0; k < j; k++) {
      const ratio = (j + 1) / (j - k);
      row.push(row[k].map((x, i) => x + (x - table[j - 1][k][i]) / (ratio - 1)));
    }
    table.push(row);
  }
  const last = table[ORDER - 1], best = last[ORDER - 1], other = last[ORDER - 2];
  const sizes = [1, 1 + Math.abs(y[1]), 1 + Math.abs(y[2]), 1 + number.lam];
  const error = Math.max(...sizes.map((size, i) => Math.abs(best[i] - other[i]) / size));
  return { y: best, error: Number.isFinite(error) ? error : Infinity };
}

/** Why the states are no longer enough, if they are not. */
function remembers(y, number) {
  const [d, v, , w] = y, lam = number.lam - w;
  if (!(d + v + lam ** 2 > 0)) return "the indenter leaves the foundation";
  const now = start_law(y, number);
  if (now.r + now.a <= 0) return "the indenter leaves the foundation";
  const slows = now.rate_along;  // -lambda'
  const peels = (v + now.rate - 2 * lam * slows) / (2 * now.rho) + slows - lam;  // X' of the right edge
  const touches = -v / (2 * now.a) - lam;  // X' of the left edge
  if (peels > 1e-9 && now.r < now.a) return "the trailing edge re-enters surface that it left earlier";
  if (touches > 1e-9) return "the leading edge peels";
  return "";
}

/** Follow the start from rest to the scaled time `end`: rows of s, the states, edges and forces, and why it ended. */
function start_from_rest(number, end, tolerance = 1e-7) {
  const { along } = number, row = (s, y) => {
    const { a, r, f_z, f_x } = start_law(y, number), [d, v, x, w] = y;
    return { s, d, v, x, w, l: -a, r, f_z, f_x, f_s: along ? along.kappa * x + along.damping * w : 0 };
  };
  let s = 0, y = [1, 0, 0, 0], h = Math.min(end, 0.1 * number.epsilon / (1 + number.lam), 0.01);
  if (number.lam === 0 || (number.kappa === Infinity && !along)) return { rows: [row(0, y), row(end, y)], why: "" };
  if (along) h = Math.min(h, 0.1 * along.epsilon / (1 + number.lam));
  const rows = [row(0, y)];
  for (let k = 0; k < 4000 && s < end; k++) {
    h = Math.min(h, end - s, 0.02 * end);
    const step = extrapolated(y, h, number);
    if (step.error <= tolerance) {
      const why = remembers(step.y, number);
      if (why && h > 1e-6 * end) {
        h *= 0.25;
        continue;
      }
      if (why) return { rows, why };
      s += h;
      y = step.y;
      rows.push(row(s, y));
    }
    h *= Math.min(3, Math.max(0.1, 0.9 * (tolerance / Math.max(step.error, 1e-300)) ** (1 / ORDER)));
    if (h < 1e-14 * end) return { rows, why: "the step became too small" };
  }
  return { rows, why: s < end ? "too many steps" : "" };
}

/** The row at scaled time s, between two that were computed: cubic in the depth, linear in the rest. */
function row_at(rows, s) {
  let low = 0, high = rows.length - 1;
  while (high - low > 1) {
    const middle = (low + high) >> 1;
    if (rows[middle].s > s) high = middle; else low = middle;
  }
  const one = rows[low], two = rows[high], h = two.s - one.s, w = h > 0 ? Math.min(1, (s - one.s) / h) : 0;
  const mixed = {};
  for (const name of ["v", "x", "w", "l", "r", "f_z", "f_x", "f_s"]) mixed[name] = one[name] + w * (two[name] - one[name]);
  const cubic = one.d + w * (h * one.v + w * (3 * (two.d - one.d) - h * (2 * one.v + two.v)
    + w * (2 * (one.d - two.d) + h * (one.v + two.v))));
  return { s, d: cubic, ...mixed, l: -Math.sqrt(cubic) };
}

/** The free surface behind the trailing edge at scaled time s: pairs of xi and u, outward. */
function surface_behind(rows, s, lam) {
  const points = [], now = row_at(rows, s), carried = (row) => lam * (s - row.s) - (now.x - row.x);
  for (const row of rows) {
    if (row.s > s) break;
    const u = (row.d - row.r ** 2) * Math.exp(row.s - s);
    points.push([row.r + carried(row), u]);
  }
  points.push([now.r, now.d - now.r ** 2]);
  points.reverse();
  for (let k = 1; k <= 24; k++) {  // the strip that was let go of when the drive set in
    const X = rows[0].r + (1 - rows[0].r) * k / 24;
    points.push([X + carried(rows[0]), (1 - X * X) * Math.exp(-s)]);
  }
  return points;
}
