// The start from rest as an animation: the contact, and the forces so far.

const player = { run: null, playing: false, share: 0, last: 0 };
/** Milliseconds that the animation takes; its time is logarithmic, as the start has two time scales. */
const LASTS = 6000;

/** Why the start is not in closed form; nothing if it is. */
function lacks_start(scene) {
  const { indenter, depth, drive } = scene, further = (command) => ` <code>kvtheory ${command}</code> follows it.`;
  if (scene.V === 0) return "Without a velocity nothing starts.";
  if (!scene.kelvin_voigt) {
    const told = scene.arms ? further(indenter === "parabola" ? "transient" : "elements") : " Nothing here follows a springpot in time.";
    return `The start is in closed form on Kelvin\u2013Voigt elements only.${told}`;
  }
  if (drive && indenter === "sphere") return `The start of a ball is in closed form under a rigid drive only.${further("elements")}`;
  if (indenter === "sphere" && depth === undefined) {
    return `A ball that rises lifts its rim off the ground and comes down on what it left there: no closed form.${further("elements")}`;
  }
  if (["parabola", "sphere"].includes(indenter)) return "";
  return `The start is in closed form for a parabola and for a ball at a fixed depth only.${further("elements")}`;
}

/** The numbers of the motion along x on the spring of a drive; nothing under a rigid one. */
function numbers_along({ drive, tau }, rest) {
  const unit = rest.half_length ** 2 / (rest.load * rest.depth);
  return drive && { epsilon: drive.mass * unit / tau ** 2, damping: drive.damping * unit / tau, kappa: drive.stiffness * unit };
}

/** Follow the start anew; nothing where the two states do not hold. */
function follow(scene, state) {
  const note = document.getElementById("motion-note"), lacking = lacks_start(scene);
  for (const id of ["player", "motion", "motion-legend"]) document.getElementById(id).hidden = Boolean(lacking);
  player.run = null;
  if (lacking) {
    note.innerHTML = lacking;
    return;
  }
  const rest = at_rest(scene), fixed = scene.depth !== undefined;
  const number = {
    lam: Math.abs(scene.V) * scene.tau / rest.half_length, kappa: fixed ? Infinity : scene.spring * rest.depth / rest.load,
    epsilon: fixed ? 1 : scene.mass * rest.depth / (rest.load * scene.tau ** 2), along: numbers_along(scene, rest),
  };
  const { rows, why } = start_from_rest(number, scene.duration / scene.tau), whole = scene.indenter === "sphere";
  if (whole) {  // held, its strips have their edges at once
    const drag = rest.load * rest.depth / rest.half_length;
    for (const row of rows) Object.assign(row, { f_z: state.load / rest.load, f_x: Math.abs(state.friction_force) / drag });
  }
  const end = rows.at(-1).s;
  if (end === 0) {
    for (const id of ["player", "motion", "motion-legend"]) document.getElementById(id).hidden = true;
    note.textContent = `What the surface remembers counts at once: ${why}. kvtheory transient follows it.`;
    return;
  }
  const first = Math.min(end / 300, 0.1 * number.epsilon / (1 + number.lam));
  player.run = {
    rows, rest, number, end, first: Math.max(first, end * 1e-6), side: Math.sign(scene.V), tau: scene.tau,
    force: force_units(scene),
  };
  const states = number.along ? "Four states" : "Two states";
  if (fixed && !number.along) {
    const strips = whole ? ", those of every strip of the ball; the middle plane is shown" : "";
    note.textContent = `At a fixed depth the edges are at once where they stay${strips}.`;
  } else if (why) {
    note.textContent = `${states} and two edges in closed form hold up to ${short(end * scene.tau * 1e3)} ms: then ${why}, and `
      + "what the surface remembers counts. kvtheory transient goes on.";
  } else note.textContent = `${states} and two edges in closed form: no memory of the surface is needed in this run.`;
}

function draw_motion() {
  const { run } = player;
  if (!run) return;
  const { rows, rest, number, end, first, side, tau, force: [unit_of_force, factor] } = run;
  const s = first * (end / first) ** player.share, now = row_at(rows, s), ms = tau * 1e3;
  const deepest = Math.max(...rows.map((row) => row.d)), a_0 = Math.sqrt(deepest), left = -1.5 * a_0, right = 2.6 * a_0;
  const behind = surface_behind(rows, s, number.lam).filter(([x], k, all) => x >= now.r && (k === 0 || all[k - 1][0] <= x));
  const surface = [[left, 0], [now.l, 0]];
  for (let k = 0; k <= 60; k++) {
    const x = now.l + (now.r - now.l) * k / 60;
    surface.push([x, x * x - now.d]);
  }
  surface.push(...behind.map(([x, u]) => [x, -Math.max(0, u)]), [Math.max(right, behind.length ? behind.at(-1)[0] : 0), 0]);
  show("motion", (box, clip) => {
    const half = box[1] + 0.5 * (box[3] - box[1]);
    const scaled = rest.half_length * 1e3, x = scale(left, right, side > 0 ? box[0] : box[2], side > 0 ? box[2] : box[0]);
    const z = scale(-1.3 * deepest, 0.9 * deepest, half - 12, box[1]), at = ([u, v]) => [x.at(u), z.at(v)];
    const places = Array.from({ length: 81 }, (_, k) => left + (right - left) * k / 80);
    const shapes = { surface, profile: places.map((u) => [u, u * u - now.d]), ends: [left, right] };
    const touched = surface.filter(([u]) => u >= now.l && u <= now.r);
    let drawn = `<g ${clip}>${draw_bodies(shapes, x.at, z.at, box[1], half - 12)}`;
    drawn += `${line(surface.map(at), "surface")}${line(touched.map(at), "touch")}</g>`;
    drawn += words(box[2] - 4, half - 18, `${short((right - left) * scaled, 3)} mm across`, 'text-anchor="end"');
    const drag = rest.load * rest.depth / rest.half_length, forces = [["f_z", rest.load, "force"], ["f_x", drag, "drag"]];
    if (number.along) forces.push(["f_s", drag, "pull"]);
    const sampled = Array.from({ length: 161 }, (_, k) => row_at(rows, first * (end / first) ** (k / 160)));
    const all = forces.flatMap(([name, unit]) => rows.map((row) => row[name] * unit * factor));
    const t = scale(first * ms, end * ms, box[0], box[2], true), f = scale(1.08 * Math.min(0, ...all), 1.08 * Math.max(...all), box[3], half + 8);
    drawn += frame(t, f, [box[0], half + 8, box[2], box[3]], "time [ms]", `force [${unit_of_force}]`);
    for (const [name, unit, kind] of forces) {
      drawn += line(sampled.map((row) => [t.at(row.s * ms), f.at(row[name] * unit * factor)]), kind);
    }
    const told = ([name, unit, kind], what) => swatch(kind, `${what} ${short(now[name] * unit * factor)} ${unit_of_force}`);
    const depth = `<span>\u03b4 = ${short(now.d * rest.depth * 1e3)} mm</span>`;
    const speed = short((number.lam - now.w) * rest.half_length / tau * 1e3);
    document.getElementById("motion-legend").innerHTML = `<span>t = ${short(s * ms)} ms</span>${depth}`
      + told(forces[0], "normal force") + told(forces[1], "friction force")
      + (number.along ? told(forces[2], "spring force") + `<span>sliding at ${speed} mm/s</span>` : "");
    return drawn + line([[t.at(s * ms), half + 8], [t.at(s * ms), box[3]]], "cursor");
  }, "The contact during the start from rest, and the forces over time");
  document.getElementById("instant").value = String(Math.round(1000 * player.share));
}

function tick(time) {
  if (!player.playing) return;
  player.share = Math.min(1, player.share + (time - player.last) / LASTS);
  player.last = time;
  draw_motion();
  if (player.share >= 1) press(false); else requestAnimationFrame(tick);
}

/** Play or pause; from the start where the end was reached. */
function press(playing) {
  player.playing = playing;
  const button = document.getElementById("play");
  button.textContent = playing ? "Pause" : "Play";
  button.setAttribute("aria-pressed", String(playing));
  if (!playing) return;
  if (player.share >= 1) player.share = 0;
  requestAnimationFrame((time) => {
    player.last = time;
    tick(time);
  });
}

function wire_player() {
  document.getElementById("play").addEventListener("click", () => press(!player.playing));
  document.getElementById("instant").addEventListener("input", (event) => {
    press(false);
    player.share = Number(event.target.value) / 1000;
    draw_motion();
  });
}
