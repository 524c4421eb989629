// Numbers in words: the results, the formula that holds, energy, stability.

const NUMBERS = [
  ["friction_coefficient", "friction coefficient", "", 1], ["friction_force", "friction force F", "force"],
  ["load", "load W", "force"], ["depth", "depth \u03b4", "mm", 1e3],
  ["peak_pressure", "peak pressure", "MPa", 1e-6], ["leading_edge", "leading edge", "mm", 1e3],
  ["trailing_edge", "trailing edge", "mm", 1e3], ["retardation_length", "retardation length", "mm", 1e3],
];
/** Relative error up to which a limit is called the formula that holds. */
const WITHIN = 0.05;
/** Size of letters in pixels below which a formula is not legible. */
const SMALLEST = 11;

/** The number that says whether a layer is thin for its contact; 0 where it is not taken as such. */
function layer_number({ layer, stretch }, { half_length }) {
  return layer?.way === "thin" ? (layer.H / (half_length * Math.min(1, stretch))) ** 2 / (1 - 2 * layer.nu) : 0;
}

/** What of a contact is beyond linear theory, as kvtheory.scene.layer says it; nothing within it. */
function large_deformation({ layer, indenter, shape: [size, length, n], stretch }, { depth, half_length: a }) {
  if (!layer) return "";
  const strain = depth / layer.H, flat = size * (a / length) ** (n - 1) / Math.min(1, stretch);
  const slope = indenter === "circle" ? flat / Math.sqrt(Math.max(0, 1 - flat * flat)) : flat;
  if (strain > 1) return `There is no such contact: depth/thickness = <b>${short(strain, 3)}</b>, so that the indenter would reach the base of the layer.`;
  const told = [];
  if (strain > MODEL.large_strain) told.push(`depth/thickness = <b>${short(strain, 3)}</b>, above ${MODEL.large_strain}`);
  if (slope > MODEL.large_slope) told.push(`the slope of the indenter at the edge of the contact = <b>${short(slope, 3)}</b>, above ${MODEL.large_slope}`);
  return told.length ? `Strains are large: ${told.join(", and ")}. Foundation and layer follow linear theory, which is then wrong by about 10\u00a0% or more.` : "";
}

/** How far the curve is from the layer, in words. */
function told_error(scene) {
  const error = model_error(scene), instead = "<code>kvtheory steady --method layer</code> solves the layer itself.";
  if (!error) return " <code>kvtheory scene</code> says how far the curve, of independent elements, is from it.";
  if (!Number.isFinite(error[0])) return ` How far the curve, of independent elements with the same contact at rest, is from it is not known here; ${instead}`;
  const [mu, second] = error.map((each) => `<b>${short(100 * each, 2)} %</b>`);
  return ` The curve is that of independent elements with the same contact at rest: here \u03bc is within ${mu}, ${scene.depth === undefined ? "depth" : "load"} within ${second}; ${instead}`;
}

function show_layer(scene, state) {
  const place = document.getElementById("layer"), number = layer_number(scene, state), body = document.getElementById("body");
  const large = large_deformation(scene, state), thick = number <= MODEL.thin ? ""
    : `The layer is not thin for its contact: (h/a)\u00b2/(1 \u2212 2\u03bd) = <b>${short(number, 3)}</b>, above ${MODEL.thin}, so `
    + "that it does not act as independent elements of the stiffness of a thin layer. Leave out <code>stiffness_from</code>, or solve the "
    + "body itself: <code>kvtheory steady --method layer</code>.";
  place.hidden = !large && !thick;
  place.innerHTML = [large, thick].filter(Boolean).join("<br>");
  const { low, high, critical } = layer_limits(scene);
  body.hidden = !low;
  body.innerHTML = low ? `On the layer itself \u03bc \u2192 <b>${short(low(1))}</b> s/m V at low velocity`
    + (high ? `, \u03bc \u2192 <b>${short(high(1))}</b> m/s / V at high velocity; they cross at V* = <b>${short(critical * 1e3)}</b> mm/s.` : ".")
    + told_error(scene) : "";
}

/** What leaves the range in which the foundation was measured, as kvtheory.scene.foundations says it. */
function beyond_measured({ V, a_T, measured: m }, { leading_edge, trailing_edge }) {
  const told = [], rate = Math.abs(V / (trailing_edge - leading_edge)) * a_T;
  if (rate > 0 && (rate < m.lowest_frequency / MODEL.barely || rate > m.highest_frequency * MODEL.barely)) {
    told.push(`V${m.temperature === undefined ? "" : "\u00a0a<sub>T</sub>"}/c = <b>${short(rate, 3)} Hz</b> is outside the frequencies at which the foundation `
      + `is known, so that its series extrapolates (${short(m.lowest_frequency, 3)} to ${short(m.highest_frequency, 3)} Hz).`);
  }
  const low = m.lowest_temperature ?? m.reference_temperature - m["wlf.c_2"] + MODEL.glass, high = m.highest_temperature ?? Infinity;
  if (low > m.temperature + MODEL.near || high < m.temperature - MODEL.near) {
    const known = high < Infinity ? `${short(low)} to ${short(high)} K` : `above ${short(low)} K`;
    told.push(`The temperature is outside those at which its shift is known (${known}), so that a<sub>T</sub> extrapolates.`);
  }
  return told;
}

function show_measured(scene, state) {
  const place = document.getElementById("measured"), told = beyond_measured(scene, state);
  place.hidden = !told.length;
  place.innerHTML = told.join("<br>");
}

function show_numbers(scene, state) {
  const force = force_units(scene);
  document.getElementById("numbers").innerHTML = NUMBERS.map(([name, told, unit, factor]) => {
    const [shown, by] = unit === "force" ? force : [unit, factor];
    const value = `${short(state[name] * by, 5)}${shown ? ` <small>${shown}</small>` : ""}`;
    return `<div><small>${told}</small><b data-name="${name}">${value}</b></div>`;
  }).join("");
  const warned = layer_number(scene, state) > MODEL.thin ? "Layer not thin: " : "";
  document.getElementById("readout").textContent = warned
    + `\u03bc = ${short(state.friction_coefficient)}, \u03b4 = ${short(state.depth * 1e3, 3)} mm, `
    + `F = ${short(state.friction_force * force[1], 3)} ${force[0]}`;
}

/** Whose formulas hold: those of the shape on Kelvin-Voigt elements, else those of the foundation. */
function family_of({ indenter, kelvin_voigt }) {
  const shape = { "power-law": "power", wedge: "power", sphere: "ball" }[indenter] || indenter;
  if (kelvin_voigt) return shape;
  return shape === "ball" ? "viscoelastic-ball" : "viscoelastic";
}

/** The formula that is within the tolerance here, its value and its error. */
function formula_here(scene, state) {
  const known = limits(scene), speed = Math.abs(scene.V), exact = Math.abs(state.friction_coefficient);
  const family = family_of(scene);
  for (const kind of ["low", "high"]) {
    const value = known[kind] && speed > 0 ? known[kind](speed) : NaN, error = value / exact - 1;
    if (Math.abs(error) <= WITHIN) {
      const own = `${kind === "high" && known.damper ? "parabola" : family}-${kind}`;  // of the damper alone
      return { key: own in MODEL.formulas ? own : `${own}-${scene.support}`, value, error };
    }
  }
  return { key: `${family}-exact`, value: exact, error: 0 };
}

/** The numbers that a formula can hold, with their units. */
function quantities_of(scene, state, key) {
  const { rest } = state, [, L, n] = scene.shape, K = scene.K, speed = Math.abs(scene.V);
  const C = !scene.arms ? K * scene.tau : key.startsWith("parabola") ? scene.damping : damping(scene), fixed = scene.depth !== undefined;
  const lift = fixed ? 0 : rest.load + scene.spring * rest.depth;
  const high = fixed ? rest.depth : lift / (C * speed);
  const m = (x) => `${short(x * 1e3)} mm`, [unit, factor] = force_units(scene), whole = scene.indenter === "sphere";
  const force = (x) => `${short(x * factor)} ${unit}`;
  const tilt = whole ? limits(scene).half_length?.(speed) : L * root_of(n * high / (scene.shape[0] * L), n);
  const found = {
    C: `${short(C * 1e-9)} N\u00b7s/mm\u00b3`, K: `${short(K * 1e-9)} N/mm\u00b3`, V: `${short(speed * 1e3)} mm/s`,
    R: m(L), W: force(state.load), F: force(Math.abs(state.friction_force)), W_0: force(rest.load),
    k_s: whole ? `${short(scene.spring * 1e-3)} N/mm` : `${short(scene.spring * 1e-6)} N/mm\u00b2`,
    a: m(state.half_length), a_0: m(rest.half_length),
    delta: m(state.depth), delta_0: m(rest.depth), l_r: m(state.retardation_length), delta_h: m(high),
    a_h: m(tilt), n: short(n), q: short(state.q ?? NaN), Q: short(state.Q ?? NaN), l: short(state.l ?? NaN),
    T: short(state.tail ?? NaN),
  };
  if (state.parts) {
    const { left, steepness, compressed } = state.parts;
    Object.assign(found, { u: m(left), S: m(steepness), U: `${short(compressed * 1e6)} mm\u00b2` });
  }
  if (scene.kelvin_voigt) return found;
  const c = state.half_length + Math.abs(state.trailing_edge), M = law_of(scene).moments(c);
  const in_GPa = (x) => `${short(x * 1e-9)}`;
  const [a_g, rate] = limits(scene).glassy || [NaN, NaN];
  return {
    ...found, c: m(c), P: in_GPa(M.P), D: in_GPa(M.D), E: in_GPa(M.E), eta: short(0.5 * (M.P - M.Q) / (M.P + M.Q)),
    g: `${short(rate)} 1/s`, a_g: m(a_g),
  };
}

/** Make a formula smaller where it is wider than its card, as far as it stays legible; beyond, it scrolls. */
function fit(formula) {
  const size = parseFloat(getComputedStyle(formula).fontSize), share = formula.clientWidth / formula.scrollWidth;
  if (share < 1) formula.style.fontSize = `${Math.max(SMALLEST, 0.98 * share * size)}px`;
}

function show_formula(scene, state) {
  const place = document.getElementById("formula");
  if (state.friction_coefficient === 0) {
    place.innerHTML = '<p class="note">At rest there is no friction.</p>';
    return;
  }
  const found = formula_here(scene, state), row = MODEL.formulas[found.key], numbers = quantities_of(scene, state, found.key);
  const filled = row.numbers.replace(/#(\w+)#/g, (_, name) => numbers[name]);
  const relation = found.error === 0 ? "=" : "\u2248", side = Math.sign(state.friction_coefficient) < 0 ? "\u2212" : "";
  const told = found.error === 0
    ? `${limits(scene).low ? "No limit is within 5 % here: the" : "The"} exact form.`
    : `${found.key.includes("low") ? "Slow" : "Fast"} sliding: the limit is ${found.error < 0 ? "below" : "above"}`
      + ` the exact value by ${short(100 * Math.abs(found.error), 2)} %.`;
  const where = row.where.replace(/([a-z\u03b4W])_(\w+)/gu, "$1<sub>$2</sub>"), symbol = `\u03bc ${relation} ${side}`;
  place.innerHTML = `<p class="note">${told}</p><div class="formula">${symbol} ${row.symbols}</div>`
    + `<div class="formula filled" tabindex="0" aria-label="The same with numbers">${symbol} ${filled}</div>`
    + `<p>${symbol} <b id="formula-value">${side}${short(found.value, 5)}</b></p>`
    + `<p class="note">${where} Proof: <code>kvtheory derive --only ${row.label} --closure</code></p>`;
  place.querySelectorAll(".formula").forEach(fit);
}

function show_energy(state) {
  const inside = state.dissipated_in_contact, share = (x) => `${short(100 * x, 3)} %`;
  const part = (kind, width) => `<span class="${kind}" style="width:${100 * width}%"></span>`;
  document.getElementById("energy").innerHTML =
    `<div class="bar" role="img" aria-label="${share(inside)} inside the contact">`
    + `${part("inside", inside)}${part("behind", 1 - inside)}</div>`
    + `<div class="legend"><span><b>\u25a0</b> ${share(inside)} dissipated in the contact</span>`
    + `<span><b>\u25a8</b> ${share(Math.max(0, 1 - inside))} in the surface that relaxes behind it</span></div>`;
}

/** The stiffness of a spring along x. */
const stiffness_text = (scene, x) =>
  (scene.indenter === "sphere" ? `${short(x * 1e-3)} N/mm` : `${short(x * 1e-6)} MN/m\u00b2`);
const table = (rows) => `<table>${rows.map(([name, value]) => `<tr><td>${name}</td><td>${value}</td></tr>`).join("")}</table>`;

/** How small disturbances change, each rate or pair of rates once. */
function motions(pairs) {
  return pairs.filter(([, imaginary]) => imaginary >= 0).map(([real, imaginary]) => {
    const change = real < 0 ? "decays" : "grows", time = `time constant ${short(1e3 / Math.abs(real))} ms`;
    return [imaginary > 0 ? `oscillation at ${short(imaginary / (2 * Math.PI))} Hz ${change}` : `a disturbance ${change}`, time];
  });
}

function show_stability(scene, state) {
  const place = document.getElementById("stability"), { drive } = scene;
  if (scene.depth !== undefined && !drive) {
    place.innerHTML = '<p class="note">An indenter that is held cannot move: nothing can become unstable.</p>';
    return;
  }
  if (!has_stability(scene)) {
    place.innerHTML = '<p class="note">Known for a parabola and for a ball that slide on Kelvin\u2013Voigt elements or on a Prony series.</p>';
    return;
  }
  const { lower, upper, stable: on } = onset_of(scene, state, { count: 12 }), pairs = scene.arms ? [] : rates(scene, state);
  const stable = !drive || on(drive.stiffness), some = Number.isFinite(upper.stiffness);
  const on_spring = stable ? "Stable on this spring: small disturbances decay" : "Unstable on this spring: small disturbances grow";
  const told = drive ? `${on_spring} (derivation ${scene.arms ? "F24" : "F22"}).` : "Stable under a rigid drive.";
  const rows = drive ? [["spring of the drive", stiffness_text(scene, drive.stiffness)]] : [];
  if (some) {
    rows.push([drive ? "stable above" : "a spring in the drive would have to exceed", stiffness_text(scene, upper.stiffness)]);
    if (lower.stiffness > 0) rows.push(["and below", stiffness_text(scene, lower.stiffness)]);
    rows.push(["frequency at the onset", `${short(upper.frequency)} Hz`]);
  } else rows.push(["with any spring in the drive", "stable"]);
  place.innerHTML = `<p class="note" data-stable="${stable}">${told}</p>${table([...rows, ...motions(pairs)])}`;
}
