// Pictures as SVG: lines over two axes, and the contact under the indenter.

const MARGIN = { left: 62, right: 14, top: 12, bottom: 40 };

/** A path through points; where one is not finite, the line is interrupted. */
function path(points) {
  let text = "", pen = "M";
  for (const [x, y] of points) {
    if (!Number.isFinite(x) || !Number.isFinite(y)) {
      pen = "M";
      continue;
    }
    text += `${pen}${x.toFixed(1)} ${y.toFixed(1)}`;
    pen = "L";
  }
  return text;
}

const line = (points, kind) => `<path class="${kind}" d="${path(points)}"/>`;
const words = (x, y, text, how = "") => `<text x="${x.toFixed(1)}" y="${y.toFixed(1)}" ${how}>${text}</text>`;

/** A scale from values to pixels, with its ticks. */
function scale(low, high, from, to, log) {
  const f = log ? Math.log10 : (x) => x, a = f(low), b = f(high);
  const at = (x) => from + (f(x) - a) / (b - a) * (to - from);
  const ticks = [], most = Math.max(2, Math.abs(to - from) / 55);
  if (log) {
    const step = Math.max(1, Math.ceil((b - a) / most));
    for (let k = Math.ceil(a - 1e-9); k <= b + 1e-9; k++) if (k % step === 0) ticks.push(10 ** k);
  } else {
    const rough = (b - a) / most, power = 10 ** Math.floor(Math.log10(rough));
    const step = [1, 2, 5, 10].map((k) => k * power).find((k) => k >= rough) || power;
    for (let k = Math.ceil(a / step); k * step <= b * (1 + 1e-12) + 1e-300; k++) ticks.push(k * step);
  }
  return { at, ticks, low, high };
}

const tick_text = (x) => short(x, 3).replace(/^1\u00b7/, "");

/** Grid, ticks and names of two scales in a box. */
function frame(x, y, box, x_name, y_name) {
  const [left, top, right, bottom] = box;
  let drawn = "";
  for (const tick of x.ticks) {
    drawn += line([[x.at(tick), top], [x.at(tick), bottom]], "grid");
    if (x_name) drawn += words(x.at(tick), bottom + 16, tick_text(tick), 'text-anchor="middle"');
  }
  for (const tick of y.ticks) {
    drawn += line([[left, y.at(tick)], [right, y.at(tick)]], "grid");
    drawn += words(left - 6, y.at(tick) + 4, tick_text(tick), 'text-anchor="end"');
  }
  drawn += line([[left, top], [left, bottom], [right, bottom]], "axis");
  if (x_name) drawn += words((left + right) / 2, bottom + 34, x_name, 'class="title" text-anchor="middle"');
  return drawn + upright((top + bottom) / 2, y_name);
}

/** The name of a vertical axis, beside it. */
const upright = (y, text) =>
  words(14, y, text, `class="title" text-anchor="middle" transform="rotate(-90 14 ${y.toFixed(1)})"`);

/** Draw into a box, to which what is drawn may be clipped. */
function show(id, draw, name) {
  const place = document.getElementById(id), width = Math.max(260, place.clientWidth), { height: full, small } = place.dataset;
  const height = Number(small && matchMedia("(max-width: 900px) and (min-height: 480px)").matches ? small : full);
  const box = [MARGIN.left, MARGIN.top, width - MARGIN.right, height - MARGIN.bottom], [left, top, right, bottom] = box;
  const rect = `<rect x="${left}" y="${top}" width="${right - left}" height="${bottom - top}"/>`;
  const clip = `<clipPath id="${id}-clip">${rect}</clipPath>`, drawn = draw(box, `clip-path="url(#${id}-clip)"`);
  place.innerHTML = `<svg viewBox="0 0 ${width} ${height}" role="img" aria-label="${name}">${clip}${drawn}</svg>`;
}

const sample = (width, height, drawn, text) =>
  `<span><svg width="${width}" height="${height}" aria-hidden="true">${drawn}</svg>${text}</span>`;
const swatch = (kind, text) => sample(26, 10, line([[0, 5], [26, 5]], kind), text);
const dot = (kind, text) => sample(14, 14, mark(7, 7, kind), text);
const mark = (x, y, kind) => (kind === "top"
  ? `<path class="top" d="M${x} ${y - 7}l6 7l-6 7l-6 -7z"/>` : `<circle class="present" cx="${x}" cy="${y}" r="6"/>`);

const PER_DECADE = 14, SPAN = 3;

/** What the curve of friction over velocity is made of: found anew only when more than V has changed. */
function curve_data(scene) {
  const known = limits(scene), length = at_rest(scene).half_length || scene.shape[1];
  const centre = known.critical || length / mean_time(scene);
  const far = (scene.arms || []).map(([, time]) => Math.abs(Math.log10(length / time / centre)));
  const decades = Math.max(SPAN, ...far.map((each) => each + 1)), POINTS = Math.ceil(2 * PER_DECADE * decades);
  const rising = scene.kelvin_voigt && (scene.depth !== undefined || scene.shape[2] === 1);
  const speeds = Array.from({ length: POINTS + 1 }, (_, k) => centre * 10 ** (decades * (2 * k / POINTS - 1)));
  const drawn = { ...scene, rough: true }, states = speeds.map((V) => slide({ ...drawn, V }));
  const exact = states.map((state, k) => [speeds[k], state.friction_coefficient]);
  const data = { known, layer: layer_limits(scene), centre, decades, tops: rising ? [] : maxima(drawn, exact), exact, unstable: speeds.map(() => false) };
  return Object.assign(data, { looking: true, search: find_unstable(scene, speeds, states, data) });
}

/** Look for unstable speeds until an instant. */
function look(data, until) {
  while (data.looking && performance.now() < until) data.looking = !data.search.next().done;
}

function draw_curve(scene, state, data) {
  const speed = Math.abs(scene.V), friction = Math.abs(state.friction_coefficient);
  const { known, layer, centre, decades, tops, exact, unstable, from, looking } = data;
  const ends = [centre * 10 ** -decades, centre * 10 ** decades];
  const low = speed > 0 ? Math.min(ends[0], speed / 2) : ends[0], high = Math.max(ends[1], speed * 2);
  // A scene far from the curve that was found: up to it a few points are enough, near a limit.
  const beyond = (from, to) => Array.from({ length: from < to ? 9 : 0 }, (_, k) => from * (to / from) ** (k / 8))
    .map((V) => [V, slide({ ...scene, rough: true, V }).friction_coefficient]);
  const whole = [...beyond(low, ends[0]), ...exact, ...beyond(ends[1], high)];
  const values = exact.map(([, mu]) => mu).filter((mu) => mu > 0), most = Math.max(...values);
  const least = Math.min(...values, friction > 0 ? friction : Infinity);
  show("curve", (box, clip) => {
    const x = scale(low * 1e3, high * 1e3, box[0], box[2], true), y = scale(least / 1.3, most * 2.5, box[3], box[1], true);
    const at = ([V, mu]) => [x.at(V * 1e3), y.at(mu)];
    let drawn = "";
    for (const kind of ["low", "high"]) {
      if (known[kind]) drawn += line([low, high].map((V) => at([V, known[kind](V)])), kind);
      if (layer[kind]) drawn += line([low, high].map((V) => at([V, layer[kind](V)])), "layer");
    }
    drawn += line(exact.map((point, k) => (unstable[k] ? at(point) : [NaN, NaN])), "unstable") + line(whole.map(at), "exact");
    let marks = "";
    if (known.critical) {
      const V = x.at(known.critical * 1e3);
      marks += line([[V, box[1]], [V, box[3]]], "critical") + words(V + 5, box[3] - 8, "V*", 'class="title"');
    }
    for (const top of tops) marks += mark(...at([top.V, top.friction]), "top");
    if (speed > 0 && friction > 0) marks += mark(...at([speed, friction]), "present");
    const name = box[3] - box[1] > 150 ? "friction coefficient" : "\u03bc";
    return frame(x, y, box, "velocity [mm/s]", name) + `<g ${clip}>${drawn}</g>${marks}`;
  }, "Friction coefficient over velocity, with its asymptotes");
  const parts = [swatch("exact", "exact")];
  const onset = looking ? ": looking for it \u2026" : from && `, from ${short(from * 1e3)} mm/s`;
  if (unstable.some(Boolean) || (looking && scene.drive)) parts.push(swatch("unstable", `unstable on this spring${onset || ""}`));
  if (known.low) parts.push(swatch("low", "limit at low velocity"), swatch("high", "limit at high velocity"));
  if (layer.low) parts.push(swatch("layer", "limits on the layer itself"));
  if (known.critical) parts.push(swatch("critical", `V* = ${short(known.critical * 1e3)} mm/s`));
  tops.forEach((top, k) => parts.push(dot("top", `${k ? "another" : "maximum"} ${short(top.friction)} at ${short(top.V * 1e3)} mm/s`)));
  parts.push(dot("present", "this scene"));
  document.getElementById("curve-legend").innerHTML = parts.join("");
  const { offsetHeight } = document.getElementById("curve-card");
  document.documentElement.style.setProperty("--curve", `${offsetHeight}px`);  // on a phone the sliders begin below it
}
