// Colours for numbers. Those for sizes are viridis and cividis (Nuñez, Anderton, Renslow, 2018),
// those about a middle Brewer's blue to red: people who do not tell red from green see them as well.
const anchors = {
  viridis: ["440154", "482878", "3e4989", "31688e", "26828e", "1f9e89", "35b779", "6ece58", "b5de2b", "fde725"],
  cividis: ["00224e", "123570", "3b496c", "575d6d", "707173", "8a8678", "a59c74", "c3b369", "e1cc55", "fee838"],
  diverging: ["053061", "2166ac", "4393c3", "92c5de", "d1e5f0", "f7f7f7", "fddbc7", "f4a582", "d6604d", "b2182b", "67001f"],
};
let sizesIn = "viridis";

// share in [0, 1]: [red, green, blue] in 0..255.
function anchored(name, share) {
  const list = anchors[name], at = Math.min(Math.max(share, 0), 1) * (list.length - 1);
  const i = Math.min(Math.floor(at), list.length - 2), f = at - i;
  const part = (text, k) => parseInt(text.slice(2 * k, 2 * k + 2), 16);
  return [0, 1, 2].map((k) => (1 - f) * part(list[i], k) + f * part(list[i + 1], k));
}

// Where 1 is neither more nor less.
const aboutOne = (name) => /jacobian|stretch/.test(name);

// The scale of a quantity for these values: {share(v), colour(v), kind, lower, upper, inverse(share)}.
// The range leaves out the last hundredth at either end, so that one odd value does not hide the rest.
function scaleFor(name, values, logarithmic) {
  // What folds has a mark, and no place on a scale of ratios.
  const kept = aboutOne(name) ? values.filter((v) => v > 0) : values, shown = kept.length ? kept : values;
  const [least, low, high, greatest] = quantiles(shown, [0, 0.01, 0.99, 1]);
  if (aboutOne(name)) {
    const far = Math.max(Math.log(1.02), Math.abs(Math.log(Math.max(low, 1e-3))), Math.abs(Math.log(Math.max(high, 1e-3))));
    return makeScale("diverging", -far, far, Math.log, Math.exp);
  }
  if (logarithmic && greatest > 0)
    return makeScale("logarithmic", Math.log(Math.max(low, 1e-12 * greatest)), Math.log(Math.max(high, low * 1.01)), Math.log, Math.exp);
  return high > low ? makeScale("linear", low, high, (v) => v, (v) => v)
                    : makeScale("linear", least, greatest > least ? greatest : least + 1, (v) => v, (v) => v);
}

function makeScale(kind, from, to, forth, back) {
  const share = (v) => (kind !== "linear" && v <= 0 ? 0 : (forth(v) - from) / (to - from));
  const table = [];
  for (let i = 0; i < 256; ++i) table.push(anchored(kind === "diverging" ? "diverging" : sizesIn, i / 255));
  return {kind, share, inverse: (s) => back(from + s * (to - from)),
          colour: (v) => table[Math.min(255, Math.max(0, Math.round(255 * share(v))))]};
}

const css = (rgb) => `rgb(${rgb.map(Math.round).join(",")})`;

// A bar with its numbers.
function legend(scale, name) {
  const stops = [];
  for (let i = 0; i <= 20; ++i) stops.push(`${css(scale.colour(scale.inverse(i / 20)))} ${5 * i}%`);
  const words = {diverging: "1 in the middle: neither more nor less", logarithmic: "logarithmic", linear: ""}[scale.kind];
  return element("figure", {class: "legend", "aria-label": "colours of " + name},
                 element("div", {class: "bar", style: `background: linear-gradient(to right, ${stops.join(",")})`}),
                 element("div", {class: "ticks"}, ...[0, 0.25, 0.5, 0.75, 1].map((s) => element("span", {}, shortNumber(scale.inverse(s))))),
                 words ? element("figcaption", {}, words) : null);
}

function numberText(v, digits) {
  if (!Number.isFinite(v)) return "–";
  if (v === 0) return "0";
  const size = Math.abs(v);
  if (size >= 1e-3 && size < 1e5) return String(Number(v.toPrecision(digits)));
  return v.toExponential(digits - 2).replace("e+", "e");
}

const shortNumber = (v) => numberText(v, 3);
