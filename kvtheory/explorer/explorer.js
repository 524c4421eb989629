// The controls, and what happens when one of them moves.

let state = from_hash(location.hash), kept = { key: "", data: null };
/** Milliseconds that the last updates took. */
const frames = [];

const escaped = (text) => String(text).replace(/[&<>"]/g, (c) => `&#${c.charCodeAt(0)};`);
const named = (name) => name.replace(/-/g, " ").replace("kelvin voigt", "Kelvin\u2013Voigt").replace("maxwell", "Maxwell");

const pretty = (unit) => unit.replace(/\^(\d)/g, (_, k) => "\u00b9\u00b2\u00b3"[k - 1]).replace("*", "\u00b7");

/** Ends of a slider, and where a value stands between them; logarithmic but for a few. */
function reach(slider) {
  if (slider.linear) return [...slider.linear, (x) => x, (x) => x];
  const start = Math.log10(Math.abs(Number(slider.start)) || 1);
  return [start - slider.decades, start + slider.decades, (x) => Math.log10(Math.abs(x)), (x) => 10 ** x];
}

function slider_html(key, slider, text, label) {
  const [low, high, place] = reach(slider), at = place(Number(text));
  const shown = Number.isFinite(at) ? Math.min(high, Math.max(low, at)) : low;
  return `<div class="slider"><label for="${key}" title="${escaped(slider.doc)}">${escaped(label)}</label>`
    + `<span class="value"><input type="text" inputmode="decimal" data-key="${key}" value="${escaped(text)}" aria-label="${escaped(label)}" aria-describedby="${key}-mistake">`
    + `<span class="unit">${pretty(slider.unit)}</span></span><p class="mistake" id="${key}-mistake" role="alert" hidden></p>`
    + `<input type="range" id="${key}" data-key="${key}" min="${low}" max="${high}" step="any" value="${shown}"`
    + ` aria-valuetext="${escaped(text)} ${slider.unit}" title="${escaped(slider.doc)}"></div>`;
}

function choice_html(section) {
  const { chooser, choices } = SECTIONS[section], here = state.choices[section];
  if (!chooser) return "";
  const fits = (choice) => section !== "indenter" || MODEL.allowed.some(([shape, kind]) => shape === choice && kind === state.choices.foundation);
  const options = Object.keys(choices).map((choice) => {
    const chosen = choice === here ? " selected" : "", [off, why] = fits(choice) ? ["", ""] : [" disabled", " (Kelvin\u2013Voigt only)"];
    return `<option value="${choice}"${chosen}${off}>${named(choice)}${why}</option>`;
  });
  return `<select data-section="${section}" aria-label="${section} ${chooser}">${options.join("")}</select>`;
}

function alternative_html(section) {
  const sets = SECTIONS[section].alternatives[state.choices[section]], here = String(asked(state, section));
  if (sets.length < 2) return "";
  const needs_mass = section === "drive" && state.choices.support === "fixed";
  return `<select data-set="${section}" aria-label="${section}: what is given">${sets.map(({ told, names }, k) => {
    const off = needs_mass && names.includes("stiffness") && !names.includes("mass");
    return `<option value="${k}"${String(names) === here ? " selected" : ""}${off ? " disabled" : ""}>${told}</option>`;
  }).join("")}</select>`;
}

function arms_html() {
  const rows = state.arms.map((arm, i) => `<div class="arm">${arm_sliders(state, i).map((slider, k) => (
    slider_html(`arms.${i}.${k}`, slider, arm[k], `arm ${i + 1}: ${[measure_of(state), "relaxation time"][k]}`))).join("")}</div>`);
  return `${rows.join("")}<div class="arms"><button type="button" data-arm="add">Add an arm</button>`
    + `<button type="button" data-arm="remove"${state.arms.length < 2 ? " disabled" : ""}>Remove the last</button></div>`;
}

/** What finds a control again after all of them were built anew. */
function address(control) {
  const name = ["section", "set", "arm", "key"].find((each) => control.dataset?.[each]);
  const kind = control.type === "range" ? "[type=range]" : "";
  return name && `${control.tagName}[data-${name}="${control.dataset[name]}"]${kind}`;
}

function build_controls() {
  const parts = {}, focused = address(document.activeElement);
  for (const [key, slider] of sliders(state)) {
    const [section, name] = parted(key), label = name.replace(/_/g, " ").replace("wlf.c ", "WLF C").replace("poisson", "Poisson\u2019s");
    (parts[section] ||= []).push(slider_html(key, slider, text_of(state, key, slider), label));
  }
  const html = ["drive", "indenter", "support", "foundation", "run"].map((section) => {
    const choosing = choice_html(section) + alternative_html(section);
    const arms = section === "foundation" && has_arms(state) ? arms_html() : "";
    const note = section === "drive" && state.note ? `<p class="note">${state.note}</p>` : "";
    return `<fieldset><legend>${section}</legend><div>${choosing}${parts[section].join("")}${arms}${note}</div></fieldset>`;
  });
  document.getElementById("controls").innerHTML = html.join("");
  if (focused) document.querySelector(focused)?.focus();
}

function update() {
  const start = performance.now(), problem = document.getElementById("problem"), told = wrong_in(state);
  problem.hidden = !told;
  problem.textContent = told;
  if (told) return;
  const scene = scene_of(state), { V, duration, ...still } = scene, key = JSON.stringify(still), found = slide(scene);
  if (!Number.isFinite(found.friction_coefficient) || !Number.isFinite(found.load)) {
    problem.hidden = false;
    problem.textContent = scene.indenter === "circle" ? "The circle would be pressed in by more than its radius."
      : "These values leave the range of double precision.";
    return;
  }
  const anew = key !== kept.key;
  if (anew) kept = { key, data: curve_data(scene) };
  Object.assign(kept, { scene, found });
  if (!scene.arms) look(kept.data, Infinity);
  show_numbers(scene, found);
  show_layer(scene, found);
  show_measured(scene, found);
  draw_curve(scene, found, kept.data);
  draw_contact(scene, found);
  draw_footprint(scene, found);
  show_formula(scene, found);
  show_energy(found);
  show_stability(scene, found);
  follow(scene, found);
  draw_motion();
  if (anew) setTimeout(look_on, 0, kept);
  frames.push(performance.now() - start);
  if (frames.length > 500) frames.shift();
}

/** Milliseconds for which unstable speeds are looked for between two pictures. */
const SLICE = 12;

/** Find the unstable speeds between pictures, and draw the curve with them: many arms take seconds. */
function look_on(now) {
  if (now !== kept || !now.data.looking) return;
  look(now.data, performance.now() + SLICE);
  if (now.data.looking) setTimeout(look_on, 0, now); else draw_curve(now.scene, now.found, now.data);
}

let waiting = false;
/** Update once before the next picture, however often a slider moves. */
function soon() {
  if (waiting) return;
  waiting = true;
  requestAnimationFrame(() => {
    waiting = false;
    update();
    history.replaceState(null, "", `#${as_hash(state)}`);
  });
}

function set_value(key, text) {
  const [first, i, k] = key.split(".");
  if (first === "arms") state.arms[i][k] = text; else state.values[key] = text;
}

function slider_of(key) {
  const [first, rest] = parted(key), [i, k] = rest.split(".");
  return first === "arms" ? arm_sliders(state, i)[k] : sliders(state).find(([name]) => name === key)[1];
}

/** The field and the slider of a quantity, and the text about a mistake. */
function parts_of(control) {
  const pair = control.closest(".slider");
  return ['input[type="text"]', 'input[type="range"]', ".mistake"].map((part) => pair.querySelector(part));
}

/** Take a value over, and show it in field and slider. */
function accept(control, text) {
  const { key } = control.dataset, slider = slider_of(key), [low, high, place] = reach(slider);
  const [box, range, told] = parts_of(control), at = place(Number(text));
  box.value = text;
  box.removeAttribute("aria-invalid");
  told.hidden = true;
  if (control === box) range.value = String(Number.isFinite(at) ? Math.min(high, Math.max(low, at)) : low);
  range.setAttribute("aria-valuetext", `${text} ${slider.unit}`);
  set_value(key, text);
  soon();
}

function moved(event) {
  if (event.target.type !== "range") return;
  const [, , , value] = reach(slider_of(event.target.dataset.key)), sign = Number(parts_of(event.target)[0].value) < 0 ? -1 : 1;
  accept(event.target, String(Number((sign * value(Number(event.target.value))).toPrecision(3))));
}

/** Understand what was typed, or say what is wrong with it; then the scene stays as it was. */
function typed(box) {
  const { key } = box.dataset, [text, mistake] = understood(box.value, slider_of(key), key === "drive.velocity");
  if (!mistake) {
    accept(box, text);
    return;
  }
  const told = parts_of(box)[2];
  box.setAttribute("aria-invalid", "true");
  told.textContent = `Not taken: ${mistake}.`;
  told.hidden = false;
}

function chosen(event) {
  const { section, set } = event.target.dataset;
  if (event.target.type === "text") typed(event.target);
  const [of, at] = section ? [section, 0] : [set, Number(event.target.value)];
  if (!of) return;
  const relaxed = (key = `foundation.${measure_of(state)}`) => text_of(state, key, slider_of(key));
  const [measure, before] = [measure_of(state), relaxed()];
  if (section) state.choices[section] = event.target.value;
  const own = SECTIONS[of].choices[state.choices[of]], wanted = sets_of(state, of)[at], more = optional(state, of);
  for (const key of Object.keys(state.values)) {
    const [part, name] = parted(key);
    if (part === of && ![...wanted, ...more].includes(name)) delete state.values[key];
  }
  for (const name of wanted) state.values[`${of}.${name}`] ??= own[name].start;
  if (measure_of(state) !== measure) {  // arms keep their ratio to what they are given beside
    for (const arm of state.arms) arm[0] = String(Number((arm[0] * (relaxed() / before)).toPrecision(6)));
  }
  allowed(state);
  build_controls();
  soon();
}

function arm_pressed(event) {
  const { arm } = event.target.dataset;
  if (arm === "add") state.arms.push([state.arms.at(-1)[0], String(Number((Number(state.arms.at(-1)[1]) * 10).toPrecision(3)))]);
  if (arm === "remove") state.arms.pop();
  if (arm) {
    build_controls();
    soon();
  }
}

async function copy(text, told) {
  const area = document.getElementById("copied"), said = document.getElementById("said");
  area.hidden = false;
  area.value = text;
  area.select();
  try {
    await navigator.clipboard.writeText(text);
    said.textContent = `${told} copied.`;
  } catch {
    said.textContent = document.execCommand("copy") ? `${told} copied.` : `${told}: select and copy it below.`;
  }
}

function wire() {
  const form = document.querySelector("form");
  form.addEventListener("input", moved);
  form.addEventListener("change", chosen);
  form.addEventListener("click", arm_pressed);
  form.addEventListener("submit", (event) => event.preventDefault());
  document.getElementById("copy-toml").addEventListener("click", () => copy(as_toml(state), "Scene"));
  document.getElementById("copy-python").addEventListener("click", () => copy(as_python(state), "Script"));
  document.getElementById("copy-link").addEventListener("click", () => copy(`${location.href.split("#")[0]}#${as_hash(state)}`, "Link"));
  document.getElementById("reset").addEventListener("click", () => restore(""));
  window.addEventListener("hashchange", () => restore(location.hash));
  let width = innerWidth;
  window.addEventListener("resize", () => {
    if (innerWidth !== width) soon();
    width = innerWidth;
  });
  wire_player();
}

function restore(hash) {
  state = from_hash(hash);
  build_controls();
  soon();
}

build_controls();
wire();
update();
