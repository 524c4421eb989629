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
  const place = document.getElementById(id), width = Math.max(260, place.clientWidth), height = Number(place.dataset.height);
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

/** Surface, contact and indenter as points in m, for V > 0; behind a springpot nothing. */
function contact_shapes(scene, state) {
  const a = state.half_length, edge = Math.abs(state.trailing_edge), left = -1.6 * a, right = 2.6 * a;
  const under = (x) => height_of(scene.shape, x) - state.depth;
  const inside = Array.from({ length: 121 }, (_, k) => -a + (a + edge) * k / 120);
  const away = Array.from({ length: 80 }, (_, k) => (right - edge) * ((k + 1) / 80) ** 2);
  const free = state.retardation_length > 0
    ? relaxed(scene, state, Math.max(0, -under(edge)), away) : away.map(() => 0);
  const behind = free ? away.map((x, k) => [edge + x, -free[k]]) : [];
  const touched = inside.map((x) => [x, under(x)]);
  const profile = Array.from({ length: 161 }, (_, k) => left + (right - left) * k / 160);
  return {
    ends: [left, right], edges: [-a, edge], touched, known: free !== null,
    surface: [[left, 0], [-a, 0], ...touched, ...behind], profile: profile.map((x) => [x, under(x)]),
  };
}

/** Ground and indenter between a top and a bottom, with heights as `to` maps them to pixels. */
function draw_bodies(shapes, at_x, to, top, bottom) {
  const { surface, profile, ends } = shapes, at = ([x, z]) => [at_x(x), Math.max(top, to(z))];
  const ground = [...surface.map(at), [at_x(surface.at(-1)[0]), bottom], [at_x(ends[0]), bottom]];
  const indenter = [...profile.map(at), [at_x(ends[1]), top], [at_x(ends[0]), top]];
  return `<path class="ground" d="${path(ground)}"/><path class="indenter" d="${path(indenter)}"/>`;
}

/** The pressure over the contact, and both edges down to `bottom`. */
function draw_pressure(scene, state, shapes, box, x, at_x, bottom) {
  const p = scale(0, state.peak_pressure * 1.12e-6, box[3], box[1]), [front, back] = shapes.edges;
  const pressed = shapes.touched.map(([place]) => [at_x(place), p.at(pressure_at(scene, state, place) * 1e-6)]);
  const area = path([[at_x(front), box[3]], ...pressed, [at_x(back), box[3]]]);
  let drawn = frame(x, p, box, "", "pressure [MPa]") + `<path class="pressure" d="${area}"/>`;
  for (const [place, name] of [[front, "LE"], [back, "TE"]]) {
    drawn += line([[at_x(place), box[1]], [at_x(place), bottom]], "edge");
    drawn += words(at_x(place) + 4, box[1] + 10, `x<tspan dy="3" font-size="9">${name}</tspan>`);
  }
  return drawn;
}

function draw_contact(scene, state) {
  const side = scene.V < 0 ? -1 : 1, shapes = contact_shapes(scene, state), [left, right] = shapes.ends;
  show("contact", (box, clip) => {
    const [start, top, end, bottom] = box, tall = bottom - top, split = top + 0.42 * tall;
    const ends = side > 0 ? [left, right] : [-right, -left];
    const x = scale(ends[0] * 1e3, ends[1] * 1e3, start, end), at_x = (place) => x.at(side * place * 1e3);
    const per_length = (end - start) / (right - left), middle = [split + 12, top + 0.86 * tall];
    const z = scale(-1.25 * state.depth, 1.1 * state.depth, middle[1], middle[0]);
    const stretch = (middle[1] - middle[0]) / (2.35 * state.depth) / per_length;
    const base = bottom - 0.045 * tall, strip = top + 0.88 * tall;
    const at = ([place, height]) => [at_x(place), z.at(height)];
    let drawn = draw_pressure(scene, state, shapes, [start, top, end, split], x, at_x, middle[1]);
    drawn += `<g ${clip}>${draw_bodies(shapes, at_x, z.at, ...middle)}`;
    drawn += line(shapes.surface.map(at), "surface") + line(shapes.touched.map(at), "touch");
    drawn += `${draw_bodies(shapes, at_x, (height) => base - height * per_length, strip, bottom)}</g>`;
    drawn += words(end - 4, middle[1] - 6, `heights \u00d7 ${short(stretch, 2)}`, 'text-anchor="end"');
    drawn += words(end - 4, bottom - 5, "to scale", 'text-anchor="end"');
    for (const tick of x.ticks) drawn += words(x.at(tick), bottom + 16, tick_text(tick), 'text-anchor="middle"');
    drawn += words((start + end) / 2, bottom + 34, "x [mm]", 'class="title" text-anchor="middle"');
    return drawn + upright((middle[0] + middle[1]) / 2, "surface");
  }, "Pressure and free surface under the indenter");
  const moved = `The foundation moves to the ${side > 0 ? "right" : "left"} under the indenter`;
  document.getElementById("contact-note").textContent = `${moved}; it is touched along the thick line.${
    shapes.known ? "" : " Behind the contact the surface of a springpot is not drawn: it needs all of its past."}`;
}
