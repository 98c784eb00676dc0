/* What the theme leaves out for keyboards and screen readers: a name for the search, and scrolling parts in the tab order. */
document.querySelectorAll(".md-search[role=dialog]").forEach((one) => one.setAttribute("aria-label", "Search"));
const reach = () =>
  document
    .querySelectorAll(".md-typeset__scrollwrap, .md-typeset pre > code, .md-typeset table.dataframe")
    .forEach((one) => one.hasAttribute("tabindex") || one.setAttribute("tabindex", "0"));
reach();
// The theme wraps tables late, and takes code out of the tab order where it saw no scroll bar.
new MutationObserver(reach).observe(document.body, { subtree: true, childList: true, attributeFilter: ["tabindex"] });
