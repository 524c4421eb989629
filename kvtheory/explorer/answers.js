// Numbers in words: the results, the formula that holds, energy, stability.

const NUMBERS = [
  ["friction_coefficient", "friction coefficient", "", 1], ["friction_force", "friction force F", "N/mm", 1e-3],
  ["load", "load W", "N/mm", 1e-3], ["depth", "depth \u03b4", "mm", 1e3],
  ["peak_pressure", "peak pressure", "MPa", 1e-6], ["leading_edge", "leading edge", "mm", 1e3],
  ["trailing_edge", "trailing edge", "mm", 1e3], ["retardation_length", "retardation length", "mm", 1e3],
];
/** Relative error up to which a limit is called the formula that holds. */
const WITHIN = 0.05;

function show_numbers(state) {
  document.getElementById("numbers").innerHTML = NUMBERS.map(([name, told, unit, factor]) =>
    `<div><small>${told}</small><b data-name="${name}">${short(state[name] * factor, 5)}${unit ? ` <small>${unit}</small>` : ""}</b></div>`).join("");
  document.getElementById("readout").textContent =
    `\u03bc = ${short(state.friction_coefficient)}, \u03b4 = ${short(state.depth * 1e3)} mm, F = ${short(state.friction_force * 1e-3)} N/mm`;
}

/** The formula that is within the tolerance here, its value and its error. */
function formula_here(scene, state) {
  const known = limits(scene), speed = Math.abs(scene.V), exact = Math.abs(state.friction_coefficient);
  const family = scene.kelvin_voigt ? (scene.parabola ? "parabola" : "power") : "viscoelastic";
  for (const kind of ["low", "high"]) {
    const value = known[kind] && speed > 0 ? known[kind](speed) : NaN, error = value / exact - 1;
    if (Math.abs(error) <= WITHIN) {
      const own = `${family}-${kind}`;
      return { key: own in MODEL.formulas ? own : `${own}-${scene.support}`, value, error };
    }
  }
  return { key: `${family}-exact`, value: exact, error: 0 };
}

/** The numbers that a formula can hold, with their units. */
function quantities_of(scene, state) {
  const { rest } = state, [, L, n] = scene.shape, K = scene.K, speed = Math.abs(scene.V);
  const C = scene.arms ? damping(scene) : K * scene.tau, fixed = scene.depth !== undefined;
  const lift = fixed ? 0 : rest.load + scene.spring * rest.depth;
  const high = fixed ? rest.depth : lift / (C * speed);
  const m = (x) => `${short(x * 1e3)} mm`;
  const found = {
    C: `${short(C * 1e-9)} N\u00b7s/mm\u00b3`, K: `${short(K * 1e-9)} N/mm\u00b3`, V: `${short(speed * 1e3)} mm/s`,
    R: m(L), W: `${short(state.load * 1e-3)} N/mm`, W_0: `${short(rest.load * 1e-3)} N/mm`,
    k_s: `${short((scene.spring || 0) * 1e-6)} N/mm\u00b2`, a: m(state.half_length), a_0: m(rest.half_length),
    delta: m(state.depth), delta_0: m(rest.depth), l_r: m(state.retardation_length), delta_h: m(high),
    a_h: m(scene.shape[1] * root_of(n * high / (scene.shape[0] * scene.shape[1]), n)),
    n: short(n), q: short(state.q ?? NaN), Q: short(state.Q ?? NaN), l: short(state.l ?? NaN),
  };
  if (scene.kelvin_voigt) return found;
  const c = state.half_length + Math.abs(state.trailing_edge), M = (scene.arms ? prony(scene) : springpot(scene)).moments(c);
  const in_GPa = (x) => `${short(x * 1e-9)}`;
  const [a_g, rate] = limits(scene).glassy || [NaN, NaN];
  return {
    ...found, c: m(c), P: in_GPa(M.P), D: in_GPa(M.D), E: in_GPa(M.E), eta: short(0.5 * (M.P - M.Q) / (M.P + M.Q)),
    g: `${short(rate)} 1/s`, a_g: m(a_g),
  };
}

function show_formula(scene, state) {
  const place = document.getElementById("formula");
  if (state.friction_coefficient === 0) {
    place.innerHTML = "<p>At rest there is no friction.</p>";
    return;
  }
  const found = formula_here(scene, state), row = MODEL.formulas[found.key], numbers = quantities_of(scene, state);
  const filled = row.numbers.replace(/#(\w+)#/g, (_, name) => numbers[name]);
  const relation = found.error === 0 ? "=" : "\u2248", side = Math.sign(state.friction_coefficient) < 0 ? "\u2212" : "";
  const told = found.error === 0
    ? "No limit is within 5 % here: the exact closed form."
    : `${found.key.includes("low") ? "Slow" : "Fast"} sliding: the limit is ${found.error < 0 ? "below" : "above"}`
      + ` the exact value by ${short(100 * Math.abs(found.error), 2)} %.`;
  const where = row.where.replace(/([a-z\u03b4W])_(\w+)/gu, "$1<sub>$2</sub>"), symbol = `\u03bc ${relation} ${side}`;
  place.innerHTML = `<p class="note">${told}</p><div class="formula">${symbol} ${row.symbols}</div>`
    + `<div class="formula filled" tabindex="0" aria-label="The same with numbers">${symbol} ${filled} = `
    + `<b id="formula-value">${side}${short(found.value, 5)}</b></div>`
    + `<p class="note">${where} Proof: <code>kvtheory derive --only ${row.label} --closure</code></p>`;
}

function show_energy(state) {
  const inside = state.dissipated_in_contact, share = (x) => `${short(100 * x, 3)} %`;
  const part = (kind, width) => `<span class="${kind}" style="width:${100 * width}%"></span>`;
  document.getElementById("energy").innerHTML =
    `<div class="bar" role="img" aria-label="${share(inside)} inside the contact">`
    + `${part("inside", inside)}${part("behind", 1 - inside)}</div>`
    + `<div class="legend"><span>\u25a0 ${share(inside)} dissipated in the contact</span>`
    + `<span>\u25a8 ${share(Math.max(0, 1 - inside))} in the surface that relaxes behind it</span></div>`;
}

function show_stability(scene, state) {
  const place = document.getElementById("stability");
  if (scene.depth !== undefined) {
    place.innerHTML = "<p>An indenter that is held cannot move: nothing can become unstable.</p>";
  } else if (!scene.kelvin_voigt || !scene.parabola) {
    place.innerHTML = "<p>Known in closed form for a parabola on Kelvin\u2013Voigt elements.</p>";
  } else {
    const { pairs } = rates(scene, state), [one, two] = pairs;
    const time = (rate) => `${short(-1e3 / rate)} ms`;
    const rows = one[1] === 0
      ? [["small motions", "die out monotonically"], ["fast time constant", time(one[0])], ["slow time constant", time(two[0])]]
      : [["small motions", "oscillate and die out"], ["frequency", `${short(one[1] / (2 * Math.PI))} Hz`], ["decay time", time(one[0])]];
    place.innerHTML = `<p class="note">Stable under a rigid drive: both rates are negative (derivation F12).</p><table>${
      rows.map(([name, value]) => `<tr><td>${name}</td><td>${value}</td></tr>`).join("")}</table>`;
  }
}
