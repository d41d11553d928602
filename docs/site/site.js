// Formulas, drawn on the page's own machine.
document.addEventListener("DOMContentLoaded", () => {
  for (const formula of document.querySelectorAll(".arithmatex"))
    renderMathInElement(formula, {delimiters: [{left: "\\(", right: "\\)", display: false},
                                               {left: "\\[", right: "\\]", display: true}]});
  // Browsers let no page search files on the disk; a box that does nothing is worse than none.
  if (location.protocol === "file:")
    for (const part of document.querySelectorAll("[data-md-component=search], label[for=__search]")) part.remove();
});
