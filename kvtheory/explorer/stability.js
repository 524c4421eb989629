// Stability of steady sliding of a parabola or a ball on Kelvin-Voigt elements, held along x by a spring or
// rigidly: closed forms (F12, F22), as kvtheory.models.steady.stability and ball_stability have them.

/** Both dampings of the contact, and the numbers that follow from them and from the damper of the drive. */
function parabola_numbers(scene, state, damper) {
  const R = scene.shape[1], K = scene.K, tau = scene.tau, a = state.half_length, { l, q } = state;
  const along = K * tau * damping_along(a / R, q) * R / 3, across = K * tau * damping_across(a, q) * (4 / 3);
  const n_x = damper / along, S_s = scene.spring * tau / across;
  return {
    along, across, g: coupling(l, q, n_x), h: uncoupled(q, n_x), S_c: coupling_rate(q),
    S_z: relaxation_rate(q, S_s), e: friction_rise(q, n_x, S_s),
  };
}

/** The same of a ball: sums over its strips, each a parabola, in closed form (F20-slopes). */
function ball_numbers(scene, state, damper) {
  const R = scene.shape[1], tau = scene.tau, a = state.half_length, { l, tail } = state;
  const X = ball_trailing_edges(l, tail), both = Math.PI / 4 + X, cubes = 3 * Math.PI / 16 + ball_cubed_trailing_edges(l, tail);
  const unit = 2 * scene.K * a * (a * scene.stretch), across = tau * unit * both;
  const along = tau * unit * (a / R) ** 2 * (cubes / 3), share = along / (along + damper);
  const g = l * X / both * (3 * l * X / cubes) * share, S_c = both / X, S_z = (both + l) / both + scene.spring * tau / across;
  return { along, across, g, h: 1 - g, S_c, S_z, e: S_z - g * S_c };
}

/** The numbers of the rates; `unit` is the stiffness of S_x = 1. A held indenter has T_z = 0, S_z infinite. */
function stability_numbers(scene, state) {
  const tau = scene.tau, held = scene.depth !== undefined;
  const drive = scene.drive || { damping: 0, mass: scene.mass ?? NaN };
  const { along, across, ...found } = (scene.indenter === "sphere" ? ball_numbers : parabola_numbers)(scene, state, drive.damping);
  const damped = along + drive.damping, own = { tau, held, unit: damped / tau, T_x: drive.mass / (damped * tau) };
  if (held) return { ...found, ...own, T_z: 0, S_z: Infinity, e: Infinity };
  return { ...found, ...own, T_z: scene.mass / (across * tau) };
}

/** The stiffnesses between which steady sliding is unstable, in N/m^2 (of a ball in N/m), and the frequencies there, in Hz. */
function onsets(number) {
  const { T_z, T_x, S_z, S_c, g, h, e, unit, tau, held } = number, none = { stiffness: NaN, frequency: NaN };
  if (held) return { lower: none, upper: none };
  const square = onset_square(T_z, g, S_c, h, e), n = onset_sum(T_z, g, S_c, h, e), falls = e < 0;
  if (!falls && !(n < 0 && square >= 0)) return { lower: none, upper: none };
  const s = Math.sqrt(square);
  const at = (Omega, lag) => ({
    stiffness: unit * onset_stiffness(T_x, S_c, Omega, lag), frequency: Math.sqrt(Omega) / (2 * Math.PI * tau),
  });
  const fast = n > 0 ? -2 * S_z * e / (s + n) : (s - n) / (2 * T_z * T_z);
  const lower = falls ? { stiffness: 0, frequency: 0 } : at(2 * S_z * e / (s - n), onset_lag_of_lower(T_z, g, S_c, h, s));
  return { lower, upper: at(fast, onset_lag(T_z, g, S_c, h, S_z, s)) };
}

const is_stable = (stiffness, { lower, upper }) => !(stiffness >= lower.stiffness && stiffness <= upper.stiffness);

/** Coefficients of the polynomial of the rates in 1/tau, from the constant one on: none if nothing can move. */
function rate_polynomial(number, scene) {
  const { T_z, T_x, S_z, h, e, unit, held } = number;
  if (!scene.drive) return held ? [] : [S_z, 1, T_z];
  const S_x = scene.drive.stiffness / unit;
  return held ? [S_x, 1, T_x] : [S_z * S_x, S_x + e, T_z * S_x + h + S_z * T_x, T_z + T_x, T_z * T_x];
}

/** Rates of small motions about steady sliding in 1/s, as pairs, fastest growth first. */
function rates(scene, state) {
  const number = stability_numbers(scene, state);
  return roots(rate_polynomial(number, scene)).map((pair) => pair.map((each) => each / number.tau));
}

/** The roots of a real polynomial of a low degree: Aberth's method on all of them at once. */
function roots(coefficients) {
  const degree = coefficients.length - 1;
  if (degree < 1) return [];
  const unit = (coefficients[0] / coefficients[degree]) ** (1 / degree);
  const scaled = coefficients.map((each, k) => each * unit ** k), most = Math.max(...scaled.map(Math.abs));
  const P = scaled.map((each) => each / most);
  const over = ([a, b], [c, d]) => [(a * c + b * d) / (c * c + d * d), (b * c - a * d) / (c * c + d * d)];
  const value = ([x, y]) => {
    let p = [0, 0], dp = [0, 0];
    for (let k = degree; k >= 0; k--) {
      dp = [dp[0] * x - dp[1] * y + p[0], dp[0] * y + dp[1] * x + p[1]];
      p = [p[0] * x - p[1] * y + P[k], p[0] * y + p[1] * x];
    }
    return [p, dp];
  };
  const z = start_places(P, degree);
  for (let round = 0; round < 100; round++) {
    let moved = 0;
    for (let i = 0; i < degree; i++) {
      const [p, dp] = value(z[i]);
      if (p[0] === 0 && p[1] === 0) continue;
      const newton = over(p, dp), push = [0, 0];
      for (let j = 0; j < degree; j++) {
        if (j === i) continue;
        const [x, y] = over([1, 0], [z[i][0] - z[j][0], z[i][1] - z[j][1]]);
        push[0] += x;
        push[1] += y;
      }
      const [x, y] = newton, step = over(newton, [1 - x * push[0] + y * push[1], -x * push[1] - y * push[0]]);
      if (!Number.isFinite(step[0] + step[1])) continue;
      z[i] = [z[i][0] - step[0], z[i][1] - step[1]];
      moved = Math.max(moved, Math.hypot(...step) / Math.hypot(...z[i]));
    }
    if (moved < 4 * EPS) break;
  }
  const real = ([x, y]) => (Math.abs(y) < 1e-9 * Math.abs(x) ? [x, 0] : [x, y]);
  return z.map(real).map(([x, y]) => [x * unit, y * unit]).sort((a, b) => b[0] - a[0] || a[1] - b[1]);
}

/** Places around the sizes that neighbouring coefficients give: the roots may lie decades apart. */
function start_places(P, degree) {
  const sizes = Array.from({ length: degree }, (_, k) => Math.abs(P[k] / P[k + 1]) || 1);
  return sizes.map((size, k) => [size * Math.cos(1 + 2.4 * k), size * Math.sin(1 + 2.4 * k)]);
}

/** The stiffnesses and frequencies between which sliding is unstable, and whether it is stable on a spring. */
function onset_of(scene, state, how) {
  if (scene.arms) return rubber_onset(scene, state, how);
  const onset = onsets(stability_numbers(scene, state));
  return { ...onset, stable: (stiffness) => is_stable(stiffness, onset) };
}

const ROUGHLY = { per_decade: 10, count: 6 };

/** At which of several speeds the steady state is unstable on the spring of the drive, and from which speed on:
 * into `data`, one speed at a time, as many arms take seconds. */
function* find_unstable(scene, speeds, states, data) {
  if (!has_stability(scene) || !scene.drive) return;
  const slips = (V, state) => !onset_of({ ...scene, V }, state, ROUGHLY).stable(scene.drive.stiffness);
  for (const [k, V] of speeds.entries()) {
    data.unstable[k] = slips(V, states[k]);
    yield;
  }
  const first = data.unstable.indexOf(true);
  if (first < 1) return;
  let [low, high] = [speeds[first - 1], speeds[first]];
  for (let k = 0; k < (scene.arms ? 16 : 50); k++) {
    const middle = Math.sqrt(low * high);
    if (slips(middle, slide({ ...scene, V: middle }))) high = middle; else low = middle;
    yield;
  }
  data.from = high;
}

const has_stability = (scene) =>
  (scene.kelvin_voigt || (scene.arms && scene.V !== 0)) && ["parabola", "sphere"].includes(scene.indenter);
