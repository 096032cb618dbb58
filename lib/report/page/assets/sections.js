// Three sections through a grid, each with a slider along its axis.

const gridWords = {
  surface: "signed distance to the surface, world units, near it; negative inside",
  density: "1 inside, 0 outside, between at the surface",
  jacobian: "by how much the map changes the volume; 1 keeps it, 0 or less folds",
  harmonic_energy: "how much the map changes from place to place; 3 a unit of volume for a rigid motion",
  deformation_energy: "what it would cost rubber; 0 where the motion is rigid",
  "map x": "x of where each place goes, world units of the target",
  "map y": "y of where each place goes, world units of the target",
  "map z": "z of where each place goes, world units of the target",
  repaired: "voxels whose fold was repaired",
  folded: "voxels that the map folds",
  outside: "how far each voxel lands out of the target",
};
const preferredGrids = ["deformation_energy", "jacobian", "harmonic_energy"];

async function sectionsSection() {
  const grids = page.grids;
  if (!grids.length) return null;
  const names = [...new Set(grids.map((g) => g.name))];
  let grid = preferredGrids.map((name) => grids.find((g) => g.name === name)).find(Boolean) || grids[0], values = null, scale = null;
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
  const at = [0.5, 0.5, 0.5];  // shares of the grid's box
  const across = [[1, 2], [0, 2], [0, 1]];  // the axes that each section shows, across and up
  const canvases = [0, 1, 2].map((a) => element("canvas", {class: "cut", tabindex: 0, role: "img", id: "cut-" + "xyz"[a]}));
  const told = element("p", {class: "told", "aria-live": "polite"}, "Point at a section for its numbers.");
  const legendPlace = element("div"), words = element("p", {class: "hint"}), foldNote = element("p", {class: "hint"});

  const blockAt = (axis) => Math.min(grid.blocks[axis] - 1, Math.max(0, Math.round(at[axis] * (grid.blocks[axis] - 1))));
  const worldAt = (block) => [0, 1, 2].map((a) => grid.origin[a] + grid.axes.reduce((sum, axis, k) => sum + axis[a] * (block[k] + 0.5), 0));
  const valueIn = (block) => values[(block[2] * grid.blocks[1] + block[1]) * grid.blocks[0] + block[0]];
  const folds = () => /jacobian/.test(grid.name);

  function draw(axis) {
    const canvas = canvases[axis], [u, v] = across[axis], [w, h] = [grid.blocks[u], grid.blocks[v]];
    const length = (k) => Math.hypot(...grid.axes[k]);
    const zoom = Math.max(2, Math.floor(420 / Math.max(w, h)));
    canvas.width = w * zoom;
    canvas.height = Math.round(h * zoom * length(v) / length(u));
    const image = new ImageData(w, h), block = [0, 0, 0], crossed = [];
    block[axis] = blockAt(axis);
    for (let y = 0; y < h; ++y)
      for (let x = 0; x < w; ++x) {
        block[u] = x;
        block[v] = h - 1 - y;
        const value = valueIn(block), to = 4 * (y * w + x);
        if (!Number.isFinite(value)) continue;
        if (folds() && value <= 0) crossed.push([x, y]);
        image.data.set([...scale.colour(value), 255], to);
      }
    const small = element("canvas");
    [small.width, small.height] = [w, h];
    small.getContext("2d").putImageData(image, 0, 0);
    const context = canvas.getContext("2d"), tall = canvas.height / h;
    context.imageSmoothingEnabled = false;
    context.drawImage(small, 0, 0, canvas.width, canvas.height);
    for (const [x, y] of crossed) {
      context.fillStyle = "#000";
      context.fillRect(x * zoom, y * tall, zoom, tall);
      context.fillStyle = "#ffe600";
      context.fillRect((x + 0.25) * zoom, (y + 0.25) * tall, zoom / 2, tall / 2);
    }
    context.strokeStyle = dark() ? "#fff" : "#000";
    context.globalAlpha = 0.35;
    context.beginPath();
    const x = (blockAt(u) + 0.5) * zoom, y = (h - 0.5 - blockAt(v)) * tall;
    context.moveTo(x, 0); context.lineTo(x, canvas.height);
    context.moveTo(0, y); context.lineTo(canvas.width, y);
    context.stroke();
    context.globalAlpha = 1;
    canvas.setAttribute("aria-label", `${grid.name} across ${"xyz"[axis]}`);
  }
  const drawAll = () => { if (values) [0, 1, 2].forEach(draw); };

  // Moves the sections through a block.
  function goTo(block) {
    block.forEach((index, a) => { sliders[a].input.value = Math.round(95 * index / Math.max(1, grid.blocks[a] - 1)); sliders[a].show(); });
  }
  let folded = [], nextFolded = 0;
  function nextFold() {
    const i = folded[nextFolded++ % folded.length], [w, h] = grid.blocks;
    goTo([i % w, Math.floor(i / w) % h, Math.floor(i / (w * h))]);
  }
  // Through a place of the source, where the grids of maps are.
  whenFocused.push(({panel, point}) => {
    const block = point.map((c, a) => Math.floor((c - grid.origin[a]) / grid.axes[a][a]));
    if (panel === 0 && block.every((index, a) => index >= 0 && index < grid.blocks[a])) goTo(block);
  });

  const sliders = [0, 1, 2].map((a) => slider("xyz"[a], "slide-" + "xyz"[a], 95, 48, (v) => {
    at[a] = v / 95;
    drawAll();
    return values ? shortNumber(worldAt([0, 1, 2].map(blockAt))[a]) : "";
  }));
  canvases.forEach((canvas, axis) => {
    const blockOf = (e) => {
      const box = canvas.getBoundingClientRect(), [u, v] = across[axis], block = [0, 0, 0];
      block[axis] = blockAt(axis);
      block[u] = Math.min(grid.blocks[u] - 1, Math.max(0, Math.floor((e.clientX - box.left) / box.width * grid.blocks[u])));
      block[v] = Math.min(grid.blocks[v] - 1, Math.max(0, Math.floor((box.bottom - e.clientY) / box.height * grid.blocks[v])));
      return block;
    };
    canvas.addEventListener("pointermove", (e) => {
      const block = blockOf(e), value = valueIn(block);
      told.textContent = `at (${worldAt(block).map(shortNumber).join(", ")}): ` +
        (Number.isFinite(value) ? `${grid.name} ${shortNumber(value)}` : "nothing");
    });
    canvas.addEventListener("click", (e) => {
      goTo(blockOf(e));
    });
    canvas.addEventListener("keydown", (e) => {
      const [u, v] = across[axis], step = {ArrowLeft: [u, -1], ArrowRight: [u, 1], ArrowUp: [v, 1], ArrowDown: [v, -1]}[e.key];
      if (!step) return;
      e.preventDefault();
      sliders[step[0]].input.value = Number(sliders[step[0]].input.value) + step[1];
      sliders[step[0]].show();
    });
  });

  async function take(name) {
    const next = gridOf(name);
    [values, scale] = [await readValues(next), await scaleOf(name)];
    grid = next;
    legendPlace.replaceChildren(legend(scale, grid.name));
    words.textContent = [grid.frame === undefined ? "" : "frame " + grid.frame, gridWords[grid.name] || "",
      `in the grid ${shortNumber(grid.grid_least)} to ${shortNumber(grid.grid_greatest)}`,
      grid.stride > 1 ? `here the ${grid.reduction} of each ${grid.stride}³ voxels` : "each voxel is shown"].filter(Boolean).join("; ") + ".";
    folded = [];
    if (folds()) values.forEach((v, i) => { if (v <= 0) folded.push(i); });
    nextFolded = 0;
    foldNote.replaceChildren(...(folded.length
      ? [`${folded.length} of the places shown fold; they are black with yellow. `, element("button", {type: "button", id: "next-fold", onclick: nextFold}, "go to the next")]
      : folds() ? ["No place that is shown folds."] : []));
    for (const s of sliders) s.show();
    drawAll();
  }
  const node = section("sections", "Sections through the volume",
    element("div", {class: "controls"},
      choice("grid", "grid-shown", [[grid.name, grid.name], ...names.filter((name) => name !== grid.name).map((name) => [name, name])], take)),
    element("div", {class: "cuts"}, ...[0, 1, 2].map((a) => element("figure", {}, canvases[a], element("figcaption", {}, `across ${"xyz"[a]}: ${"xyz"[across[a][0]]} to the right, ${"xyz"[across[a][1]]} up`), sliders[a].node))),
    legendPlace, words, foldNote, told);
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
