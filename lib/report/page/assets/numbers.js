// The report's numbers as tables, its verdict, its command and settings.

function bytesText(bytes) {
  const units = ["bytes", "kB", "MB", "GB", "TB"];
  let k = 0;
  for (; bytes >= 1000 && k < 4; ++k) bytes /= 1000;
  return `${shortNumber(bytes)} ${units[k]}`;
}

function written(value, how) {
  if (value === null || value === undefined) return "–";
  if (typeof value === "boolean") return value ? "yes" : "no";
  if (typeof value !== "number") return String(value);
  if (how === "share") return shortNumber(100 * value) + "%";
  if (how === "bytes") return bytesText(value);
  if (how === "seconds") return shortNumber(value) + " s";
  if (how === "error") return shortNumber(value);
  return Number.isInteger(value) ? value.toLocaleString("en-GB").replace(/,/g, "\u202f") : shortNumber(value);
}

// [key, value] of all that is a single value below `object`.
function leaves(object, before = "") {
  return Object.entries(object).flatMap(([name, value]) => {
    const key = before ? before + "." + name : name;
    if (value !== null && typeof value === "object") return Array.isArray(value) ? [] : leaves(value, key);
    return [[key, value]];
  });
}

const numberColumns = () => element("colgroup", {}, element("col", {class: "name"}), element("col", {class: "value"}), element("col"));

function numberTable(key, title, told) {
  const rows = leaves(page.report[key] || {}, key).filter(([path]) => path !== "one_to_one.statement");  // said above
  if (!rows.length) return null;
  return element("section", {class: "numbers"}, element("h3", {}, title), told ? element("p", {class: "hint"}, told) : null,
    element("table", {}, numberColumns(), element("tbody", {}, ...rows.map(([path, value]) => {
      const known = meaningOf(path), [name, meaning, how] = known || fallback(path), text = typeof value === "string";
      return element("tr", {"data-key": path, "data-known": String(known !== null)},
        element("th", {scope: "row"}, name),
        element("td", {class: text ? "text" : "number", colspan: meaning || !text ? 1 : 2}, written(value, how)),
        meaning || !text ? element("td", {class: "meaning"}, meaning) : null);
    }))));
}

const shownElsewhere = ["command", "seconds", "notes", "warnings", "run", "verdict", "outputs", "energies", "settings",
                        "command_line", "version", "date", "host", "stages", "memory_after_bytes", "peak_memory_bytes"];

function numbersSection() {
  const known = words.sections.map(([key]) => key);
  const others = Object.keys(page.report).filter((key) => !known.includes(key) && !shownElsewhere.includes(key));
  const loose = others.filter((key) => typeof page.report[key] !== "object");
  const tables = [...words.sections.filter(([key]) => !shownElsewhere.includes(key)),
                  ...others.filter((key) => !loose.includes(key)).map((key) => [key, key.replace(/_/g, " "), ""])]
    .map(([key, title, meaning]) => numberTable(key, title, meaning));
  tables.push(loose.length ? element("section", {class: "numbers"}, element("h3", {}, "Other"), element("table", {}, numberColumns(), element("tbody", {},
    ...loose.map((key) => {
      const told = meaningOf(key), [name, meaning, how] = told || fallback(key);
      return element("tr", {"data-key": key, "data-known": String(told !== null)}, element("th", {scope: "row"}, name),
        element("td", {class: "number"}, written(page.report[key], how)), element("td", {class: "meaning"}, meaning));
    })))) : null);
  if (!tables.some(Boolean)) return null;
  return section("numbers", "The numbers", element("div", {class: "tables"}, ...tables));
}

function summarySection() {
  const report = page.report, list = (report.verdict || {}).findings || [], out = [];
  for (const f of list)
    out.push(element("li", {class: f.met ? "good" : "bad"}, element("strong", {}, f.met ? "✓ " : "✗ "),
      f.statement || f.name, f.met || !f.advice ? null : element("span", {class: "advice"}, " Try: " + f.advice)));
  if (!list.length) {
    const good = (met, text) => out.push(element("li", {class: met ? "good" : "bad"}, element("strong", {}, met ? "✓ " : "✗ "), text));
    const tolerance = report.tolerance, worst = report.boundary_error || report.worst_boundary_error;
    if (tolerance) good(tolerance.met, `99% of the boundary lies within ${shortNumber(tolerance.reached)} of the target's diagonal; wanted ${shortNumber(tolerance.wanted)}`);
    else if (worst) out.push(element("li", {}, `99% of the boundary lies within ${shortNumber(worst.p99)} of the target's diagonal`));
    if (report.inside) good(report.inside.folded === 0, `${written(report.inside.folded, "share")} of the inside is folded, ${written(report.inside.outside, "share")} lands outside the target`);
  }
  // What a finding says already is not said again as a warning.
  for (const text of (report.warnings || []).filter((text) => !list.some((f) => f.statement === text))) out.push(element("li", {class: "bad"}, element("strong", {}, "! "), text));
  for (const text of report.notes || []) out.push(element("li", {}, text));
  for (const text of page.missing) out.push(element("li", {class: "missing"}, "Not shown: " + text));
  const unmet = list.filter((f) => !f.met).length, statement = report.one_to_one && report.one_to_one.statement;
  const headline = list.length ? element("p", {id: "verdict", class: unmet ? "bad" : "good"}, element("strong", {},
    unmet ? `✗ ${unmet} of ${list.length} not met` : `✓ All ${list.length} met`)) : null;
  const why = statement ? element("details", {id: "why"}, element("summary", {}, "Why: what was proven and checked"), element("p", {}, statement)) : null;
  if (!out.length && !why) return null;
  return section("summary", "In short", headline, element("ul", {class: "findings"}, ...out), why);
}

function fitSection() {
  const report = page.report, solve = report.solve || {}, charts = [];
  const add = (chart) => { const made = lineChart(chart); if (made) charts.push(made.node); };
  if ((solve.round_sources || []).length && solve.round_p99)
    add({title: "Boundary error as charges are added (99% within)", x: solve.round_sources, xLabel: "charges", logX: solve.round_sources.length > 1, logarithmic: true,
         series: [{name: "error", y: solve.round_p99}], level: report.tolerance ? {value: report.tolerance.wanted, text: "tolerance"} : null});
  if ((solve.residuals || []).length)
    add({title: "Residual at the fitted points, by iteration", x: solve.residuals.map((_, i) => i), xLabel: "iteration", logarithmic: true,
         series: [{name: "residual", y: solve.residuals}]});
  if ((solve.tried_distances || []).length && solve.tried_errors)
  {
    // In the order of the axis, not of the search.
    const tried = solve.tried_distances.map((x, i) => [x, solve.tried_errors[i]]).sort((a, b) => a[0] - b[0]);
    add({title: "Error held out, by distance of the charges", x: tried.map((t) => t[0]), xLabel: "distance", logX: true, logarithmic: true,
         series: [{name: "error", y: tried.map((t) => t[1])}]});
  }
  if (report.steps && (report.steps.to || []).length && report.steps.p99 && report.steps.folded) {
    add({title: "Error of each step", x: report.steps.to, xLabel: "part of the way", logarithmic: true, series: [{name: "error", y: report.steps.p99}]});
    add({title: "Share that each step folds", x: report.steps.to, xLabel: "part of the way", series: [{name: "folded", y: report.steps.folded}]});
  }
  return charts.length ? section("fit", "How the fit went", element("div", {class: "charts"}, ...charts)) : null;
}

function costSection() {
  const seconds = Object.entries(page.report.seconds || {}).filter(([, s]) => typeof s === "number");
  if (!seconds.length) return null;
  const total = seconds.reduce((sum, [, s]) => sum + s, 0), memory = page.report.memory_after_bytes || {};
  const rows = seconds.map(([stage, s]) => [stage.replace(/_/g, " "), s, shortNumber(s) + " s" + (memory[stage] ? ", " + bytesText(memory[stage]) : "")]);
  return section("cost", "Time and memory",
    element("p", {}, `${shortNumber(total)} s in all; at most ${bytesText(page.report.peak_memory_bytes || 0)} of memory.`),
    bars("Seconds by stage" + (Object.keys(memory).length ? ", and the most memory by its end" : ""), rows));
}

function runSection() {
  const report = page.report, line = report.command_line, settings = report.settings || {};
  const quoted = (t) => (/^[\w./:=,+@%-]+$/.test(t) ? t : `'${t.replace(/'/g, "'\\''")}'`);
  const text = Array.isArray(line) ? line.map(quoted).join(" ") : "", host = report.host || {};
  const facts = [["innermap", report.version], ["started", report.date], ["cores", host.cores], ["threads", host.threads]].filter((f) => f[1] != null);
  const outputs = report.outputs || [];
  if (!text && !facts.length && !outputs.length) return null;
  return section("run", "The run",
    text ? element("p", {}, "Command:") : null, text ? element("pre", {class: "command"}, text) : null,
    facts.length ? element("p", {}, facts.map(([name, value]) => `${name} ${value}`).join(" · ")) : null,
    outputs.length ? element("table", {class: "outputs"}, element("tbody", {}, ...outputs.map((o) => element("tr", {}, element("th", {scope: "row"}, o.path), element("td", {class: "number"}, bytesText(o.bytes)))))) : null,
    Object.keys(settings).length ? element("details", {}, element("summary", {}, "Settings as used"), element("table", {class: "settings"}, element("tbody", {},
      ...leaves(settings).map(([name, value]) => element("tr", {}, element("th", {scope: "row"}, name), element("td", {class: "text"}, written(value)))))))
      : null);
}
