// Line charts and bars.

function ticksOf(least, greatest, logarithmic, whole = false) {
  if (logarithmic) {
    for (const digits of [[1], [1, 2, 5]]) {
      const out = [];
      for (let e = Math.floor(Math.log10(least)); e <= Math.ceil(Math.log10(greatest)); ++e) out.push(...digits.map((d) => d * 10 ** e));
      const some = out.filter((t) => t >= least * 0.999 && t <= greatest * 1.001);
      if (some.length >= 3) return some;
    }
  }
  const raw = Math.max(whole ? 1 : 0, (greatest - least) / 4), power = 10 ** Math.floor(Math.log10(raw));
  const step = [1, 2, 5, 10].map((f) => f * power).find((s) => s >= raw), out = [];
  for (let t = Math.ceil(least / step) * step; t <= greatest + 1e-9 * step; t += step) out.push(Math.abs(t) < 1e-9 * step ? 0 : t);
  return out;
}

// As short as they can be while no two read alike.
function labelsOf(ticks) {
  let digits = 3;
  while (digits < 9 && new Set(ticks.map((t) => numberText(t, digits))).size < ticks.length) ++digits;
  return ticks.map((t) => [t, numberText(t, digits)]);
}

// chart: {title, x: [...], xLabel, series: [{name, y: [...]}], logarithmic, logX, cursor, level: {value, text}}
// Returns {node, setCursor(x)}.
function lineChart(chart) {
  const width = 400, height = 200, left = 62, right = 24, top = 14, bottom = 38;
  // What has no place on either axis is left out.
  const placed = (x) => Number.isFinite(x) && (!chart.logX || x > 0);
  chart.series = chart.series.map((s) => ({name: s.name, y: chart.x.map((x, i) => (placed(x) ? s.y[i] : NaN))}));
  const finite = (v) => Number.isFinite(v) && (!chart.logarithmic || v > 0);
  const ys = chart.series.flatMap((s) => s.y).concat(chart.level ? [chart.level.value] : []).filter(finite);
  const xs = chart.x.filter(placed);
  if (!ys.length || !xs.length) return null;
  const range = (list, log) => {
    let [a, b] = [Math.min(...list), Math.max(...list)];
    if (a === b && log) [a, b] = [a / 2, b * 2];
    else if (a === b) [a, b] = a === 0 ? [0, 1] : [a - Math.abs(a) / 10, b + Math.abs(b) / 10];
    return [a, b];
  };
  const [y0, y1] = range(ys, chart.logarithmic), [x0, x1] = range(xs, chart.logX);
  const along = (v, a, b, log) => (log ? Math.log(v / a) / Math.log(b / a) : (v - a) / (b - a));
  const px = (x) => left + along(x, x0, x1, chart.logX) * (width - left - right);
  const py = (y) => height - bottom - along(y, y0, y1, chart.logarithmic) * (height - top - bottom);
  const svg = drawing("svg", {viewBox: `0 0 ${width} ${height}`, role: "img", class: "chart"},
                      drawing("title", {}, chart.title));
  for (const [t, label] of labelsOf(ticksOf(y0, y1, chart.logarithmic)))
    svg.append(drawing("line", {x1: left, x2: width - right, y1: py(t), y2: py(t), class: "grid"}),
               drawing("text", {x: left - 6, y: py(t) + 4, "text-anchor": "end"}, label));
  for (const [t, label] of labelsOf(ticksOf(x0, x1, chart.logX, xs.every(Number.isInteger))))
    svg.append(drawing("text", {x: px(t), y: height - bottom + 16, "text-anchor": "middle"}, label));
  svg.append(drawing("text", {x: (left + width - right) / 2, y: height - 4, "text-anchor": "middle", class: "label"}, chart.xLabel));
  if (chart.level)
    svg.append(drawing("line", {x1: left, x2: width - right, y1: py(chart.level.value), y2: py(chart.level.value), class: "level"}),
               drawing("text", {x: width - right, y: py(chart.level.value) - 4, "text-anchor": "end"}, chart.level.text));
  chart.series.forEach((series, k) => {
    let path = "";
    series.y.forEach((y, i) => { if (finite(y)) path += `${path && finite(series.y[i - 1]) ? "L" : "M"}${px(chart.x[i]).toFixed(1)},${py(y).toFixed(1)}`; });
    svg.append(drawing("path", {d: path, class: "line line" + k}));
    series.y.forEach((y, i) => { if (finite(y) && series.y.length < 60) svg.append(
      drawing("circle", {cx: px(chart.x[i]), cy: py(y), r: 2.6, class: "dot line" + k},
              drawing("title", {}, `${chart.xLabel} ${shortNumber(chart.x[i])}: ${series.name} ${shortNumber(y)}`))); });
  });
  const cursor = drawing("line", {x1: left, x2: left, y1: top, y2: height - bottom, class: "cursor", visibility: "hidden"});
  svg.append(cursor);
  const names = chart.series.length > 1
    ? element("span", {class: "names"}, ...chart.series.map((s, k) => element("span", {class: "name name" + k}, s.name))) : null;
  return {node: element("figure", {class: "chart"}, element("figcaption", {}, chart.title, names), svg),
          setCursor: (x) => { for (const a of ["x1", "x2"]) cursor.setAttribute(a, px(x)); cursor.setAttribute("visibility", "visible"); }};
}

// rows: [[name, value, text]]
function bars(title, rows) {
  const most = Math.max(...rows.map((r) => r[1]), 1e-12);
  return element("figure", {class: "bars"}, element("figcaption", {}, title),
    element("table", {}, element("tbody", {}, ...rows.map(([name, value, text]) => element("tr", {},
      element("th", {scope: "row"}, name), element("td", {class: "number"}, text),
      element("td", {class: "track"}, element("div", {class: "fill", style: `width:${(100 * value / most).toFixed(1)}%`})))))));
}
