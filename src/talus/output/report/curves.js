// Curves of history.csv (#history) and gauges.csv (#gauges) as #charts describes them, to be read off. A click shows the particles at that instant.
"use strict";

(() => {
  const charts = JSON.parse(document.getElementById("charts").textContent);
  const tables = {};
  const rows_of = (id) => tables[id] ??= document.getElementById(id).textContent.trim().split("\n").slice(1).map((r) => r.split(",").map(Number));
  let instant = NaN;

  const plain = (v) => String(Number(v.toPrecision(6)));
  // Beside an axis what rounding leaves of 0 is 0.
  const beside = (range) => (v, granularity, options, graph) => {
    const [low, high] = range(graph);
    if (Math.abs(v) < 1e-9 * (high - low)) return "0";
    return Math.abs(v) < 1e6 ? plain(v) : v.toExponential(3).replace(/\.?0*e\+/, "e");
  };

  window.talus_curves = charts.map((chart) => {
    const place = document.getElementById("chart-" + chart.name);
    const drawn = new Dygraph(place, rows_of(chart.rows).map((r) => [r[chart.x_column - 1] * chart.x_scale, ...chart.curves.map((c) => r[c.column - 1] * chart.y_scale)]), {
      labels: [chart.x_label, ...chart.curves.map((c) => c.label)],
      xlabel: chart.x_label,
      ylabel: chart.y_label,
      colors: chart.curves.map((c) => c.colour),
      strokeWidth: 2,
      legend: "always",
      labelsDiv: document.getElementById("legend-" + chart.name),
      highlightCircleSize: 4,
      gridLineColor: "#e0e0e0",
      axisLineColor: "#888",
      yRangePad: 6,
      axes: {x: {valueFormatter: (v) => `${chart.x_label.split(" ")[0]} ${plain(v)} s`,
                 axisLabelFormatter: beside((graph) => graph.xAxisRange()), pixelsPerLabel: 70},
             y: {valueFormatter: plain, axisLabelFormatter: beside((graph) => graph.yAxisRange()), axisLabelWidth: 70}},
      underlayCallback: (pen, area, graph) => {
        const x = graph.toDomXCoord(instant);
        if (!(x >= area.x && x <= area.x + area.w)) return;
        pen.strokeStyle = "#888";
        pen.beginPath();
        pen.moveTo(x, area.y);
        pen.lineTo(x, area.y + area.h);
        pen.stroke();
      },
      clickCallback: (event, x) => document.dispatchEvent(new CustomEvent("seek", {detail: x / chart.x_scale})),
    });
    return drawn;
  });

  document.addEventListener("instant", (event) => {
    instant = event.detail;
    for (const drawn of window.talus_curves) drawn.updateOptions({});
  });
})();
