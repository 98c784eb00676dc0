// Light or dark: as the system has it, or as chosen with the switch, which is remembered where the browser permits it.
(() => {
  const BLACK = new Set(["#111111", "#1c2733"]); // of harness/report/palette.py
  const root = document.documentElement;
  root.classList.add("scripted");
  const system = matchMedia("(prefers-color-scheme: dark)");
  const kept = (() => {
    try {
      return localStorage.getItem("report-theme");
    } catch {
      return null; // no storage for files in this browser
    }
  })();
  const watchers = [];
  const button = document.getElementById("theme");

  function apply(theme) {
    root.dataset.theme = theme;
    button.setAttribute("aria-pressed", String(theme === "dark"));
    for (const watcher of watchers) watcher();
  }

  const mix = (colour, target, share) => {
    const parts = [1, 3, 5].map((at) => parseInt(colour.slice(at, at + 2), 16));
    return "rgb(" + parts.map((part) => Math.round(part + share * (target - part))).join(" ") + ")";
  };

  report.theme = {
    watch: (watcher) => watchers.push(watcher),
    variable: (name) => getComputedStyle(root).getPropertyValue(name).trim(),
    ink: (colour) => (BLACK.has(colour) ? "var(--ink)" : colour),
    // A colour of the palette, lightened where the page is dark; black lines become the colour of ink.
    colour: (colour) => {
      if (BLACK.has(colour)) return report.theme.variable("--ink");
      return root.dataset.theme === "dark" ? mix(colour, 255, 0.38) : colour;
    },
  };

  apply(kept === "dark" || kept === "light" ? kept : system.matches ? "dark" : "light");
  system.addEventListener("change", () => apply(system.matches ? "dark" : "light"));
  button.hidden = false;
  button.addEventListener("click", () => {
    const theme = root.dataset.theme === "dark" ? "light" : "dark";
    try {
      localStorage.setItem("report-theme", theme);
    } catch {
      // the choice holds until the page is closed
    }
    apply(theme);
  });
})();
