// The elastic contact at rest on a layer of any thickness, as kvtheory.theory.contact_at_rest computes it.

const HERTZ = 4 * Math.SQRT2 / 3, SMALL_STEP = 1e-3, LAST_STEP = 1e-9, MOST_STEPS = 40, PANELS = 64;

/** The place of x among knots, and the four cubic B-splines that are not zero there. */
function basis(knots, x) {
  let i = 3;
  while (i < knots.length - 5 && x >= knots[i + 1]) i += 1;
  const found = [1];
  for (let d = 1; d <= 3; d++) {
    let kept = 0;
    for (let r = 0; r < d; r++) {
      const right = knots[i + r + 1] - x, left = x - knots[i + 1 - d + r], part = found[r] / (right + left);
      found[r] = kept + right * part;
      kept = left * part;
    }
    found.push(kept);
  }
  return [i - 3, found];
}

function spline(name, x, y) {
  const [i, row] = basis(MODEL.rest.log_thickness, x), [j, column] = basis(MODEL.rest.share, y), c = MODEL.rest[name];
  return row.reduce((sum, p, k) => sum + p * column.reduce((inner, q, m) => inner + q * c[i + k][j + m], 0), 0);
}

/** The load at rest at a depth: of a parabola per unit width, or of a ball. */
function load_at_rest(depth, { line, R, E, H, nu }) {
  const a = Math.sqrt(2 * R * depth), y = Math.log(H / a), ends = MODEL.rest.log_thickness;
  const within = Math.min(Math.max(y, ends[0]), ends[ends.length - 1]), thinner = Math.min(y - within, 0);
  const c = 1 / (1 + Math.exp(-2 * (within + thinner))), free = 1 - 2 * nu, share = free * (1 + c) / (free + c);
  const found = spline(line ? "line" : "ball", within, share) - thinner - Math.log((free + c) / (1 - nu) ** 2);
  return Math.exp(found) * depth * (line ? 1 : a) * E / (2 * (1 - nu * nu));
}

/** The depth at which an indenter at rest, and a spring, carry a load. */
function depth_at_rest(load, layer, spring = 0) {
  const { line, R, E, nu } = layer, S = 2 * (1 - nu * nu) / E;
  const excess = (depth) => Math.log((load_at_rest(depth, layer) + spring * depth) / load);
  let depth = line ? load * S : (load * S / HERTZ) ** (2 / 3) / Math.cbrt(2 * R);
  for (let k = 0; k < MOST_STEPS; k++) {
    const here = excess(depth), step = here * Math.log1p(SMALL_STEP) / (excess(depth * (1 + SMALL_STEP)) - here);
    depth *= Math.exp(-step);
    if (Math.abs(step) <= LAST_STEP) break;
  }
  return depth;
}

/** The stiffness on which the indenter at rest has the depth and the load of the layer. */
function rest_stiffness(layer, held, weight) {
  const depth = held ?? depth_at_rest(weight, layer), load = held === undefined ? weight : load_at_rest(depth, layer);
  return load / ((layer.line ? 4 / 3 * Math.sqrt(2 * layer.R * depth) : Math.PI * layer.R * depth) * depth);
}

/** The limits of friction on the layer itself (F28, F29), over the speed; nothing where they are not known. */
function layer_limits(scene) {
  const { layer, K, arms, depth, weight, spring } = scene;
  if (!layer || scene.order || !layer.known) return {};
  const low = (V) => V * mean_time(scene) / layer.R;
  if (!arms) return { low };
  const glassy = 1 + arms.reduce((sum, [k]) => sum + k / K, 0);
  const rate = arms.reduce((sum, [k, tau]) => sum + k / K / tau, 0) / glassy, stiff = { ...layer, E: layer.E * glassy };
  const lift = weight + (spring ? spring * depth_at_rest(weight, layer) : 0);
  const most = depth ?? depth_at_rest(lift, stiff, spring);
  let energy = 0;  // by Simpson's rule over the root of the depth
  for (let k = 1; k <= PANELS; k++) {
    const s = k / PANELS, part = k === PANELS ? 1 : k % 2 ? 4 : 2;
    energy += part * load_at_rest(s * s * most, stiff) * 2 * s * most / (3 * PANELS);
  }
  const high = rate * 2 * energy / load_at_rest(most, stiff);
  return { low, high: (V) => high / V, critical: Math.sqrt(high * layer.R / mean_time(scene)) };
}

/** V* of the independent elements on arms, which have the contact at rest of the layer (F28, F29). */
function crossing(scene, depth) {
  const { layer, K, arms, weight, spring } = scene, power = layer.line ? 1.5 : 2;
  const glassy = 1 + arms.reduce((sum, [k]) => sum + k / K, 0), rate = arms.reduce((sum, [k, tau]) => sum + k / K / tau, 0) / glassy;
  let share = 1;  // of the depth at rest
  if (scene.depth === undefined) {
    const kappa = spring * depth / weight;
    for (let k = 0; k < 60; k++) share -= (glassy * share ** power + kappa * (share - 1) - 1) / (power * glassy * share ** (power - 1) + kappa);
  }
  return Math.sqrt(rate * 2 * share * depth / (power + 1) * layer.R / mean_time(scene));
}

/** What is linear between the knots of some axes, and beyond them as at their ends; `entry` is at a place of the table. */
function between(axes, point, entry) {
  let corners = [[0, 1]];
  axes.forEach((axis, k) => {
    const i = Math.min(Math.max(axis.findLastIndex((knot) => knot <= point[k]), 0), axis.length - 2);
    const share = Math.min(Math.max((point[k] - axis[i]) / (axis[i + 1] - axis[i]), 0), 1);
    corners = corners.flatMap(([at, weight]) => [[at * axis.length + i, weight * (1 - share)], [at * axis.length + i + 1, weight * share]]);
  });
  const rows = corners.map(([at]) => entry(at));
  return rows[0].map((_, column) => rows.reduce((sum, row, k) => sum + corners[k][1] * row[column], 0));
}

/** Bounds of the errors of friction coefficient, and of depth or load, as kvtheory.layer.model_error has them. */
function relative_error(kind, h, nu, v, arms, reached, held) {
  const { safety, least, apart, table } = MODEL.model_error, own = table[held ? "fixed" : "dead-weight"];
  const size = arms.reduce((sum, [E]) => sum + E, 0), mean = (f) => arms.reduce((sum, [E, tau]) => sum + E / size * f(tau), 0);
  const width = arms.length ? Math.log10(Math.max(mean((t) => t) * mean((t) => 1 / t), 1)) : 0;
  const half_width = 1 + 0.5 * Math.log10(1 + 10 ** width * size * size / (1 + size));
  const place = Math.log10(v) / half_width, log = Math.log(h), thicknesses = table.thickness.map(Math.log), last = (axis) => axis[axis.length - 1];
  const axes = [thicknesses, table.poisson_ratio, ...(arms.length ? [own.stiffening.map(Math.log), own.width] : []), table.place];
  const values = own[arms.length ? `${kind} arms` : `${kind} kelvin_voigt`];
  if ((kind === "line" && log > last(thicknesses)) || (arms.length ? 1 + size > last(own.stiffening) : place > last(table.place))) return [Infinity, Infinity];
  const row = (at) => values.slice(4 * at, 4 * at + 4).map((x) => x / 1000), tallest = ([a, b, c, d]) => [Math.max(Math.abs(a), Math.abs(c)), Math.max(Math.abs(b), Math.abs(d))];
  const found = between(axes, arms.length ? [log, nu, Math.log(1 + size), width, place] : [log, nu, place], (at) => [...row(at), ...tallest(row(at))]);
  const bounds = [0, 1].map((k) => Math.max(Math.abs(found[k]), Math.abs(found[k + 2])) + safety * found[k + 4] + least);
  if (!width) return bounds;
  const places = table.place.length, block = own.width.length * places, stiffenings = own.stiffening.length + 1;
  const peaks = between([axes[0], axes[1], [0, ...axes[2]]], [log, nu, Math.log(reached)], (at) => {
    const [before, k] = [Math.floor(at / stiffenings), at % stiffenings - 1];
    const rows = table.place.map((_, i) => (k < 0 ? [0, 0] : tallest(row((before * (stiffenings - 1) + k) * block + i))));
    return [0, 1].map((column) => Math.max(...rows.map((each) => each[column])));
  });
  return bounds.map((bound, k) => Math.max(bound, Math.min(width / apart, 1) * ((1 + safety) * peaks[k] + least)));
}

/** How far independent elements are from the layer whose contact at rest they have; nothing of others, and where the page has no map. */
function model_error(scene) {
  const { layer, K, V } = scene;
  if (!layer || layer.way !== "rest" || !MODEL.model_error) return undefined;
  if (scene.order) return [Infinity, Infinity];
  const depth = scene.depth ?? depth_at_rest(scene.weight, layer), a = Math.sqrt(2 * layer.R * depth), speed = Math.abs(V);
  const arms = (scene.arms || []).map(([k, tau]) => [k / K, tau]), held = scene.depth !== undefined;
  const critical = scene.arms ? crossing(scene, depth) : limits({ ...scene, indenter: layer.line ? "parabola" : scene.indenter }).critical;
  const reached = arms.reduce((sum, [E, tau]) => sum + E * (1 - 1 / (1 + (MODEL.model_error.reached * speed / a * tau) ** 2)), 1);
  const errors = (at_depth) => relative_error(layer.line ? "line" : "ball", layer.H / a, layer.nu, speed / critical, arms, reached, at_depth);
  const [one, other] = [errors(held), errors(held || scene.spring > 0)];
  return one.map((error, k) => Math.max(error, other[k]));
}
