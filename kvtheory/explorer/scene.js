// A scene as the page holds it: choices, and texts in the units that are shown. SI, TOML, Python, link.

const MODEL = JSON.parse(document.getElementById("data").textContent);
const SECTIONS = MODEL.sections;
const original = () => structuredClone(MODEL.scene);

/** Section and name of a key, such as foundation and wlf.c_1. */
function parted(key) {
  const at = key.indexOf(".");
  return [key.slice(0, at), key.slice(at + 1)];
}

/** A text in the unit that is shown, as a number in SI: with the same decimals. */
function si(text, slider) {
  const [digits, power] = String(text).trim().toLowerCase().split("e");
  const number = /^[+-]?(\d+\.?\d*|\.\d+)$/.test(digits) ? Number(`${digits}e${Number(power || 0) + slider.exponent}`) : NaN;
  return number;
}

/** What is wrong with a text, if anything. */
function mistake_in(text, slider, signed) {
  const number = si(text, slider), x = signed ? 0 : number;
  if (!Number.isFinite(number)) return "a number is expected";
  if (signed) return "";
  const low = slider.minimum, above = low === null || (slider.exclusive ? x > low : x >= low);
  const under = (slider.below === null || x < slider.below) && (slider.maximum === null || x <= slider.maximum);
  return above && under ? "" : `out of range: ${slider.range}`;
}

const PREFIXES = { n: -9, u: -6, "\u00b5": -6, "\u03bc": -6, m: -3, c: -2, d: -1, "": 0, h: 2, k: 3, M: 6, G: 9, T: 12 };
/** Units as powers of metre, kilogram, second, kelvin and mole, and their size. */
const UNITS = {
  m: [[1, 0, 0, 0, 0], 1], g: [[0, 1, 0, 0, 0], 1e-3], s: [[0, 0, 1, 0, 0], 1], K: [[0, 0, 0, 1, 0], 1], mol: [[0, 0, 0, 0, 1], 1],
  N: [[1, 1, -2, 0, 0], 1], Pa: [[-1, 1, -2, 0, 0], 1], J: [[2, 1, -2, 0, 0], 1], Hz: [[0, 0, -1, 0, 0], 1],
  min: [[0, 0, 1, 0, 0], 60], h: [[0, 0, 1, 0, 0], 3600], "1": [[0, 0, 0, 0, 0], 1],
};
const CELSIUS = ["degC", "\u00b0C"];

/** The dimension and size of a unit such as N*s/m^2; nothing if it is unknown. */
function unit_of(text) {
  const plain = text.trim().replace(/[\u00b9\u00b2\u00b3]/g, (c) => `^${"\u00b9\u00b2\u00b3".indexOf(c) + 1}`).replace(/\s*([*\u00b7/])\s*|\s+/g, (_, c) => c || "*");
  let dimension = [0, 0, 0, 0, 0], size = 1;
  for (const [, sign, name, power] of plain.replace(/\*\*/g, "^").matchAll(/(^|[*\u00b7/])([^*\u00b7/^]*)(?:\^(-?\d+))?/g)) {
    const own = name in UNITS ? ["", name] : [name[0], name.slice(1)];
    if (!(own[0] in PREFIXES) || !(own[1] in UNITS)) return null;
    const [powers, value] = UNITS[own[1]], k = (sign === "/" ? -1 : 1) * Number(power || 1);
    dimension = dimension.map((x, i) => x + k * powers[i]);
    size *= (value * Number(`1e${PREFIXES[own[0]]}`)) ** k;
  }
  return { dimension: String(dimension), size };
}

/** A typed text as a number in the unit of its slider: [number, ""], or ["", what is wrong]. */
function understood(text, slider, signed) {
  const plain = text.trim().replace(/^\u2212/, "-").replace(/e\u2212/i, "e-");
  const [, number, unit] = plain.match(/^([+-]?[\d.,]+(?:e[+-]?\d+)?)\s*(.*)$/i) || [];
  if (number === undefined) return ["", "a number is expected"];
  if (/^[+-]?[1-9]\d{0,2},\d{3}$/.test(number)) return ["", "does the comma separate decimals or thousands? Write a point, or no comma"];
  let value = number.replace(/^([^.,]*),([^.,]*)$/, "$1.$2");
  if (CELSIUS.includes(unit) && slider.unit === "K" && !slider.difference) {
    value = String(Number((Number(value) + 273.15).toPrecision(15)));
  } else if (unit) {
    const given = unit_of(unit), own = unit_of(slider.unit || "1");
    if (!given) return ["", `the unit ${unit} is not known; expected ${slider.unit || "none"}`];
    if (given.dimension !== own.dimension) return ["", `${unit} does not fit; expected a unit such as ${slider.unit || "none"}`];
    if (unit !== slider.unit) value = String(Number((Number(value) * (given.size / own.size)).toPrecision(15)));
  }
  const mistake = mistake_in(value, slider, signed);
  return mistake ? ["", mistake] : [value, ""];
}

/** The sets of quantities of a section of which one is to be given, and which of them is: the longest there. */
const sets_of = (state, section) => SECTIONS[section].alternatives[state.choices[section]].map((set) => set.names);

function asked(state, section) {
  const sets = sets_of(state, section), given = (set) => set.every((name) => `${section}.${name}` in state.values);
  return [...sets].sort((a, b) => b.length - a.length).find(given) || sets[0];
}

/** Whether forces are those of a ball, and not per unit width. */
const is_whole = (state) => MODEL.whole.includes(state.choices.indenter);

/** What a scene may give beside the set that is asked, such as a temperature. */
function optional(state, section) {
  const sets = sets_of(state, section).flat();
  return Object.keys(SECTIONS[section].choices[state.choices[section]]).filter((name) => !sets.includes(name));
}

/** The sliders of a state: [key, slider], in the units that its indenter has. */
function sliders(state) {
  const whole = is_whole(state);
  return Object.keys(SECTIONS).flatMap((section) => {
    const own = SECTIONS[section].choices[state.choices[section]];
    const more = optional(state, section).filter((name) => `${section}.${name}` in state.values);
    return [...asked(state, section), ...more].map((name) => [`${section}.${name}`, whole ? { ...own[name], ...own[name].whole } : own[name]]);
  });
}

const text_of = (state, key, slider) => state.values[key] ?? slider.start;
const has_arms = (state) => state.choices.foundation === "generalized-maxwell";

/** What the relaxed foundation is given by, and every arm with it: stiffness, or modulus of a layer. */
const measure_of = (state) => (asked(state, "foundation").includes("modulus") ? "modulus" : "stiffness");

/** The sliders of arm i, which reach to either side of what the scene of the page has there. */
function arm_sliders(state, i) {
  const first = MODEL.scene.arms[i], own = measure_of(state), same = first && own === measure_of(MODEL.scene);
  const { [own]: size, relaxation_time: time } = MODEL.arm;
  return [same ? { ...size, start: first[0] } : size, first ? { ...time, start: first[1] } : time];
}

/** The first thing that is wrong with a state, or nothing. */
function wrong_in(state) {
  for (const [key, slider] of sliders(state)) {
    const told = mistake_in(text_of(state, key, slider), slider, key === "drive.velocity");
    if (told) return `${key} = ${text_of(state, key, slider)}: ${told}`;
  }
  if (has_arms(state)) {
    const [size, time] = arm_sliders(state), times = state.arms.map((arm) => si(arm[1], time));
    for (const arm of state.arms) {
      const told = mistake_in(arm[0], size) || mistake_in(arm[1], time);
      if (told) return `foundation.arms: ${told}`;
    }
    if (new Set(times).size < times.length) return "foundation.arms: two arms have the same relaxation time";
  }
  if (measure_of(state) === "modulus" && way_of(state) === "thin" && Number(text_of(state, "foundation.poisson_ratio", MODEL.sections.foundation.choices[state.choices.foundation].poisson_ratio)) === 0.5) {
    return "foundation.poisson_ratio: no K describes a thin incompressible layer; expected below 0.5 for this indenter";
  }
  return wrong_in_measured(state.values);
}

/** What is wrong with the values of a foundation beside each other, of which each is in its range. */
function wrong_in_measured(values) {
  const value = (name) => Number(values[`foundation.${name}`] ?? NaN), pole = value("reference_temperature") - value("wlf.c_2");
  for (const kind of ["frequency", "temperature"]) {
    if (value(`highest_${kind}`) <= value(`lowest_${kind}`)) return `foundation.highest_${kind}: expected above foundation.lowest_${kind}`;
  }
  return value("temperature") <= pole ? `foundation.temperature: expected above T_ref \u2212 C\u2082 = ${short(pole)} K, the pole of the WLF law` : "";
}

/** Measured shift factors, as long as the reference temperature is theirs. */
function measured_factors(T_ref) {
  const own = MODEL.shift_factors.some(([t, log]) => log === 0 && Math.abs(t - T_ref) < MODEL.same_temperature);
  return own ? MODEL.shift_factors : [];
}

/** a_T, by which the temperature multiplies every time of the foundation; the law goes through measured factors. */
function shift_factor(v) {
  const T = v["foundation.temperature"], T_ref = v["foundation.reference_temperature"], c_1 = v["foundation.wlf.c_1"];
  if (T === undefined || T_ref === undefined) return 1;
  const law = (t) => c_1 !== undefined ? -c_1 * (t - T_ref) / (v["foundation.wlf.c_2"] + t - T_ref)
    : v["foundation.activation_energy"] / MODEL.gas_constant * (T_ref - t) / t / T_ref / Math.LN10;
  const missed = measured_factors(T_ref).map(([t, log]) => [t, log - law(t)]);
  let off = missed.length ? missed[T < missed[0][0] ? 0 : missed.length - 1][1] : 0;
  for (let k = 1; k < missed.length; k++) {
    const [[a, p], [b, q]] = [missed[k - 1], missed[k]];
    if (a <= T && T <= b) off = p + (q - p) * (T - a) / (b - a);
  }
  return 10 ** (law(T) + off);
}

/** Where the stiffness of a layer is taken from: its contact at rest, where that is known. */
function way_of(state) {
  const { indenter } = state.choices, own = sliders(state).filter(([key]) => key.startsWith("indenter.radius"));
  const [radius, across] = own.map(([key, slider]) => si(text_of(state, key, slider), slider));
  const known = MODEL.rest.shapes.includes(indenter) && (across === undefined || across === radius);
  return MODEL.scene.thin || !known ? "thin" : "rest";
}

/** The scene in SI, as the solvers take it. */
function scene_of(state) {
  const v = {};
  for (const [key, slider] of sliders(state)) v[key] = si(text_of(state, key, slider), slider);
  const { indenter, foundation, support } = state.choices, radius = v["indenter.radius"], across = v["indenter.radius_across"];
  const shape = {
    "power-law": [1, v["indenter.length"], v["indenter.exponent"]], wedge: [v["indenter.inclination"], 1, 1],
  }[indenter] || [1, radius, 2];
  const nu = v["foundation.poisson_ratio"], h = v["foundation.thickness"], a_T = shift_factor(v);
  const load = v["support.load"], mass = v["support.mass"] ?? load / v["support.gravity"];
  const stretch = across === undefined ? 1 : Math.sqrt(across / radius), E = v["foundation.modulus"];
  const layer = h === undefined ? undefined : { line: !is_whole(state), R: radius, E, H: h, nu, way: way_of(state) };
  if (layer) layer.known = indenter === "parabola" || (indenter === "sphere" && stretch === 1);
  const K = !layer ? v["foundation.stiffness"]
    : layer.way === "rest" ? rest_stiffness(layer, support === "fixed" ? v["support.depth"] : undefined, load ?? mass * v["support.gravity"])
      : E * (1 - nu) / ((1 + nu) * (1 - 2 * nu)) / h;
  const stiffness = (x) => (layer ? x * (K / E) : x);
  const scene = {
    indenter, shape, stretch, K, tau: v["foundation.retardation_time"] * a_T, a_T,
    measured: Object.fromEntries(Object.entries(v).filter(([key]) => key.startsWith("foundation.")).map(([key, x]) => [parted(key)[1], x])),
    kelvin_voigt: foundation === "kelvin-voigt", V: v["drive.velocity"], duration: v["run.duration"], support,
  };
  if (layer) scene.layer = layer;
  if (foundation === "fractional-kelvin-voigt") scene.order = v["foundation.order"];
  if (has_arms(state)) {
    const [size, time] = arm_sliders(state);
    scene.arms = state.arms.map(([k, t]) => [stiffness(si(k, size)), si(t, time) * a_T]);
    scene.damping = (v["foundation.damping"] ?? 0) * a_T;
  }
  if (support === "fixed") scene.depth = v["support.depth"];
  else {
    scene.mass = mass;
    scene.weight = load ?? scene.mass * v["support.gravity"];
    scene.spring = v["support.stiffness"] ?? 0;
  }
  if (v["drive.stiffness"] !== undefined) {
    scene.drive = { stiffness: v["drive.stiffness"], damping: v["drive.damping"], mass: v["drive.mass"] ?? scene.mass };
  }
  return scene;
}

/** The unit of forces that is shown, and the factor to it. */
const force_units = (scene) => (scene.indenter === "sphere" ? ["N", 1] : ["N/mm", 1e-3]);

const quoted = (text, unit) => (unit ? `"${text} ${unit}"` : text);
const listed = (texts) => `[${texts.join(", ")}]`;

/** Sections of a state: its name, and pairs of key and written value. */
function written(state) {
  const tables = {};
  for (const [key, slider] of sliders(state)) {
    const [section, name] = parted(key), [outer, inner] = name.split("."), text = quoted(text_of(state, key, slider), slider.unit);
    const own = (tables[section] ||= {});
    if (inner) (own[outer] ||= []).push(text); else own[name] = text;
  }
  if (measure_of(state) === "modulus" && way_of(state) === "thin") tables.foundation.stiffness_from = '"thin"';
  const factors = tables.foundation.reference_temperature ? measured_factors(Number(state.values["foundation.reference_temperature"])) : [];
  if (factors.length) tables.foundation.shift_factors = factors.map(([t, log]) => listed([quoted(t, "K"), log]));
  const units = arm_sliders(state).map((slider) => slider.unit);
  if (has_arms(state)) tables.foundation.arms = state.arms.map((arm) => listed(arm.map((text, k) => quoted(text, units[k]))));
  return Object.entries(tables).map(([section, own]) => [
    section, Object.entries(own).map(([name, value]) => [name, Array.isArray(value) ? listed(value) : value]),
  ]);
}

function as_toml(state) {
  return written(state).map(([section, pairs]) => {
    const chooser = SECTIONS[section].chooser ? [`${SECTIONS[section].chooser} = "${state.choices[section]}"`] : [];
    return [`[${section}]`, ...chooser, ...pairs.map(([name, value]) => `${name} = ${value}`), ""].join("\n");
  }).join("\n");
}

function as_python(state) {
  const lines = written(state).map(([section, pairs]) => {
    const name = SECTIONS[section].classes[state.choices[section]];
    return `    ${section}=kv.${name}(${pairs.map(([key, value]) => `${key}=${value}`).join(", ")}),`;
  });
  return ["import kvtheory as kv", "", "scene = kv.Scene(", ...lines, ")", "print(kv.steady(scene))", ""].join("\n");
}

/** The state as the part of an address after #: what differs from the scene that the page was made for. */
function as_hash(state) {
  const first = original(), parts = new URLSearchParams();
  for (const [section, choice] of Object.entries(state.choices)) {
    if (choice !== first.choices[section]) parts.set(section, choice);
  }
  for (const [key, text] of Object.entries(state.values)) {
    if (text !== first.values[key]) parts.set(key, text);
  }
  const gone = Object.keys(first.values).filter((key) => !(key in state.values));
  if (gone.length) parts.set("without", gone.join(" "));
  if (JSON.stringify(state.arms) !== JSON.stringify(first.arms)) parts.set("arms", state.arms.map((a) => a.join("_")).join(" "));
  return parts.toString();
}

/** The state that an address holds; what it does not know is left out. */
function from_hash(hash) {
  const state = original(), parts = new URLSearchParams(hash.replace(/^#/, ""));
  for (const section of Object.keys(SECTIONS)) {
    if (parts.get(section) in SECTIONS[section].choices) state.choices[section] = parts.get(section);
  }
  for (const key of (parts.get("without") || "").split(" ")) delete state.values[key];
  for (const [key, text] of parts) {
    const [section, name] = parted(key), choices = SECTIONS[section]?.choices || {};
    const slider = choices[state.choices[section]]?.[name] || Object.values(choices).find((own) => name in own)?.[name];
    const unit = slider && is_whole(state) ? { ...slider, ...slider.whole } : slider;
    const [value] = slider ? understood(text, unit, key === "drive.velocity") : [];
    if (value) state.values[key] = value;
  }
  const arms = (parts.get("arms") || "").split(" ").map((arm) => arm.split("_")).filter((arm) => arm.length === 2);
  if (arms.length) state.arms = arms;
  return allowed(state);
}

/** The state with a foundation that is solved under its indenter, and a mass on the spring of its drive. */
function allowed(state) {
  const { indenter, foundation, support } = state.choices;
  const fits = (pair) => pair[0] === indenter && pair[1] === foundation;
  if (!MODEL.allowed.some(fits)) state.choices.indenter = MODEL.allowed.find((pair) => pair[1] === foundation)[0];
  if (support === "fixed" && "drive.stiffness" in state.values) {
    state.values["drive.damping"] ??= "0";
    state.values["drive.mass"] ??= SECTIONS.drive.choices.drive.mass.start;
  }
  return state;
}

const SUPERSCRIPTS = "\u207b\u2070\u00b9\u00b2\u00b3\u2074\u2075\u2076\u2077\u2078\u2079";

/** A number with four digits, and one with its unit by the size of it. */
function short(x, digits = 4) {
  if (!Number.isFinite(x)) return "\u2013";
  if (x === 0) return "0";
  const size = Math.abs(x);
  if (size >= 1e-3 && size < 1e5) return String(Number(x.toPrecision(digits)));
  const [digit, power] = x.toExponential(digits - 1).split("e");
  const raised = String(Number(power)).replace(/./g, (c) => SUPERSCRIPTS["-0123456789".indexOf(c)]);
  return `${Number(digit)}\u00b710${raised}`;
}
