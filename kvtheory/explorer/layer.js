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
