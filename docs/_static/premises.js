/* The graph of premises: choose a record or a symbol, and draw the edges between the records that are left. */
"use strict";
(() => {
  const root = document.getElementById("premises");
  const [form, map, svg] = ["form", ".map", "svg"].map((each) => root.querySelector(each));
  const chips = new Map([...map.querySelectorAll("a")].map((chip) => [chip.dataset.label, chip]));
  const words = (text) => text.split(" ").filter(Boolean);
  const uses = new Map([...chips].map(([label, chip]) => [label, words(chip.dataset.uses)]));
  const used = new Map([...chips.keys()].map((label) => [label, []]));
  uses.forEach((premises, result) => premises.forEach((premise) => used.get(premise).push(result)));

  function reach(label, links, found = new Set([label])) {
    links.get(label).filter((each) => !found.has(each)).forEach((each) => reach(each, links, found.add(each)));
    return found;
  }

  function edge(premise, result, kind) {
    const frame = map.getBoundingClientRect();
    const [from, to] = [premise, result].map((label) => chips.get(label).getBoundingClientRect());
    const [x1, x2] = [from, to].map((each) => each.left + each.width / 2 - frame.left);
    const row = Math.abs(to.top - from.top) < from.height; // then an arc below both
    const [y1, y2] = [from.bottom - frame.top, (row ? to.bottom : to.top) - frame.top];
    const bend = row ? 14 : (y2 - y1) / 2;
    const path = document.createElementNS(svg.namespaceURI, "path");
    path.setAttribute("d", `M${x1},${y1}C${x1},${y1 + bend} ${x2},${row ? y2 + bend : y2 - bend} ${x2},${y2}`);
    path.setAttribute("class", kind);
    svg.append(path);
  }

  function draw(near) {
    const [label, symbol] = [form.record.value, form.symbol.value];
    const before = label ? reach(label, uses) : new Set();
    const after = label ? reach(label, used) : new Set();
    chips.forEach((chip, each) => {
      const kind = each === label ? "chosen" : before.has(each) ? "before" : after.has(each) ? "after" : "";
      const holds = !symbol || words(chip.dataset.symbols).includes(symbol);
      chip.className = kind;
      chip.hidden = kind !== "chosen" && !(holds && (kind || !label));
    });
    map.querySelectorAll("section").forEach((section) => {
      section.hidden = !section.querySelector("a:not([hidden])");
    });
    svg.replaceChildren();
    uses.forEach((premises, result) => premises.forEach((premise) => {
      const both = (set) => set.has(premise) && set.has(result);
      const kind = both(before) ? "before" : both(after) ? "after" : "";
      if (chips.get(premise).hidden || chips.get(result).hidden || (label && !kind)) return;
      edge(premise, result, [premise, result].includes(near) ? `${kind} near` : kind);
    }));
    const count = [...chips.values()].filter((chip) => !chip.hidden).length;
    const told = label ? ` rests on ${before.size - 1} and is used by ${after.size - 1}.` : `${count} records`;
    const title = label ? [...document.getElementById(`of-${label}`).cloneNode(true).childNodes] : [];
    form.querySelector("output").replaceChildren(...title, told);
  }

  function choose(label) {
    form.record.value = chips.has(label) ? label : "";
    draw();
  }

  const linked = () => decodeURIComponent(window.location.hash).replace("#of-", "");
  chips.forEach((chip, label) => {
    chip.addEventListener("click", (event) => {
      event.preventDefault();
      choose(label);
    });
    chip.addEventListener("pointerenter", () => draw(label));
    chip.addEventListener("pointerleave", () => draw());
  });
  form.addEventListener("change", () => draw());
  form.addEventListener("reset", () => setTimeout(draw));
  window.addEventListener("resize", () => draw());
  window.addEventListener("hashchange", () => choose(linked()));
  form.hidden = false;
  choose(linked());
})();
