// Stability of steady sliding on a Prony series, the drive holding the indenter by a spring (F24): a stiffness
// of the spring belongs to each frequency, as in kvtheory.models.steady.rubber_stability.

const add = ([a, b], [c, d]) => [a + c, b + d];
const minus = ([a, b], [c, d]) => [a - c, b - d];
const times = ([a, b], [c, d]) => [a * c - b * d, a * d + b * c];
const ratio = ([a, b], [c, d]) => { const n = c * c + d * d; return [(a * c + b * d) / n, (b * c - a * d) / n]; };
const scaled = (x, [a, b]) => [x * a, x * b];
const size = ([a, b]) => Math.hypot(a, b);
const fall_of = ([a, b]) => scaled(Math.exp(-a), [Math.cos(b), -Math.sin(b)]);
/** 1 - e^(-m). */
const lost_of = ([a, b]) => [-Math.expm1(-a) + 2 * Math.exp(-a) * Math.sin(b / 2) ** 2, Math.exp(-a) * Math.sin(b)];

const UNIT_GAUSS = gauss(14).map(([x, w]) => [0.5 + 0.5 * x, 0.5 * w]), FACTORIAL = [1, 1, 2, 6];

/** int f(x) (1 - x)^n/n! dx from 0 to 1 for n = 0 to 3. */
function weighted(f) {
  const sums = [[0, 0], [0, 0], [0, 0], [0, 0]];
  for (const [x, w] of UNIT_GAUSS) {
    const value = f(x);
    for (let n = 0; n < 4; n++) sums[n] = add(sums[n], scaled(w * (1 - x) ** n / FACTORIAL[n], value));
  }
  return sums;
}

/** phi_1 to phi_4 at -m. */
function phis(m) {
  if (size(m) < 2) return weighted((x) => fall_of(scaled(x, m)));
  const found = [ratio(lost_of(m), m)];
  for (let n = 1; n < 4; n++) found.push(ratio(minus([1 / FACTORIAL[n], 0], found[n - 1]), m));
  return found;
}

/** phi_n(-z) - phi_n(-z - sigma) for n = 2, 3, 4, to their own size. */
function phi_differences(z, sigma) {
  const m = [z + sigma[0], sigma[1]], fast = z >= size(m), pivot = fast ? [z, 0] : m;
  const part = (x) => scaled(Math.exp(-z * x), ratio(lost_of(scaled(x, sigma)), sigma));
  let found;
  if (size(pivot) < 2) found = weighted(part);
  else {
    const others = phis(fast ? m : [z, 0]);
    let last = part(1);
    found = others.map((other) => (last = ratio(minus(other, last), pivot)));
  }
  return found.slice(1).map((each) => times(sigma, each));
}

/** The strips of a contact: length, eta and width; of a line one strip of width 1. */
function strips_in_contact(scene, state, count) {
  const law = law_of(scene), own = (c, width) => ({ c, width, eta: growth(law.moments(c))[0] - 0.5 });
  if (scene.indenter !== "sphere") return [own(state.length, 1)];
  const half = state.half_length;
  return gauss(count).map(([x, w]) => {
    const angle = Math.PI * (x + 1) / 4, A = half * Math.cos(angle);
    return own(length_at_half(law, A), 2 * scene.stretch * A * w * Math.PI / 4);
  });
}

/** The stiffness k_x that makes i omega a rate, and what resists the vertical motion. */
function spring_at(scene, strips, omega) {
  const R = scene.shape[1], V = Math.abs(scene.V), drive = scene.drive || { damping: 0, mass: scene.mass };
  let A = [0, 0], B = [0, 0], C = [0, 0], D = [0, 0];
  for (const { c, width, eta } of strips) {
    const sigma = [0, omega * c / V];
    const damped = V * scene.damping / c, turned = damped * sigma[1];
    let own_A = [scene.K + damped, turned], own_B = [0, -eta * turned];
    let own_C = [scene.K * eta + damped * (0.5 + eta), eta * turned], own_D = [0, -(1 / 12 + eta * eta) * turned];
    for (const [K, tau] of scene.arms) {
      const z = c / (V * tau), [one, two, three] = phis([z, sigma[1]]), [second, third, fourth] = phi_differences(z, sigma);
      const whole = add(one, times(sigma, two));
      own_A = add(own_A, scaled(K, whole));
      own_C = add(own_C, scaled(K, minus(add(two, times(sigma, three)), scaled(0.5 - eta, whole))));
      own_B = add(own_B, scaled(K * z, minus(third, scaled(0.5 + eta, second))));
      own_D = add(own_D, scaled(K * z, minus(add(fourth, scaled((0.5 - eta) * (0.5 + eta), second)), third)));
    }
    const unit = c * width, slope = c / R;
    A = add(A, scaled(unit, own_A));
    B = add(B, scaled(unit * slope, own_B));
    C = add(C, scaled(unit * slope, own_C));
    D = add(D, scaled(unit * slope * slope, own_D));
  }
  const along = add(D, [drive.mass * omega * omega, -drive.damping * omega]);
  if (scene.depth !== undefined) return [along, [1, 0]];
  const across = add(A, [scene.spring - scene.mass * omega * omega, 0]);
  return [minus(along, ratio(times(B, C), across)), across];
}

/** Where two rates cross the imaginary axis: stiffness, frequency, and 1 where softer springs are less stable. */
function rubber_crossings(scene, state, { per_decade = 24, count = 24 } = {}) {
  const strips = strips_in_contact(scene, state, count), passing = Math.abs(scene.V) / state.length;
  const times_of = scene.arms.map(([, tau]) => 1 / tau), stiff = scene.arms.reduce((sum, [K]) => sum + K, scene.K);
  const sum = strips.reduce((total, { c, width }) => total + c * width, 0), scales = [passing, ...times_of];
  if (scene.damping > 0) scales.push(scene.K / scene.damping, stiff / scene.damping);
  if (scene.depth === undefined) scales.push(...[scene.K, stiff].map((K) => Math.sqrt((scene.spring + sum * K) / scene.mass)));
  const low = Math.log(Math.min(...scales)) - 8, high = Math.log(Math.max(...scales)) + 5;
  const cells = Math.ceil(per_decade * (high - low) / Math.LN10), found = [];
  const at = (log) => [log, ...spring_at(scene, strips, Math.exp(log))];
  const turn = ([, , a], [, , b]) => { const [x, y] = ratio(b, a); return Math.abs(Math.atan2(y, x)); };
  const look = (start, end, depth) => {
    if (depth < 24 && turn(start, end) > 0.4) {
      const middle = at(0.5 * (start[0] + end[0]));
      look(start, middle, depth + 1);
      look(middle, end, depth + 1);
      return;
    }
    const before = start[1][1] > 0;
    if (before === end[1][1] > 0) return;
    let [a, b] = [start[0], end[0]];
    for (let k = 0; k < 48; k++) {
      const middle = 0.5 * (a + b);
      if (at(middle)[1][1] > 0 === before) a = middle; else b = middle;
    }
    const [log, [stiffness]] = at(b);
    if (stiffness > 0) found.push({ stiffness, frequency: Math.exp(log) / (2 * Math.PI), way: before ? 1 : -1 });
  };
  let last = at(low);
  for (let k = 1; k <= cells; k++) {
    const next = at(low + (high - low) * k / cells);
    look(last, next, 0);
    last = next;
  }
  return found.sort((a, b) => a.stiffness - b.stiffness);
}

/** What `onset_of` gives, on a Prony series. */
function rubber_onset(scene, state, how) {
  const all = rubber_crossings(scene, state, how), none = { stiffness: NaN, frequency: NaN };
  const stable = (k) => all.reduce((sum, each) => sum + (each.stiffness > k ? each.way : 0), 0) < 0.5;
  if (!all.length) return { lower: none, upper: none, stable };
  return { lower: stable(0) ? all[0] : { stiffness: 0, frequency: 0 }, upper: all.at(-1), stable };
}
