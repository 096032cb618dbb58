// A sequence: curves over its frames, a slider that shows one, and the worst of them.

const frameCurves = [
  ["harmonic", "Harmonic energy (3: rigid)", false], ["deformation", "Deformation energy (0: rigid)", false],
  ["boundary_p99", "Boundary error, 99% within", true], ["folded_fraction", "Share of the volume that is folded", false],
  ["proof_undecided_share", "Share of the volume where nothing is proven", false], ["proof_boundary_error", "Boundary error, proven", true],
  ["jacobian_min", "Least change of volume", false], ["volume", "Volume, world units cubed", false], ["seconds", "Seconds", false],
];
const worstOf = [["boundary_p99", "largest boundary error"], ["folded_fraction", "most folded"], ["deformation", "most deformed"]];

function framesSection(surfaces, sections) {
  const numbers = reported("frames.number"), table = page.report.energies || {};
  if (!numbers || !numbers.length) return null;
  const charts = frameCurves.map(([key, title, logarithmic]) => {
    const y = table[key] || reported("frames." + key);
    return y && y.some(Number.isFinite) && lineChart({title, x: numbers, xLabel: "frame", logarithmic, series: [{name: title, y}]});
  }).filter(Boolean);
  // The shape's places are those frames that could be read, "frame 12".
  const places = surfaces && page.shapes.length ? page.shapes[0].places.slice(1) : [];
  const placeOf = new Map(places.map((p, i) => [Number((p.label.match(/-?\d+$/) || [NaN])[0]), i + 1]));
  const told = element("p", {class: "told", "aria-live": "polite"});
  const statements = table.statement || [], why = element("p", {id: "frame-statement"});
  let busy = Promise.resolve();
  const control = slider("frame", "frame-shown", numbers.length - 1, 0, (i) => {
    const number = numbers[i];
    for (const chart of charts) chart.setCursor(number);
    const figures = frameCurves.filter(([key]) => table[key] && Number.isFinite(table[key][i])).map(([key, title]) => `${title.split(/[,(]/)[0].trim().toLowerCase()} ${shortNumber(table[key][i])}`);
    const shown = placeOf.has(number);
    told.textContent = figures.join("; ") + (places.length && !shown ? " (this frame's surface is not in the page)" : "");
    why.textContent = typeof statements[i] === "string" ? statements[i] : "";
    if (shown) busy = busy.then(() => surfaces.showPlace(placeOf.get(number)));
    if (sections) busy = busy.then(() => sections.showFrame(number));
    return String(number);
  });
  const go = (i) => { control.input.value = i; control.show(); };
  let timer = null;
  const play = element("button", {type: "button", id: "play", onclick: () => {
    clearInterval(timer);
    timer = timer ? null : setInterval(() => go((Number(control.input.value) + 1) % numbers.length), 120);
    play.textContent = timer ? "stop" : "play";
  }}, "play");
  const worst = worstOf.filter(([key]) => table[key]).flatMap(([key, title]) => {
    const order = table[key].map((v, i) => [v, i]).filter(([v]) => Number.isFinite(v)).sort((a, b) => b[0] - a[0]).slice(0, 3);
    return order.length && order[0][0] > 0 ? [element("p", {}, title + ": ", ...order.map(([v, i]) =>
      element("button", {type: "button", class: "mark", onclick: () => go(i)}, `frame ${numbers[i]} (${key === "folded_fraction" ? written(v, "share") : shortNumber(v)})`)))] : [];
  });
  const missed = (reported("frames.missed") || []).filter((number) => numbers.includes(number));
  if (missed.length)
    worst.unshift(element("p", {}, `${missed.length} of ${numbers.length} miss the tolerance: `, ...missed.slice(0, 40).map((number) =>
      element("button", {type: "button", class: "mark missed", onclick: () => go(numbers.indexOf(number))}, "frame " + number))));
  const node = section("frames", "Frames", element("div", {class: "controls"}, control.node, play), told,
    statements.some((text) => typeof text === "string" && text) ? element("details", {}, element("summary", {}, "What was proven and checked of this frame"), why) : null,
    worst.length ? element("div", {class: "marks"}, element("h3", {}, "Worst frames"), ...worst) : null,
    element("div", {class: "charts"}, ...charts.map((c) => c.node)));
  return {node, start: () => { go(0); return busy; }};
}
