// The contact under the indenter: pressure, free surface, and the footprint of a ball.

/** Height of the indenter; beyond the sides of a circle there is none. */
function height_of({ indenter, shape: [slope, L, n] }, x) {
  if (indenter === "circle") return Math.abs(x) <= L ? circle_height(L, x) : Infinity;
  return slope * L / n * (Math.abs(x) / L) ** n;
}

/** u behind the trailing edge at `away`, distances behind it, where no pressure acts: steps for a picture. */
function relaxed(scene, state, away, touched) {
  const u = Math.max(0, -touched.at(-1)[1]);
  if (scene.kelvin_voigt) return away.map((x) => u * Math.exp(-x / state.retardation_length));
  return state.borne ? relaxed_arms(scene, state, u, away) : relaxed_springpot(scene, state, away, touched);
}

/** On a Prony series, by implicit Euler's method. */
function relaxed_arms(scene, state, u, away) {
  const arms = state.borne.map(([stiffness, length, stress]) => ({ stiffness, length, stress }));
  let before = 0, now = u;
  return away.map((x) => {
    const h = x - before;
    const damped = Math.abs(scene.V) * scene.damping / h;
    let held = -damped * now, stiff = scene.K + damped;
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

/** On a springpot, which remembers all of the contact: u + (l^alpha/Gamma(1 - alpha)) int u' s^(-alpha) ds = 0. */
function relaxed_springpot(scene, state, away, touched) {
  const nu = 1 - scene.order, scale = state.retardation_length ** scene.order * rgamma1(nu), edge = touched.at(-1)[0];
  const places = touched.map(([x]) => x), u = touched.map(([, z]) => Math.max(0, -z)), first = places.length;
  for (const distance of away) {
    const x = edge + distance, reach = [...places.map((each) => (x - each) ** nu), 0];
    let past = 0;
    for (let k = 1; k < places.length; k++) past += (u[k] - u[k - 1]) / (places[k] - places[k - 1]) * (reach[k - 1] - reach[k]);
    const own = scale * reach[places.length - 1] / (x - places.at(-1));
    u.push((own * u.at(-1) - scale * past) / (1 + own));
    places.push(x);
  }
  return u.slice(first);
}

/** Pressure at x of the contact, in Pa. */
function pressure_at(scene, state, x) {
  const a = state.half_length;
  if (state.pressure) return state.pressure(x + a);
  const n = scene.shape[2], y = Math.abs(x) / a;
  return Math.max(0, scene.K * state.depth * pressure_behind(n, x < 0 ? -state.l : state.l, y));
}

/** Surface, contact and indenter as points in m, for V > 0; of a ball in its middle plane. */
function contact_shapes(scene, state) {
  const a = state.half_length, edge = Math.abs(state.trailing_edge), left = -1.6 * a, right = 2.6 * a;
  const under = (x) => height_of(scene, x) - state.depth;
  const inside = Array.from({ length: 121 }, (_, k) => -a + (a + edge) * k / 120);
  const away = Array.from({ length: 80 }, (_, k) => (right - edge) * ((k + 1) / 80) ** 2);
  const touched = inside.map((x) => [x, under(x)]);
  const free = state.retardation_length > 0 ? relaxed(scene, state, away, touched) : away.map(() => 0);
  const behind = away.map((x, k) => [edge + x, -free[k]]);
  const profile = Array.from({ length: 161 }, (_, k) => left + (right - left) * k / 160);
  return {
    ends: [left, right], edges: [-a, edge], touched,
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
    const base = bottom - Math.min(0.11 * tall, Math.max(0.045 * tall, 1.2 * state.depth * per_length)), strip = top + 0.88 * tall;
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
  const where = scene.indenter === "sphere" ? ", in the middle plane of the ball" : "";
  const moved = `The foundation moves to the ${side > 0 ? "right" : "left"} under the indenter`;
  document.getElementById("contact-note").textContent = `${moved}; it is touched along the thick line${where}.`;
}

/** The footprint of a ball from above, to scale, beside that at rest. */
function draw_footprint(scene, state) {
  const card = document.getElementById("footprint-card");
  card.hidden = scene.indenter !== "sphere";
  if (card.hidden) return;
  const side = scene.V < 0 ? -1 : 1, half = footprint(scene, state), { depth, half_length } = state;
  const wide = half_length * scene.stretch, around = Array.from({ length: 121 }, (_, k) => Math.PI * k / 60);
  show("footprint", ([left, top, right, bottom]) => {
    const middle = (left + right) / 2, centre = (top + bottom) / 2;
    const per_length = Math.min((right - left) / (2.3 * half_length), (bottom - top) / (2.3 * wide)) * 1e-3;  // per mm
    const x = scale(-(middle - left) / per_length, (right - middle) / per_length, left, right);
    const y = scale(-(bottom - centre) / per_length, (centre - top) / per_length, bottom, top);
    const at = ([u, v]) => [x.at(side * u * 1e3), y.at(v * 1e3)];
    const outline = [
      ...half.map(([v, front]) => [front, v]), ...[...half].reverse().map(([v, , back]) => [back, v]),
      ...half.map(([v, , back]) => [back, -v]), ...[...half].reverse().map(([v, front]) => [front, -v]),
    ];
    return frame(x, y, [left, top, right, bottom], "x [mm]", "y [mm]")
      + line(around.map((t) => at([half_length * Math.cos(t), wide * Math.sin(t)])), "critical")
      + `<path class="pressure" d="${path(outline.map(at))}Z"/>`;
  }, "The footprint of the ball from above");
  document.getElementById("footprint-legend").innerHTML = swatch("pressure", "contact, to scale")
    + swatch("critical", `at rest at this depth, ${short(depth * 1e3)} mm`);
}
