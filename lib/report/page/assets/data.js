// Reads what report/page/encode.cc writes.
const page = JSON.parse(document.getElementById("data").textContent);

async function decoded(text, bytesEach) {
  const packed = Uint8Array.from(atob(text), (c) => c.charCodeAt(0));
  const stream = new Blob([packed]).stream().pipeThrough(new DecompressionStream("deflate"));
  const bytes = new Uint8Array(await new Response(stream).arrayBuffer());
  const count = bytes.length / bytesEach;
  const out = bytesEach === 2 ? new Uint16Array(count) : new Uint32Array(count);
  let before = 0;
  for (let i = 0; i < count; ++i) {
    for (let k = 0; k < bytesEach; ++k) before += bytes[k * count + i] * 2 ** (8 * k);
    out[i] = before;
    before = out[i];
  }
  return out;
}

// The number that a code of 16 bits stands for; NaN for 0.
function valueOf(values, code) {
  if (code === 0) return NaN;
  const share = (code - 1) / 65534;
  if (!values.logarithmic) return values.least + share * (values.greatest - values.least);
  return values.least * Math.exp(share * Math.log(values.greatest / values.least));
}

async function readValues(values) {
  if (!values.read) {
    const codes = await decoded(values.codes, 2);
    values.read = Float32Array.from(codes, (code) => valueOf(values, code));
    values.codes = null;
  }
  return values.read;
}

// x, y, z of each point, world units.
async function readPlace(place) {
  if (!place.read) {
    const codes = await decoded(place.points, 2), count = codes.length / 3;
    place.read = new Float64Array(codes.length);
    for (let a = 0; a < 3; ++a) {
      const lower = place.lower[a], step = (place.upper[a] - lower) / 65535;
      for (let i = 0; i < count; ++i) place.read[3 * i + a] = lower + step * codes[a * count + i];
    }
    place.points = null;
  }
  return place.read;
}

async function readCorners(shape) {
  if (!shape.read) shape.read = await decoded(shape.corners, 4);
  return shape.read;
}

// Sorted shares of finite values: quantiles([0.01, 0.99]).
function quantiles(values, shares) {
  const step = Math.max(1, Math.floor(values.length / 200000)), some = [];
  for (let i = 0; i < values.length; i += step) if (Number.isFinite(values[i])) some.push(values[i]);
  some.sort((a, b) => a - b);
  return shares.map((s) => (some.length ? some[Math.round(s * (some.length - 1))] : NaN));
}

// Reports may come from anywhere. What is not of the kind that is expected there goes.
function tidied(report) {
  const isObject = (v) => v !== null && typeof v === "object" && !Array.isArray(v);
  const lists = ["notes", "warnings", "outputs", "command_line"], texts = ["command", "version", "date"];
  const objects = ["verdict", "host", "settings", "source", "target", "solve", "boundary_error", "worst_boundary_error", "tolerance",
                   "inside", "steps", "energy", "energies", "jacobian", "one_to_one", "repair", "grid", "frames", "seconds", "memory_after_bytes"];
  for (const key of lists) if (!Array.isArray(report[key])) delete report[key];
  for (const key of texts) if (typeof report[key] !== "string") delete report[key];
  for (const key of objects) if (!isObject(report[key])) delete report[key];
  for (const key of ["notes", "warnings", "command_line"]) if (report[key]) report[key] = report[key].map(String);
  if (report.outputs) report.outputs = report.outputs.filter((o) => isObject(o) && typeof o.bytes === "number");
  if (report.verdict) report.verdict.findings = Array.isArray(report.verdict.findings) ? report.verdict.findings.filter(isObject) : [];
  for (const key of ["source", "target"]) if (report[key] && typeof report[key].path !== "string") delete report[key].path;
  // Numbers that are not finite are null in JSON.
  const columns = [["solve", "round_sources", "round_p99", "residuals", "tried_distances", "tried_errors"], ["steps", "to", "p99", "folded"],
                   ["frames", "number", "seconds", "missed"], ["energies", ...Object.keys(report.energies || {})]];
  for (const [section, ...keys] of columns)
    for (const key of keys) {
      const list = (report[section] || {})[key];
      if (list === undefined) continue;
      if (Array.isArray(list)) report[section][key] = list.map((v) => (typeof v === "number" || (key === "statement" && typeof v === "string") ? v : NaN));
      else delete report[section][key];
    }
  return report;
}
page.report = tidied(page.report);

// "inside.folded" of the report, or undefined.
function reported(key, from = page.report) {
  return key.split(".").reduce((at, name) => (at == null ? undefined : at[name]), from);
}

// A list of coordinates as points.
// x, y, z one after the other, or a list of each.
function pointsIn(list) {
  const out = [];
  if (list && Array.isArray(list.x)) return list.x.map((x, i) => [x, list.y[i], list.z[i]]);
  for (let i = 0; Array.isArray(list) && i + 2 < list.length; i += 3) out.push(list.slice(i, i + 3));
  return out;
}
