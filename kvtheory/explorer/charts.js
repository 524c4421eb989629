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
const upright = (y, text) => words(14, y, text, `class="title" text-anchor="middle" transform="rotate(-90 14 ${y.toFixed(1)})"`);

/** Draw into a box, to which what is drawn may be clipped. */
function show(id, draw, name) {
  const place = document.getElementById(id), width = Math.max(260, place.clientWidth), height = Number(place.dataset.height);
  const box = [MARGIN.left, MARGIN.top, width - MARGIN.right, height - MARGIN.bottom], [left, top, right, bottom] = box;
  const clip = `<clipPath id="${id}-clip"><rect x="${left}" y="${top}" width="${right - left}" height="${bottom - top}"/></clipPath>`;
  const drawn = draw(box, `clip-path="url(#${id}-clip)"`);
  place.innerHTML = `<svg viewBox="0 0 ${width} ${height}" role="img" aria-label="${name}">${clip}${drawn}</svg>`;
}

const swatch = (kind, text) => `<span><svg width="26" height="10" aria-hidden="true">${line([[0, 5], [26, 5]], kind)}</svg>${text}</span>`;
const dot = (kind, text) => `<span><svg width="14" height="14" aria-hidden="true">${mark(7, 7, kind)}</svg>${text}</span>`;
const mark = (x, y, kind) => (kind === "top"
  ? `<path class="top" d="M${x} ${y - 7}l6 7l-6 7l-6 -7z"/>` : `<circle class="present" cx="${x}" cy="${y}" r="6"/>`);

const POINTS = 120, SPAN = 3;

/** What the curve of friction over velocity is made of: found anew only when more than V has changed. */
function curve_data(scene) {
  const known = limits(scene), decades = SPAN + (scene.arms ? 1 : 0);
  const centre = known.critical || at_rest(scene).half_length / scene.tau;
  const rising = scene.kelvin_voigt && (scene.depth !== undefined || scene.shape[2] === 1);
  const speeds = Array.from({ length: POINTS + 1 }, (_, k) => centre * 10 ** (decades * (2 * k / POINTS - 1)));
  return {
    known, centre, decades, top: rising ? null : maximum(scene, centre, decades + 2),
    exact: speeds.map((V) => [V, slide({ ...scene, V }).friction_coefficient]),
  };
}

function draw_curve(scene, state, data) {
  const speed = Math.abs(scene.V), friction = Math.abs(state.friction_coefficient);
  const { known, centre, decades, top, exact } = data;
  const ends = [centre * 10 ** -decades, centre * 10 ** decades];
  const low = speed > 0 ? Math.min(ends[0], speed / 2) : ends[0], high = Math.max(ends[1], speed * 2);
  const values = exact.map(([, mu]) => mu).filter((mu) => mu > 0), most = Math.max(...values);
  const least = Math.min(...values, friction > 0 ? friction : Infinity);
  show("curve", (box, clip) => {
    const x = scale(low * 1e3, high * 1e3, box[0], box[2], true), y = scale(least / 1.3, most * 2.5, box[3], box[1], true);
    const at = ([V, mu]) => [x.at(V * 1e3), y.at(mu)];
    let drawn = "";
    for (const kind of ["low", "high"]) {
      if (known[kind]) drawn += line([low, high].map((V) => at([V, known[kind](V)])), kind);
    }
    drawn += line(exact.map(at), "exact");
    let marks = "";
    if (known.critical) {
      const V = x.at(known.critical * 1e3);
      marks += line([[V, box[1]], [V, box[3]]], "critical") + words(V + 5, box[3] - 8, "V*", 'class="title"');
    }
    if (top) marks += mark(...at([top.V, top.friction]), "top");
    if (speed > 0 && friction > 0) marks += mark(...at([speed, friction]), "present");
    return frame(x, y, box, "velocity [mm/s]", "friction coefficient") + `<g ${clip}>${drawn}</g>${marks}`;
  }, "Friction coefficient over velocity, with its asymptotes");
  const parts = [swatch("exact", "exact")];
  if (known.low) parts.push(swatch("low", "limit at low velocity"), swatch("high", "limit at high velocity"));
  if (known.critical) parts.push(swatch("critical", `V* = ${short(known.critical * 1e3)} mm/s`));
  if (top) parts.push(dot("top", `maximum ${short(top.friction)} at ${short(top.V * 1e3)} mm/s`));
  parts.push(dot("present", "this scene"));
  document.getElementById("curve-legend").innerHTML = parts.join("");
}

const height_of = ([slope, L, n], x) => slope * L / n * (Math.abs(x) / L) ** n;

/** u behind the trailing edge, at distances behind it: relaxation without pressure. */
function relaxed(scene, state, u, distances) {
  if (scene.kelvin_voigt) return distances.map((x) => u * Math.exp(-x / state.retardation_length));
  if (!state.borne) return null;
  const arms = state.borne.map(([stiffness, length, stress]) => ({ stiffness, length, stress }));
  let before = 0, now = u;
  return distances.map((x) => {  // implicit Euler's steps: a picture
    const h = x - before;
    let held = 0, stiff = scene.K;
    for (const arm of arms) {
      const rest = 1 / (1 + h / arm.length);
      held += (arm.stress - arm.stiffness * now) * rest;
      stiff += arm.stiffness * rest;
    }
    const next = -held / stiff;
    for (const arm of arms) arm.stress = (arm.stress + arm.stiffness * (next - now)) / (1 + h / arm.length);
    [before, now] = [x, next];
    return now;
  });
}

/** Pressure at x of the contact, in Pa. */
function pressure_at(scene, state, x) {
  const a = state.half_length;
  if (!scene.kelvin_voigt) return state.pressure(x + a);
  const n = scene.shape[2], y = Math.abs(x) / a;
  return Math.max(0, scene.K * state.depth * pressure_behind(n, x < 0 ? -state.l : state.l, y));
}

function draw_contact(scene, state) {
  const a = state.half_length, side = scene.V < 0 ? -1 : 1, edge = Math.abs(state.trailing_edge), delta = state.depth;
  const left = -1.6 * a, right = 2.6 * a, n = 120;
  const inside = Array.from({ length: n + 1 }, (_, k) => -a + (a + edge) * k / n);
  const away = Array.from({ length: 80 }, (_, k) => (right - edge) * ((k + 1) / 80) ** 2);
  const leaving = Math.max(0, delta - height_of(scene.shape, edge));
  const free = state.retardation_length > 0 ? relaxed(scene, state, leaving, away) : away.map(() => 0);
  const surface = [[left, 0], [-a, 0], ...inside.map((x) => [x, height_of(scene.shape, x) - delta])];
  if (free) away.forEach((x, k) => surface.push([edge + x, -free[k]]));
  const profile = Array.from({ length: 161 }, (_, k) => left + (right - left) * k / 160);
  show("contact", (box, clip) => {
    const tall = box[3] - box[1], first = [box[0], box[1], box[2], box[1] + 0.42 * tall];
    const ends = side > 0 ? [left, right] : [-right, -left];
    const x = scale(ends[0] * 1e3, ends[1] * 1e3, box[0], box[2]), at_x = (value) => x.at(side * value * 1e3);
    const p = scale(0, state.peak_pressure * 1.12e-6, first[3], first[1]);
    const pressed = inside.map((place) => [at_x(place), p.at(pressure_at(scene, state, place) * 1e-6)]);
    let drawn = frame(x, p, first, "", "pressure [MPa]");
    drawn += `<path class="pressure" d="${path([[at_x(-a), first[3]], ...pressed, [at_x(edge), first[3]]])}"/>`;
    // Heights exaggerated
    const middle = [first[3] + 12, box[1] + 0.86 * tall], z = scale(-1.25 * delta, 1.1 * delta, middle[1], middle[0]);
    const px = (box[2] - box[0]) / (right - left), own = (middle[1] - middle[0]) / (2.35 * delta);
    const stretch = own / px;
    const ground = (to, bottom) => path([...surface.map(([u, v]) => [at_x(u), to(v)]), [at_x(surface.at(-1)[0]), bottom], [at_x(left), bottom]]);
    const body = (to, top) => path([...profile.map((u) => [at_x(u), Math.max(top, to(height_of(scene.shape, u) - delta))]), [at_x(right), top], [at_x(left), top]]);
    drawn += `<g ${clip}><path class="ground" d="${ground((v) => z.at(v), middle[1])}"/><path class="indenter" d="${body((v) => z.at(v), middle[0])}"/>`;
    drawn += line(surface.map(([u, v]) => [at_x(u), z.at(v)]), "surface");
    drawn += line(inside.map((u) => [at_x(u), z.at(height_of(scene.shape, u) - delta)]), "touch") + "</g>";
    for (const [place, name] of [[-a, "x<tspan dy='3' font-size='9'>LE</tspan>"], [edge, "x<tspan dy='3' font-size='9'>TE</tspan>"]]) {
      drawn += line([[at_x(place), first[1]], [at_x(place), middle[1]]], "edge") + words(at_x(place) + 4, first[1] + 10, name);
    }
    // To scale
    const base = box[3] - 0.045 * tall, true_z = (v) => base - v * px;
    const strip = [box[1] + 0.88 * tall, box[3]];
    drawn += `<g ${clip}><path class="ground" d="${ground(true_z, strip[1])}"/><path class="indenter" d="${body(true_z, strip[0])}"/></g>`;
    drawn += words(box[2] - 4, middle[1] - 6, `heights \u00d7 ${short(stretch, 2)}`, 'text-anchor="end"') + words(box[2] - 4, strip[1] - 5, "to scale", 'text-anchor="end"');
    for (const tick of x.ticks) drawn += words(x.at(tick), box[3] + 16, tick_text(tick), 'text-anchor="middle"');
    drawn += words((box[0] + box[2]) / 2, box[3] + 34, "x [mm]", 'class="title" text-anchor="middle"');
    return drawn + upright((middle[0] + middle[1]) / 2, "surface");
  }, "Pressure and free surface under the indenter");
  const note = free ? "" : " Behind the contact the surface of a springpot is not drawn: it needs all of its past.";
  document.getElementById("contact-note").textContent =
    `The foundation moves ${side > 0 ? "to the right" : "to the left"} under the indenter; it is touched along the thick line.${note}`;
}
