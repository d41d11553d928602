// Formulas, drawn on the page's own machine.
document.addEventListener("DOMContentLoaded", () => {
  for (const formula of document.querySelectorAll(".arithmatex"))
    renderMathInElement(formula, {delimiters: [{left: "\\(", right: "\\)", display: false},
                                               {left: "\\[", right: "\\]", display: true}]});
});
