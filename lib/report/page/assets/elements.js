// Small helpers to make the page's elements. Text is never markup.
function element(name, attributes = {}, ...children) {
  const out = document.createElement(name);
  for (const [key, value] of Object.entries(attributes)) {
    if (key.startsWith("on")) out.addEventListener(key.slice(2), value);
    else if (value === true) out.setAttribute(key, "");
    else if (value !== false && value != null) out.setAttribute(key, value);
  }
  out.append(...children.filter((c) => c != null));
  return out;
}

function drawing(name, attributes = {}, ...children) {
  const out = document.createElementNS("http://www.w3.org/2000/svg", name);
  for (const [key, value] of Object.entries(attributes)) out.setAttribute(key, value);
  out.append(...children);
  return out;
}

function section(id, title, ...children) {
  return element("section", {id, "aria-labelledby": id + "-title"},
                 element("h2", {id: id + "-title"}, title), ...children);
}

// options: [[value, text], ...]
function choice(label, id, options, onchange) {
  const select = element("select", {id, onchange: () => onchange(select.value)},
                         ...options.map(([value, text]) => element("option", {value}, text)));
  return element("label", {class: "control"}, label + " ", select);
}

function slider(label, id, most, value, oninput) {
  const shown = element("output", {for: id});
  const input = element("input", {type: "range", id, min: 0, max: most, step: 1, value,
                                  oninput: () => { shown.textContent = oninput(Number(input.value)); }});
  const show = () => { shown.textContent = oninput(Number(input.value)); };
  return {node: element("label", {class: "control slider"}, label + " ", input, " ", shown), input, show};
}

function dark() {
  return !printing && window.matchMedia("(prefers-color-scheme: dark)").matches;
}

let printing = false;
const whenColoursChange = [];
function coloursChanged() { for (const redraw of whenColoursChange) redraw(); }
window.matchMedia("(prefers-color-scheme: dark)").addEventListener("change", coloursChanged);
window.addEventListener("beforeprint", () => { printing = true; coloursChanged(); });
window.addEventListener("afterprint", () => { printing = false; coloursChanged(); });
