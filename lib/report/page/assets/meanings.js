// What the numbers of report.json mean, as docs/report.schema.json says it: sections as [key, title,
// meaning], figures as key: [name, meaning, how it is written]. How: "share" of 1 as percent,
// "error", "bytes", "seconds".
const words = JSON.parse(document.getElementById("words").textContent);

// "mass.*_before" stands for any name.
const patterns = Object.entries(words.figures).filter(([key]) => key.includes("*")).map(([key, meaning]) => [
  new RegExp("^" + key.split("*").map((part) => part.replace(/[.]/g, "\\.")).join("(.+)") + "$"), meaning]);

function meaningOf(key) {
  const exact = words.figures[key];
  if (exact) return exact;
  for (const [pattern, [name, meaning, how]] of patterns) {
    const found = key.match(pattern);
    if (found) return [name.replace("*", found[1]).replace(/_/g, " "), meaning, how];
  }
  return null;
}

// Of a report that another version wrote.
const fallback = (key) => [key.slice(key.lastIndexOf(".") + 1).replace(/_/g, " "), "", ""];
