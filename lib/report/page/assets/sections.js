// Three sections through a grid, laid out as views of a drawing, each with a slider along its axis.

const gridWords = {
  surface: "signed distance to the surface, world units, near it; negative inside",
  density: "1 inside, 0 outside, between at the surface",
  jacobian: "by how much the map changes the volume; 1 keeps it, 0 or less folds",
  harmonic_energy: "how much the map changes from place to place; 3 a unit of volume for a rigid motion",
  deformation_energy: "what it would cost rubber; 0 where the motion is rigid",
  "map x": "x of where each place goes, world units of the target",
  "map y": "y of where each place goes, world units of the target",
  "map z": "z of where each place goes, world units of the target",
  repaired: "how far each voxel was moved to take a fold out of the grids, world units",
  folded: "1 where the map itself folds, before any repair",
  undecided: "1 where the proof did not decide",
  outside: "how far each voxel lands out of the target",
};
const preferredGrids = ["deformation_energy", "jacobian", "harmonic_energy"];
// Grids whose voxels are marked in sections of all grids: outside and middle of the mark.
const marksOfGrids = {
  folded: {ink: ["#000", "#ffe600"], words: "fold: black with yellow"},
  undecided: {ink: ["#fff", "#000"], words: "are undecided: white with black"},
};
const acrossOf = [[2, 1], [0, 2], [0, 1]];  // the axes that each section shows, across and up

const edge = (grid, k) => Math.hypot(...grid.axes[k]);
// A place in blocks of the grid, along its axes, which are at right angles.
const inBlocks = (grid, point) => grid.axes.map((axis, k) =>
  axis.reduce((sum, c, a) => sum + c * (point[a] - grid.origin[a]), 0) / edge(grid, k) ** 2);
const middleOf = (grid, block) => [0, 1, 2].map((a) => grid.origin[a] + grid.axes.reduce((sum, axis, k) => sum + axis[a] * (block[k] + 0.5), 0));
const indexOf = (grid, block) => (block[2] * grid.blocks[1] + block[1]) * grid.blocks[0] + block[0];
const planesOf = (grid) => grid.planes || [];
const blockOfIndex = (grid, i) => [i % grid.blocks[0], Math.floor(i / grid.blocks[0]) % grid.blocks[1], Math.floor(i / (grid.blocks[0] * grid.blocks[1]))];

// What shows the section of a grid at this block along an axis: the plane that has each voxel, where
// there is one, or the grid.
function layerOf(grid, axis, at) {
  const through = (plane) => Math.floor(inBlocks(grid, middleOf(plane, [0, 0, 0]))[axis]) === at;
  return planesOf(grid).find((plane) => plane.across === axis && through(plane)) || grid;
}

async function sectionsSection() {
  const grids = page.grids;
  if (!grids.length) return null;
  const names = [...new Set(grids.map((g) => g.name))];
  let grid = preferredGrids.map((name) => grids.find((g) => g.name === name)).find(Boolean) || grids[0], scale = null;
  let frame = grid.frame;  // that is shown, of a sequence
  const gridOf = (name) => grids.find((g) => g.name === name && (g.frame === undefined || g.frame === frame)) || grids.find((g) => g.name === name);
  // One scale for all frames, by the two that reach farthest.
  const scales = new Map();
  async function scaleOf(name) {
    if (!scales.has(name)) {
      const all = grids.filter((g) => g.name === name), some = new Set([
        all.reduce((a, b) => (b.grid_greatest > a.grid_greatest ? b : a)), all.reduce((a, b) => (b.grid_least < a.grid_least ? b : a))]);
      const read = [];
      for (const g of some) for (const v of await readValues(g)) if (Number.isFinite(v)) read.push(v);
      scales.set(name, scaleFor(name, read, [...some].some((g) => g.logarithmic)));
    }
    return scales.get(name);
  }
  let at = null;  // the place, world units, that all sections go through
  let marks = [];  // of the frame: {name, grid, places: middles of the marked blocks, planes: likewise}
  const canvases = [0, 1, 2].map((a) => element("canvas", {class: "cut", tabindex: 0, role: "img", id: "cut-" + "xyz"[a]}));
  const told = element("p", {class: "told", "aria-live": "polite"}, "Point at a section for its numbers.");
  const legendPlace = element("div"), words = element("p", {class: "hint"}), markNotes = element("div");

  const clamped = (g, block) => block.map((index, a) => Math.min(g.blocks[a] - 1, Math.max(0, Math.floor(index))));
  const blockAt = () => clamped(grid, inBlocks(grid, at));
  const shownBy = (axis) => layerOf(grid, axis, blockAt()[axis]);

  // The blocks of a layer in a section, as [x, y] from its upper left, with their values.
  function* blocksIn(layer, axis) {
    const [u, v] = acrossOf[axis], block = [0, 0, 0];
    block[axis] = layer === grid ? blockAt()[axis] : 0;
    for (block[v] = 0; block[v] < layer.blocks[v]; ++block[v])
      for (block[u] = 0; block[u] < layer.blocks[u]; ++block[u])
        yield [block[u], layer.blocks[v] - 1 - block[v], layer.read[indexOf(layer, block)]];
  }

  // Marked blocks that the section meets, as [left, top, width, height] in shares of the canvas.
  function marksIn(mark, axis) {
    const [u, v] = acrossOf[axis], layer = shownBy(axis), plane = layer !== grid && mark.planes.find((p) => p.grid.across === axis), from = plane || mark;
    const here = inBlocks(layer, at)[axis], size = (k) => edge(from.grid, k) / edge(layer, k);
    return from.places.map((point) => inBlocks(layer, point))
      .filter((p) => plane || Math.abs(p[axis] - (Math.floor(here) + 0.5)) < (size(axis) + 1) / 2 - 1e-3)
      .map((p) => [(p[u] - size(u) / 2) / layer.blocks[u], 1 - (p[v] + size(v) / 2) / layer.blocks[v], size(u) / layer.blocks[u], size(v) / layer.blocks[v]]);
  }

  function draw(axis) {
    const canvas = canvases[axis], [u, v] = acrossOf[axis], layer = shownBy(axis), [w, h] = [layer.blocks[u], layer.blocks[v]];
    const ratio = h * edge(layer, v) / (w * edge(layer, u)), zoom = Math.max(2, Math.ceil(720 / Math.max(w, w * ratio)));
    canvas.width = w * zoom;
    canvas.height = Math.max(1, Math.round(canvas.width * ratio));
    const image = new ImageData(w, h);
    for (const [x, y, value] of blocksIn(layer, axis))
      if (Number.isFinite(value)) image.data.set([...scale.colour(value), 255], 4 * (y * w + x));
    const small = element("canvas");
    [small.width, small.height] = [w, h];
    small.getContext("2d").putImageData(image, 0, 0);
    const context = canvas.getContext("2d");
    context.imageSmoothingEnabled = false;
    context.drawImage(small, 0, 0, canvas.width, canvas.height);
    for (const mark of [...marks].reverse())  // what folds stands above what is undecided
      for (const [x, y, width, height] of marksIn(mark, axis).map((m) => m.map((share, k) => share * (k % 2 ? canvas.height : canvas.width)))) {
        context.fillStyle = marksOfGrids[mark.name].ink[0];
        context.fillRect(x, y, width, height);
        context.fillStyle = marksOfGrids[mark.name].ink[1];
        context.fillRect(x + width / 4, y + height / 4, width / 2, height / 2);
      }
    context.strokeStyle = dark() ? "#fff" : "#000";
    context.globalAlpha = 0.35;
    context.lineWidth = 2;
    context.beginPath();
    const here = inBlocks(layer, at), x = here[u] * canvas.width / w, y = (h - here[v]) * canvas.height / h;
    context.moveTo(x, 0); context.lineTo(x, canvas.height);
    context.moveTo(0, y); context.lineTo(canvas.width, y);
    context.stroke();
    context.globalAlpha = 1;
    canvas.setAttribute("aria-label", `${grid.name} across ${"xyz"[axis]}`);
  }
  const drawAll = () => { if (scale) [0, 1, 2].forEach(draw); };

  // Moves the sections through a place.
  function goTo(point) {
    at = point;
    blockAt().forEach((index, a) => { sliders[a].input.value = index; sliders[a].show(); });
  }
  // Through a place of the source, where the grids of maps are.
  whenFocused.push(({panel, point}) => {
    if (panel === 0 && inBlocks(grid, point).every((index, a) => index >= 0 && index < grid.blocks[a])) goTo(point);
  });

  const sliders = [0, 1, 2].map((a) => slider("xyz"[a], "slide-" + "xyz"[a], 1, 0, (index) => {
    if (!scale) return "";
    const step = index - blockAt()[a];
    if (step !== 0) {
      const to = inBlocks(grid, at);
      to[a] = index + 0.5;
      at = middleOf(grid, to.map((c) => c - 0.5));
    }
    drawAll();
    return shortNumber(at[a]);
  }));
  canvases.forEach((canvas, axis) => {
    const [u, v] = acrossOf[axis];
    // The block under the pointer, and its layer.
    const under = (e) => {
      const box = canvas.getBoundingClientRect(), layer = shownBy(axis), block = [0, 0, 0];
      block[axis] = layer === grid ? blockAt()[axis] : 0;
      block[u] = (e.clientX - box.left) / box.width * layer.blocks[u];
      block[v] = (box.bottom - e.clientY) / box.height * layer.blocks[v];
      return [layer, clamped(layer, block)];
    };
    canvas.addEventListener("pointermove", (e) => {
      const [layer, block] = under(e), value = layer.read[indexOf(layer, block)];
      told.textContent = `at (${middleOf(layer, block).map(shortNumber).join(", ")}): ` +
        (Number.isFinite(value) ? `${grid.name} ${shortNumber(value)}` : "nothing");
    });
    canvas.addEventListener("click", (e) => goTo(middleOf(...under(e))));
    canvas.addEventListener("keydown", (e) => {
      const step = {ArrowLeft: [u, -1], ArrowRight: [u, 1], ArrowUp: [v, 1], ArrowDown: [v, -1]}[e.key];
      if (!step) return;
      e.preventDefault();
      sliders[step[0]].input.value = Number(sliders[step[0]].input.value) + step[1];
      sliders[step[0]].show();
    });
  });

  async function readAll(g) {
    for (const one of [g, ...planesOf(g)]) await readValues(one);
    return g;
  }
  function markOf(name, g, marked) {
    const places = [];
    g.read.forEach((value, i) => { if (marked(value)) places.push(middleOf(g, blockOfIndex(g, i))); });
    return {name, grid: g, places, planes: planesOf(g).map((plane) => markOf(name, plane, marked))};
  }
  const nextOf = {};  // which of the places of a mark comes next
  async function readMarks() {
    const found = [];
    for (const name of Object.keys(marksOfGrids).filter((known) => names.includes(known))) {
      const g = await readAll(gridOf(name));
      if (g.frame !== undefined && g.frame !== frame) continue;  // nothing is marked in this frame
      found.push(markOf(name, g, Number.isFinite));
    }
    // Of grids that come without marks.
    if (grid.name === "jacobian" && grid.grid_greatest > 0 && !names.includes("folded"))
      found.push(markOf("folded", grid, (value) => value <= 0));
    marks = found;
    markNotes.replaceChildren(...marks.filter((m) => m.places.length).map(({name, grid: g, places}) => {
      const goOn = () => { goTo(places[(nextOf[name] || 0) % places.length]); nextOf[name] = (nextOf[name] || 0) + 1; };
      return element("p", {class: "hint"}, `${places.length} ${g.stride > 1 ? `blocks of ${g.stride}³ voxels have some that` : "voxels"} ${marksOfGrids[name].words}. `,
        element("button", {type: "button", id: "next-" + name, onclick: goOn}, "go to the next"));
    }), grid.name === "jacobian" && marks.every((m) => !m.places.length) ? element("p", {class: "hint"}, "No voxel folds.") : "");
  }

  async function take(name) {
    const next = await readAll(gridOf(name));
    scale = await scaleOf(name);
    grid = next;
    if (!at) at = middleOf(grid, planesOf(grid).length === 3 ? grid.planes.map((p, a) => inBlocks(grid, middleOf(p, [0, 0, 0]))[a] - 0.5) : grid.blocks.map((n) => Math.floor(n / 2)));
    await readMarks();
    legendPlace.replaceChildren(legend(scale, grid.name));
    words.textContent = [grid.frame === undefined ? "" : "frame " + grid.frame, gridWords[grid.name] || "",
      `in the grid ${shortNumber(grid.grid_least)} to ${shortNumber(grid.grid_greatest)}`,
      grid.stride === 1 ? "each voxel is shown" : `the ${grid.reduction} of each ${grid.stride}³ voxels` +
        (planesOf(grid).length ? "; sections through the middle show each voxel" : "")].filter(Boolean).join("; ") + ".";
    layOut();
    sliders.forEach((s, a) => { s.input.max = grid.blocks[a] - 1; s.input.value = blockAt()[a]; s.show(); });
    drawAll();
  }
  // All to one scale: across z, beside it across x, below it across y.
  const views = element("div", {class: "views"}, canvases[2], canvases[0], canvases[1]);
  function layOut() {
    const [x, y, z] = [0, 1, 2].map((k) => grid.blocks[k] * edge(grid, k)), long = Math.max(x + z, y + z), gap = 0.02 * long;
    views.style.gridTemplateColumns = `${x}fr ${z}fr`;
    views.style.setProperty("--ratio", (x + z + gap) / (y + z + gap));
    canvases.forEach((canvas, k) => { canvas.style.aspectRatio = `${[z, x, x][k]} / ${[y, z, y][k]}`; });
  }
  const node = section("sections", "Sections through the volume",
    element("div", {class: "cuts"}, views, element("div", {class: "panel"},
      element("div", {class: "controls"},
        choice("grid", "grid-shown", [[grid.name, grid.name], ...names.filter((name) => name !== grid.name).map((name) => [name, name])], take)),
      ...sliders.map((s) => s.node), legendPlace, words, markNotes,
      element("p", {class: "hint"}, "Upper left: x to the right, y up. Beside it: z to the right, y up. Below: x to the right, z up. Lines show where the other two cut."), told)));
  whenColoursChange.push(drawAll);
  const recolour = () => { scales.clear(); return take(grid.name); };
  // Goes to a frame's grids, where the page has them.
  const showFrame = (number) => {
    if (frame === number || !grids.some((g) => g.frame === number)) return Promise.resolve();
    frame = number;
    return take(grid.name);
  };
  return {node, start: () => take(grid.name), recolour, showFrame};
}
