// The surfaces side by side, turned together.

const scalarNames = {boundary_error: "boundary error", stretch: "stretch"};
const scalarWords = {
  boundary_error: "how far the map takes each vertex from where it was to go, as a share of the target's diagonal",
  stretch: "by how much the surface grows about each vertex in the direction that grows most; 1 keeps lengths",
  source: "each vertex has the colour of its place in the source: alike colours belong together",
};

// Colours are mixed as light, which the numbers in files are not.
const linear = (c) => ((c /= 255) <= 0.04045 ? c / 12.92 : ((c + 0.055) / 1.055) ** 2.4);

// The panels: {title, shape, place}. A shape of several places has its first beside the others.
function panelsOf(shapes) {
  if (shapes.length && shapes[0].places.length > 1)
    return [{shape: shapes[0], place: 0}, {shape: shapes[0], place: 1}];
  return shapes.slice(0, 3).map((shape) => ({shape, place: 0}));
}

async function makePanel(panel, THREE) {
  const points = await readPlace(panel.shape.places[panel.place]);
  panel.points = points;
  const geometry = new THREE.BufferGeometry();
  geometry.setIndex(new THREE.BufferAttribute(await readCorners(panel.shape), 1));
  for (const name of ["position", "color"])
    geometry.setAttribute(name, new THREE.BufferAttribute(new Float32Array(points.length), 3));
  panel.mesh = new THREE.Mesh(geometry, new THREE.MeshLambertMaterial({vertexColors: true, side: THREE.DoubleSide}));
  panel.scene = new THREE.Scene();
  panel.scene.add(new THREE.AmbientLight(0xffffff, 1.3));
  panel.group = new THREE.Group();
  panel.group.add(panel.mesh);
  panel.scene.add(panel.group);
  panel.dots = [];
  return panel;
}

// Positions in the middle of the panel, in units of the view.
function place(panel, points) {
  panel.points = points;
  const at = panel.mesh.geometry.attributes.position;
  for (let i = 0; i < points.length; ++i) at.array[i] = (points[i] - panel.centre[i % 3]) / panel.unit;
  at.needsUpdate = true;
  panel.mesh.geometry.computeVertexNormals();
  panel.mesh.geometry.computeBoundingSphere();
}

function sizeUp(panel) {
  const box = panel.shape.places[panel.place];
  panel.centre = [0, 1, 2].map((a) => (box.lower[a] + box.upper[a]) / 2);
  panel.diagonal = Math.hypot(...[0, 1, 2].map((a) => box.upper[a] - box.lower[a])) || 1;
}

// Marks of the report: [{text, panel, point}].
function marksOf(panels) {
  const out = [];
  const addPoints = (points, text, panel) => points.forEach((point, i) => {
    if (panels[panel]) out.push({text: `${text} ${i + 1}`, panel, point});
  });
  const add = (key, text, panel) => addPoints(pointsIn(reported(key)), text, panel);
  add("inside.folded_at", "fold inside", 0);
  const cells = pointsIn(reported("one_to_one.proof_places")), folded = reported("one_to_one.proof_negative") || 0;
  addPoints(cells.slice(0, folded), "cell proven to fold", 0);
  addPoints(cells.slice(folded), "undecided cell", 0);
  add("one_to_one.source_crossings_at", "source crosses itself", 0);
  add("one_to_one.target_crossings_at", "target crosses itself", 1);
  add("tolerance.worst_at", "largest error", 0);
  add("source.cap_places", "cap", 0);
  add("target.cap_places", "cap of the target", 1);
  add("laid.cap_places", "cap, laid", 1);
  add("outer_surface.cap_places", "cap", 0);
  add("correspondence.source_outer_surface.cap_places", "cap", 0);
  add("correspondence.target_outer_surface.cap_places", "cap of the target", 1);
  add("outer_surface.cuts", "cut", 0);
  add("correspondence.source_outer_surface.cuts", "source is cut", 0);
  add("correspondence.target_outer_surface.cuts", "target is cut", 1);
  add("outer_surface.plugs", "closed tunnel", 0);
  add("correspondence.source_outer_surface.plugs", "closed tunnel", 0);
  add("correspondence.target_outer_surface.plugs", "closed tunnel of the target", 1);
  return out;
}

// Called with a mark when it is chosen.
const whenFocused = [];

async function surfacesSection() {
  const panels = panelsOf(page.shapes);
  if (!panels.length) return null;
  const canvas = element("canvas", {class: "surfaces", tabindex: 0, "aria-label":
    "surfaces; arrow keys turn, plus and minus zoom, Home shows all"});
  let renderer;
  try {
    renderer = new THREE.WebGLRenderer({canvas, antialias: true, alpha: true, preserveDrawingBuffer: true});
  } catch (error) {
    return section("surfaces", "Surfaces", element("p", {class: "warning"},
      "This browser draws no surfaces in space (WebGL is off); the rest of the page works without."));
  }
  for (const panel of panels) { await makePanel(panel, THREE); sizeUp(panel); }
  // One scale for all, unless that makes one of them too small to see.
  const sizes = panels.map((p) => p.diagonal), alike = Math.max(...sizes) < 1.6 * Math.min(...sizes);
  for (const panel of panels) {
    panel.unit = alike ? Math.max(...sizes) : panel.diagonal;
    place(panel, panel.points);
  }
  const camera = new THREE.PerspectiveCamera(32, 1, 0.005, 50);
  for (const [strength, ...from] of [[2.0, 0.4, 0.9, 1], [0.7, -0.6, -0.2, -1]]) {
    const light = new THREE.DirectionalLight(0xffffff, strength);
    light.position.set(...from);
    camera.add(light, light.target);
  }
  const controls = new THREE.OrbitControls(camera, canvas);
  // As near as all that is shown can be seen from, a little from the right and above.
  function fromFront() {
    const towards = new THREE.Vector3(0.3, 0.22, 1).normalize();
    const across = new THREE.Vector3(0, 1, 0).cross(towards).normalize(), up = towards.clone().cross(across);
    const high = 0.95 * Math.tan(camera.fov * Math.PI / 360), wide = high * camera.aspect, p = new THREE.Vector3();
    let distance = 0.1;
    for (const panel of panels) {
      const at = panel.mesh.geometry.attributes.position;
      for (let i = 0; i < at.count; ++i) {
        p.fromBufferAttribute(at, i);
        distance = Math.max(distance, p.dot(towards) + Math.max(Math.abs(p.dot(up)) / high, Math.abs(p.dot(across)) / wide));
      }
    }
    return towards.multiplyScalar(distance);
  }
  const home = () => {
    for (const p of panels) p.group.position.set(0, 0, 0);
    controls.target.set(0, 0, 0);
    camera.position.copy(fromFront());
    controls.update();
    draw();
  };

  function draw() {
    const width = Math.max(1, canvas.clientWidth), height = Math.max(1, canvas.clientHeight);
    const each = width / panels.length;
    const ratio = Math.min(2, window.devicePixelRatio || 1);
    if (canvas.width !== Math.floor(width * ratio) || canvas.height !== Math.floor(height * ratio)) {
      renderer.setPixelRatio(ratio);
      renderer.setSize(width, height, false);
    }
    camera.aspect = each / height;
    camera.updateProjectionMatrix();
    renderer.setClearColor(0, 0);
    renderer.setScissorTest(false);
    renderer.clear();
    renderer.setScissorTest(true);
    panels.forEach((panel, k) => {
      panel.scene.add(camera);  // with its lights; out of the other scene
      renderer.setViewport(k * each, 0, each, height);
      renderer.setScissor(k * each, 0, each, height);
      renderer.render(panel.scene, camera);
    });
  }
  // A page that is printed has another size, for which WebGL draws too late.
  const printed = element("canvas", {class: "printed"});
  function drawForPrint() {
    draw();
    [printed.width, printed.height] = [canvas.width, canvas.height];
    printed.getContext("2d").drawImage(canvas, 0, 0);
  }
  window.addEventListener("beforeprint", drawForPrint);
  controls.addEventListener("change", draw);
  new ResizeObserver(draw).observe(canvas);

  // Colours.
  const legendPlace = element("div"), words = element("p", {class: "hint"});
  let colouring = "";
  const colourings = [...panels[0].shape.scalars.map((s) => [s.name, scalarNames[s.name] || s.name]),
                      ["source", panels.length > 1 && panels[0].shape === panels[1].shape ? "the source's coordinates" : "coordinates"]];
  async function colour() {
    const scalar = panels[0].shape.scalars.find((s) => s.name === colouring);
    let scale = null, values = null;
    if (scalar) {
      const which = scalar.values[Math.min(scalar.values.length - 1, Math.max(0, shownPlace - 1))];
      values = await readValues(which);
      scale = scaleFor(scalar.name, values, which.logarithmic);
    }
    for (const panel of panels) {
      const at = panel.mesh.geometry.attributes.color, count = at.array.length / 3;
      const first = panel.shape.places[0], rest = await readPlace(first);
      const widths = [0, 1, 2].map((a) => (first.upper[a] - first.lower[a]) || 1);
      const of = panel.shape === panels[0].shape ? values : null;
      for (let i = 0; i < count; ++i)
        for (let a = 0, rgb = of ? (Number.isFinite(of[i]) ? scale.colour(of[i]) : [128, 128, 128]) : null; a < 3; ++a)
          at.array[3 * i + a] = linear(rgb ? rgb[a] : 40 + 200 * (rest[3 * i + a] - first.lower[a]) / widths[a]);
      at.needsUpdate = true;
    }
    legendPlace.replaceChildren(...(scale ? [legend(scale, scalarNames[colouring] || colouring)] : []));
    words.textContent = scalarWords[colouring] || "";
    draw();
  }

  // The point that was clicked or chosen, in all panels where it is known.
  let shownPlace = 1;
  const told = element("p", {class: "told", "aria-live": "polite"}, "Drag to turn, wheel to zoom, click a surface for its numbers.");
  function dotAt(panel, point) {
    for (const dot of panel.dots) panel.group.remove(dot);
    panel.dots = [];
    if (!point) return;
    const where = new THREE.BufferGeometry();
    where.setAttribute("position", new THREE.BufferAttribute(new Float32Array(point.map((c, a) => (c - panel.centre[a]) / panel.unit)), 3));
    for (const [size, paint] of [[15, 0x000000], [10, 0xffe600]]) {
      const dot = new THREE.Points(where, new THREE.PointsMaterial({size, color: paint, sizeAttenuation: false, depthTest: false}));
      dot.renderOrder = size === 15 ? 1 : 2;
      panel.dots.push(dot);
      panel.group.add(dot);
    }
  }
  const vertexOf = (panel, i) => [0, 1, 2].map((a) => panel.points[3 * i + a]);
  function nearest(panel, point) {
    let best = -1, least = Infinity;
    for (let i = 0; 3 * i < panel.points.length; ++i) {
      const d = (panel.points[3 * i] - point[0]) ** 2 + (panel.points[3 * i + 1] - point[1]) ** 2 + (panel.points[3 * i + 2] - point[2]) ** 2;
      if (d < least) { least = d; best = i; }
    }
    return best;
  }
  const coordinates = (p) => "(" + p.map(shortNumber).join(", ") + ")";
  function show(panelIndex, point, text) {
    const vertex = nearest(panels[panelIndex], point);
    const parts = [text];
    panels.forEach((panel, k) => {
      const related = panel.shape === panels[panelIndex].shape;
      const there = k === panelIndex ? point : related ? vertexOf(panel, vertex) : null;
      dotAt(panel, there);
      if (there) parts.push(`${panel.shape.places[panel.place].label} ${coordinates(there)}`);
    });
    for (const scalar of panels[panelIndex].shape.scalars) {
      const values = scalar.values[Math.min(scalar.values.length - 1, Math.max(0, shownPlace - 1))].read;
      if (values) parts.push(`${scalarNames[scalar.name] || scalar.name} ${shortNumber(values[vertex])}`);
    }
    told.textContent = parts.filter(Boolean).join("; ");
    draw();
  }
  function focus(mark) {
    const panel = panels[mark.panel], vertex = nearest(panel, mark.point);
    panels.forEach((p, k) => {
      const there = k === mark.panel ? mark.point : p.shape === panel.shape ? vertexOf(p, vertex) : p.centre;
      p.group.position.set(...there.map((c, a) => -(c - p.centre[a]) / p.unit));
    });
    // From outside, where the surface faces.
    const normal = new THREE.Vector3().fromBufferAttribute(panel.mesh.geometry.attributes.normal, vertex);
    controls.target.set(0, 0, 0);
    if (normal.lengthSq() > 0) camera.position.copy(normal).add(new THREE.Vector3(0, 0.15, 0));
    camera.position.setLength(0.45);
    controls.update();
    show(mark.panel, mark.point, mark.text);
    for (const told of whenFocused) told(mark);
  }
  let pressed = null;
  canvas.addEventListener("pointerdown", (e) => { pressed = [e.clientX, e.clientY]; });
  canvas.addEventListener("click", (e) => {
    if (pressed && Math.hypot(e.clientX - pressed[0], e.clientY - pressed[1]) > 4) return;
    const box = canvas.getBoundingClientRect(), each = box.width / panels.length;
    const k = Math.min(panels.length - 1, Math.floor((e.clientX - box.left) / each)), panel = panels[k];
    const ray = new THREE.Raycaster();
    ray.setFromCamera(new THREE.Vector2(2 * (e.clientX - box.left - k * each) / each - 1, 1 - 2 * (e.clientY - box.top) / box.height), camera);
    const hit = ray.intersectObject(panel.mesh)[0];
    if (!hit) return;
    const local = panel.group.worldToLocal(hit.point.clone());
    show(k, [local.x, local.y, local.z].map((c, a) => c * panel.unit + panel.centre[a]), "");
  });
  canvas.addEventListener("keydown", (e) => {
    const turn = {ArrowLeft: [-0.12, 0], ArrowRight: [0.12, 0], ArrowUp: [0, -0.12], ArrowDown: [0, 0.12]}[e.key];
    const offset = camera.position.clone().sub(controls.target);
    if (turn) {
      const radius = offset.length(), around = Math.atan2(offset.x, offset.z) + turn[0];
      const down = Math.min(3.1, Math.max(0.04, Math.acos(offset.y / radius) + turn[1]));
      offset.set(Math.sin(down) * Math.sin(around), Math.cos(down), Math.sin(down) * Math.cos(around)).multiplyScalar(radius);
    } else if (e.key === "+" || e.key === "=") offset.multiplyScalar(0.85);
    else if (e.key === "-") offset.multiplyScalar(1 / 0.85);
    else if (e.key === "Home") { home(); e.preventDefault(); return; }
    else return;
    e.preventDefault();
    camera.position.copy(controls.target).add(offset);
    controls.update();
    draw();
  });

  const captions = panels.map((p) => element("span", {}, p.shape.places[p.place].label));
  // Of a shape that has several places: shows that one beside the first.
  async function showPlace(index) {
    shownPlace = index;
    const panel = panels[1];
    panel.place = index;
    for (const p of panels) dotAt(p, null);
    place(panel, await readPlace(panel.shape.places[index]));
    captions[1].textContent = panel.shape.places[index].label;
    await colour();
  }
  const related = panels.length > 1 && panels[0].shape === panels[1].shape;
  const many = panels[0].shape.places.length - 1, isSequence = reported("frames.number") !== undefined;
  const controlsRow = element("div", {class: "controls"},
    choice("colour by", "colour-by", colourings, (value) => { colouring = value; colour(); }),
    related && many > 1 && !isSequence ? choice("right", "right-shows", panels[1].shape.places.slice(1).map((p, i) => [String(i + 1), p.label]), (v) => showPlace(Number(v))) : null,
    element("button", {type: "button", id: "show-all", onclick: home}, "show all"));
  const marks = marksOf(panels);
  const cut = panels.find((p) => p.shape.vertices < p.shape.given_vertices);
  const node = section("surfaces", panels.length > 1 ? "Surfaces, before and after" : "Surface",
    controlsRow, element("div", {class: "captions", style: `grid-template-columns: repeat(${panels.length}, 1fr)`}, ...captions),
    canvas, printed, legendPlace, words, told,
    marks.length ? element("div", {class: "marks"}, element("h3", {}, "Places to look at"),
      element("p", {}, ...marks.map((m) => element("button", {type: "button", class: "mark", onclick: () => focus(m)}, m.text)))) : null,
    cut ? element("p", {class: "hint"}, `Shown with ${cut.shape.vertices} of ${cut.shape.given_vertices} vertices.`) : null,
    alike ? null : element("p", {class: "hint"}, "The surfaces differ in size by more than half; each is shown as large as the view."));
  whenColoursChange.push(draw);
  colouring = colourings[0][0];
  return {node, showPlace, recolour: colour, start: async () => { home(); await colour(); home(); }, focus};
}
