// Puts the page together. When all is drawn, the root element has data-ready and data-milliseconds.
async function build() {
  const main = document.getElementById("main"), report = page.report;
  const name = (path) => (path || "").split(/[\\/]/).pop();
  const title = ["innermap", report.command].filter(Boolean).join(" ");
  const what = [name(reported("source.path")), name(reported("target.path"))].filter(Boolean).join(" → ");
  document.getElementById("title").textContent = title;
  document.getElementById("subtitle").textContent = what;
  document.title = [title, what].filter(Boolean).join(": ");

  const surfaces = await surfacesSection(), sections = await sectionsSection();
  const frames = framesSection(surfaces, sections);
  main.append(...[summarySection(), surfaces && (surfaces.node || surfaces), frames && frames.node, sections && sections.node, fitSection(),
                  numbersSection(), costSection(), runSection()].filter(Boolean));
  const jumps = [...main.querySelectorAll("main > section")].map((s) => element("a", {href: "#" + s.id}, s.querySelector("h2").textContent));
  const nav = element("nav", {"aria-label": "sections"}, ...jumps);
  if (surfaces || sections)
    nav.append(choice("colours", "colours", [["viridis", "viridis"], ["cividis", "cividis"]], (value) => {
      sizesIn = value;
      if (surfaces && surfaces.recolour) surfaces.recolour();
      if (sections) sections.recolour();
    }));
  document.querySelector("header").append(nav);
  if (surfaces && surfaces.start) await surfaces.start();
  if (sections) await sections.start();
  if (frames) await frames.start();
}

build().then(() => {
  document.documentElement.dataset.milliseconds = Math.round(performance.now());
  document.documentElement.dataset.ready = "yes";
}, (error) => {
  document.getElementById("main").prepend(element("p", {class: "warning"}, "This page could not be shown: " + error));
  document.documentElement.dataset.ready = "failed";
  console.error(error);
});
