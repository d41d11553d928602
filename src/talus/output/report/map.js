// The map of a run on terrain. Everything stands in the page:
//   #map-scene                       JSON: pixels, layers and frames with the scales of what is packed, overlays
//   #map-heights                     packed heights of the ground, 16 bits between lowest and highest
//   #map-LAYER, #map-thickness-N, #map-speed-N   packed maps, half precision times 2^exponent
// "Packed" as in viewer.js; map_view.cpp packs. Rows run from the south. Places count from scene.origin.
"use strict";

(async () => {
  const by_id = (id) => document.getElementById(id), scene = JSON.parse(by_id("map-scene").textContent);
  const {ground, pixels, frames, layers} = scene, canvas = by_id("map_canvas"), stage = by_id("map_stage"), pen = canvas.getContext("2d");
  if (typeof DecompressionStream === "undefined") { by_id("map_view").hidden = true; return; }

  async function unpack(id) {
    const text = atob(by_id(id).textContent), packed = Uint8Array.from(text, (c) => c.charCodeAt(0));
    const stream = new Blob([packed]).stream().pipeThrough(new DecompressionStream("deflate"));
    const bytes = new Uint8Array(await new Response(stream).arrayBuffer()), n = bytes.length / 2, words = new Uint16Array(n);
    for (let i = 0, word = 0; i < n; ++i) words[i] = word = (word + (bytes[i] << 8 | bytes[n + i])) & 0xffff;
    return words;
  }
  const half = (w) => {  // IEEE 754 binary16
    const exponent = w >> 10 & 31, fraction = w & 1023;
    return (w & 0x8000 ? -1 : 1) * (exponent === 31 ? (fraction ? NaN : Infinity)
      : exponent ? 2 ** (exponent - 15) * (1 + fraction / 1024) : 2 ** -24 * fraction);
  };
  const kept = new Map();
  function values_of(id, {exponent}) {
    if (!kept.has(id)) kept.set(id, unpack(id).then((words) => Float32Array.from(words, (w) => half(w) * 2 ** exponent)));
    return kept.get(id);
  }

  const round_step = (x) => {
    const ten = 10 ** Math.floor(Math.log10(x));
    return ten * [1, 2, 5, 10].find((m) => m * ten >= x * (1 - 1e-9));
  };
  const short = (x) => String(Number(x.toPrecision(3)));
  const grouped = (x) => Math.round(x).toString().replace(/\B(?=(\d{3})+$)/g, "\u2009");

  // plasma (Smith and van der Walt 2015, CC0) from light to dark, as in the pictures: even to the eye.
  const samples = [[240, 249, 33], [253, 180, 47], [237, 121, 83], [204, 71, 120], [156, 23, 158], [92, 1, 166], [13, 8, 135]];
  const colour_at = (t) => {
    const i = Math.min(5, Math.floor(6 * t)), w = 6 * t - i;
    return samples[i].map((s, k) => Math.round(s * (1 - w) + samples[i + 1][k] * w));
  };
  // Change of the surface: blue where it has sunk, red where it has risen, as in the pictures.
  const about_zero = [[5, 48, 97], [33, 102, 172], [116, 173, 209], [244, 165, 130], [178, 24, 43], [103, 0, 31]];
  // Limits of classes: round numbers; of pressure 1, 3, 10, 30, ...
  function classes_of(layer) {
    const range = layer.packed.range || [0, 0, 1, 1], most = range[3] > 0 ? range[3] : 1;
    if (layer.scale === "logarithmic") {
      const all = [];
      for (let e = -3; e < 9; ++e) for (const m of [1, 3]) if (m * 10 ** e < most) all.push(m * 10 ** e);
      return [0, ...all.slice(-7)];
    }
    if (layer.scale === "about_zero") {
      const either = Math.max(-range[0], range[3]) || 1, wide = round_step(either / 5), n = Math.ceil(either / wide - 1e-9);
      return Array.from({length: 2 * n}, (_, i) => (i - n) * wide);
    }
    const step = round_step(most / 9);
    return Array.from({length: Math.max(1, Math.ceil(most / step - 1e-9))}, (_, i) => i * step);
  }
  const thickness = layers.find((l) => l.id === "pft"), speed = layers.find((l) => l.id === "pfv");
  const choices = [...layers.map((l) => ({...l, classes: classes_of(l)})),
    {id: "thickness", name: "Thickness in time", unit: "m", in_time: true, classes: classes_of(thickness)},
    {id: "speed", name: "Speed in time", unit: "m/s", in_time: true, classes: classes_of(speed)}];
  const is_thickness = (c) => c.id === "pft" || c.id === "deposit" || c.id === "thickness";
  const is_drawn = (c, v) => Number.isFinite(v) && (c.scale === "about_zero" ? Math.abs(v) > scene.least_thickness : !is_thickness(c) || v > scene.least_thickness);
  const class_of = (c, v) => { let k = 0; while (k + 1 < c.classes.length && v >= c.classes[k + 1]) ++k; return k; };
  const colour_of = (c, k) => {
    const n = c.classes.length;
    if (c.scale !== "about_zero") return colour_at(n > 1 ? k / (n - 1) : 0.5);
    const half = n / 2, from_zero = k < half ? half - 1 - k : k - half;  // three colours either way
    const t = half > 1 ? 2 * from_zero / (half - 1) : 1, i = Math.min(1, Math.floor(t)), w = t - i;
    const [a, b] = k < half ? [about_zero[2 - i], about_zero[1 - i]] : [about_zero[3 + i], about_zero[4 + i]];
    return a.map((s, m) => Math.round(s * (1 - w) + b[m] * w));
  };

  // ---- the ground ---------------------------------------------------------------------------------------------------

  const z = Float64Array.from(await unpack("map-heights"), (w) => ground.low + w * ground.step);
  for (const i of ground.gaps) z[i] = NaN;
  const shade = document.createElement("canvas");
  shade.width = ground.columns;
  shade.height = ground.rows;
  {  // light from the north-west, at 45 degrees
    const paper = shade.getContext("2d"), image = paper.createImageData(ground.columns, ground.rows);
    for (let r = 0; r < ground.rows; ++r)
      for (let c = 0; c < ground.columns; ++c) {
        const at = (i, k) => z[Math.max(0, Math.min(ground.rows - 1, k)) * ground.columns + Math.max(0, Math.min(ground.columns - 1, i))];
        const dx = (at(c + 1, r) - at(c - 1, r)) / (2 * ground.pixel), dy = (at(c, r + 1) - at(c, r - 1)) / (2 * ground.pixel);
        const lit = (0.5 * dx - 0.5 * dy + Math.SQRT1_2) / Math.sqrt(1 + dx * dx + dy * dy);
        const grey = Number.isNaN(lit) ? 255 : Math.max(90, Math.min(250, 205 + 160 * (lit - Math.SQRT1_2)));
        image.data.set([grey, grey, grey, 255], 4 * ((ground.rows - 1 - r) * ground.columns + c));
      }
    paper.putImageData(image, 0, 0);
  }
  function height_at(x, y) {  // between the middles of pixels
    const u = (x - ground.corner[0]) / ground.pixel - 0.5, v = (y - ground.corner[1]) / ground.pixel - 0.5;
    const c = Math.max(0, Math.min(ground.columns - 2, Math.floor(u))), r = Math.max(0, Math.min(ground.rows - 2, Math.floor(v)));
    const a = Math.max(0, Math.min(1, u - c)), b = Math.max(0, Math.min(1, v - r)), i = r * ground.columns + c, j = i + ground.columns;
    return (1 - b) * ((1 - a) * z[i] + a * z[i + 1]) + b * ((1 - a) * z[j] + a * z[j + 1]);
  }

  // Lines of equal height in a part of the ground, cell by cell.
  let contours = null;
  function find_contours(low, high) {
    const range = [Infinity, -Infinity];
    const c0 = Math.max(0, Math.floor((low[0] - ground.corner[0]) / ground.pixel) - 1), c1 = Math.min(ground.columns - 1, Math.ceil((high[0] - ground.corner[0]) / ground.pixel) + 1);
    const r0 = Math.max(0, Math.floor((low[1] - ground.corner[1]) / ground.pixel) - 1), r1 = Math.min(ground.rows - 1, Math.ceil((high[1] - ground.corner[1]) / ground.pixel) + 1);
    for (let r = r0; r < r1; ++r) for (let c = c0; c < c1; ++c) { const h = z[r * ground.columns + c]; if (h < range[0]) range[0] = h; if (h > range[1]) range[1] = h; }
    const interval = range[1] > range[0] ? round_step((range[1] - range[0]) / 22) : 0, thin = new Path2D(), thick = new Path2D(), labels = [];
    if (interval > 0)
      for (let r = r0; r < r1; ++r)
        for (let c = c0; c < c1; ++c) {
          const i = r * ground.columns + c, h = [z[i], z[i + 1], z[i + ground.columns + 1], z[i + ground.columns]];
          const least = Math.min(...h), most = Math.max(...h);
          for (let n = Math.ceil(least / interval); n * interval <= most; ++n) {
            const level = (n - 2e-3) * interval, ends = [];
            for (let k = 0; k < 4; ++k) {
              const a = h[k], b = h[(k + 1) % 4];
              if ((a < level) === (b < level)) continue;
              const t = (level - a) / (b - a), p = [[t, 0], [1, t], [1 - t, 1], [0, 1 - t]][k];
              ends.push([ground.corner[0] + (c + 0.5 + p[0]) * ground.pixel, ground.corner[1] + (r + 0.5 + p[1]) * ground.pixel]);
            }
            const path = n % 5 === 0 ? thick : thin;
            for (let k = 0; k + 1 < ends.length; k += 2) {
              path.moveTo(...ends[k]);
              path.lineTo(...ends[k + 1]);
              if (n % 5 === 0) labels.push({level: n * interval, at: ends[k], angle: Math.atan2(ends[k + 1][1] - ends[k][1], ends[k + 1][0] - ends[k][0])});
            }
          }
        }
    contours = {low, high, interval, thin, thick, labels, scale: view.scale};
  }

  // ---- the view ------------------------------------------------------------------------------------------------------

  const whole = {low: ground.corner, high: [ground.corner[0] + ground.columns * ground.pixel, ground.corner[1] + ground.rows * ground.pixel]};
  const flow = {low: pixels.corner, high: [pixels.corner[0] + pixels.columns * pixels.pixel, pixels.corner[1] + pixels.rows * pixels.pixel]};
  const view = {x: 0, y: 0, scale: 1};  // middle [m], pixels a metre
  let width = 0, height = 0, room = {w: 0, h: 0}, choice = choices[0], now = 0, values = null, picture = null, pinned = null, asked = 0;
  const to_screen = ([x, y]) => [room.w / 2 + (x - view.x) * view.scale, room.h / 2 - (y - view.y) * view.scale];
  const to_ground = (u, v) => [view.x + (u - room.w / 2) / view.scale, view.y - (v - room.h / 2) / view.scale];
  const scale_for = (box, margin) => Math.min(room.w / (box.high[0] - box.low[0]), room.h / (box.high[1] - box.low[1])) / margin;
  function show_box(box, margin) {
    view.scale = scale_for(box, margin);
    [view.x, view.y] = [0, 1].map((a) => (box.low[a] + box.high[a]) / 2);
    draw();
  }
  function zoom(factor, u = room.w / 2, v = room.h / 2) {
    const at = to_ground(u, v), before = view.scale;
    view.scale = Math.max(Math.min(before, 0.9 * scale_for(whole, 1)), Math.min(40 / Math.min(pixels.pixel, ground.pixel), before * factor));
    const moved = to_ground(u, v);
    view.x += at[0] - moved[0];
    view.y += at[1] - moved[1];
    draw();
    return view.scale !== before;
  }
  function resize() {
    const sharp = window.devicePixelRatio || 1;
    width = stage.clientWidth;
    height = stage.clientHeight;
    canvas.width = width * sharp;
    canvas.height = height * sharp;
    room = width < 640 ? {w: width, h: height - 84} : {w: width - 190, h: height};
  }

  // ---- drawing -------------------------------------------------------------------------------------------------------

  let waiting = false;
  function draw() {
    if (waiting) return;
    waiting = true;
    requestAnimationFrame(() => { waiting = false; paint(); });
  }
  function paint() {
    const sharp = window.devicePixelRatio || 1;
    pen.setTransform(sharp, 0, 0, sharp, 0, 0);
    pen.fillStyle = "#fff";
    pen.fillRect(0, 0, width, height);
    pen.save();
    pen.beginPath();
    pen.rect(0, 0, room.w, room.h);
    pen.clip();
    const place = (image, box, smooth) => {
      const [u, v] = to_screen([box.low[0], box.high[1]]);
      pen.imageSmoothingEnabled = smooth;
      pen.drawImage(image, u, v, (box.high[0] - box.low[0]) * view.scale, (box.high[1] - box.low[1]) * view.scale);
    };
    place(shade, whole, true);
    if (picture) { pen.globalAlpha = 0.82; place(picture, flow, false); pen.globalAlpha = 1; }
    const low = to_ground(0, room.h), high = to_ground(room.w, 0);
    if (!contours || contours.scale !== view.scale || [0, 1].some((a) => low[a] < contours.low[a] || high[a] > contours.high[a]))
      find_contours(low.map((l, a) => l - 0.25 * (high[a] - l)), high.map((h, a) => h + 0.25 * (h - low[a])));
    pen.save();
    pen.transform(view.scale, 0, 0, -view.scale, room.w / 2 - view.x * view.scale, room.h / 2 + view.y * view.scale);
    pen.strokeStyle = "#7a6450";
    for (const [path, w] of [[contours.thin, 0.6], [contours.thick, 1.4]]) { pen.lineWidth = w / view.scale; pen.stroke(path); }
    pen.restore();
    draw_heights();
    draw_overlays();
    draw_frame();
    if (pinned) {
      const [u, v] = to_screen(pinned);
      pen.strokeStyle = "#000"; pen.lineWidth = 1.5; pen.beginPath();
      pen.moveTo(u - 9, v); pen.lineTo(u + 9, v); pen.moveTo(u, v - 9); pen.lineTo(u, v + 9); pen.stroke();
    }
    pen.restore();
    pen.strokeStyle = "#777"; pen.lineWidth = 1; pen.strokeRect(0.5, 0.5, room.w - 1, room.h - 1);
    draw_legend();
  }
  function text(words, u, v, align = "left", colour = "#222") {
    pen.textAlign = align; pen.textBaseline = "middle"; pen.lineJoin = "round";
    pen.strokeStyle = "#ffffffd0"; pen.lineWidth = 3.5; pen.strokeText(words, u, v);
    pen.fillStyle = colour; pen.fillText(words, u, v);
  }
  function draw_heights() {
    pen.font = "11px system-ui, sans-serif";
    const placed = [];
    for (const l of contours.labels) {
      const [u, v] = to_screen(l.at);
      if (u < 30 || v < 20 || u > room.w - 30 || v > room.h - 40) continue;
      if (placed.some((p) => Math.hypot(p.u - u, p.v - v) < (p.level === l.level ? 320 : 70))) continue;
      placed.push({u, v, level: l.level});
      let angle = -l.angle;
      if (angle > Math.PI / 2) angle -= Math.PI;
      if (angle < -Math.PI / 2) angle += Math.PI;
      pen.save(); pen.translate(u, v); pen.rotate(angle); text(grouped(l.level), 0, 0, "center", "#3d2f22"); pen.restore();
    }
  }
  const pens = {release: ["#d01c1c", 2.5, []], zone: ["#1b6e3c", 1.8, [6, 4]], line: ["#00509e", 2.2, []], point: ["#00509e", 2, []], solid: ["#1a1a1a", 2.2, []]};
  function draw_overlays() {
    for (const {name, kind, lines} of scene.overlays) {
      const [colour, w, dashes] = pens[kind];
      for (const line of lines) {
        const at = line.map(to_screen);
        pen.beginPath();
        if (kind === "point") pen.arc(...at[0], 5, 0, 7); else at.forEach((p, i) => i ? pen.lineTo(...p) : pen.moveTo(...p));
        pen.setLineDash([]); pen.strokeStyle = "#fff"; pen.lineWidth = w + 2.5; pen.stroke();
        pen.setLineDash(dashes); pen.strokeStyle = colour; pen.lineWidth = w; pen.stroke();
        pen.setLineDash([]);
        pen.font = "bold 12px system-ui, sans-serif";
        // Names of solids stand east of them.
        const named = kind === "solid" ? [at.reduce((p, q) => q[0] > p[0] ? q : p)] : at;
        if (["line", "point", "solid"].includes(kind) && line === lines[0]) text(name, ...place_of_name(named, pen.measureText(name).width), "left", colour);
      }
    }
  }
  // Where the name of a line or point fits into the map, beside the coordinates along its edges: as near as possible to
  // the line's beginning, which may be outside.
  function place_of_name(line, width) {
    const beside = (u, v) => [u + 9, v - 9];
    for (let i = 0; i < line.length; ++i) {
      const from = line[i], to = line[Math.min(i + 1, line.length - 1)], far = Math.hypot(to[0] - from[0], to[1] - from[1]);
      const n = Math.min(2000, Math.ceil(far / 8)) || 1;
      for (let k = 0; k < n; ++k) {
        const [u, v] = beside(from[0] + k / n * (to[0] - from[0]), from[1] + k / n * (to[1] - from[1]));
        if (u > 76 && u + width < room.w - 4 && v > 10 && v < room.h - 60) return [u, v];
      }
    }
    return beside(...line[0]);
  }
  // Coordinates along the edges, scale bar, north.
  function draw_frame() {
    pen.font = "11px system-ui, sans-serif";
    const step = round_step(110 / view.scale), low = to_ground(0, room.h), high = to_ground(room.w, 0);
    for (const a of [0, 1])
      for (let n = Math.ceil((low[a] + scene.origin[a]) / step); n * step < high[a] + scene.origin[a]; ++n) {
        const [u, v] = to_screen(a ? [low[0], n * step - scene.origin[1]] : [n * step - scene.origin[0], low[1]]);
        if (a ? v > room.h - 60 || v < 12 : u < 70 || u > room.w - 30) continue;
        text(grouped(n * step), a ? 8 : u, a ? v : room.h - 10, a ? "left" : "center", "#333");
        pen.fillRect(a ? 0 : u - 0.5, a ? v - 0.5 : room.h - 5, a ? 5 : 1, a ? 1 : 5);
      }
    const length = round_step(70 / view.scale), w = length * view.scale;
    pen.fillStyle = "#ffffffd0"; pen.fillRect(8, room.h - 48, w + 16, 28);
    pen.fillStyle = "#222"; pen.fillRect(16, room.h - 28, w, 4);
    text(length >= 1000 ? `${length / 1000} km` : `${short(length)} m`, 16 + w / 2, room.h - 39, "center");
    const u = room.w - 22;
    pen.fillStyle = "#222"; pen.strokeStyle = "#fff"; pen.lineWidth = 2; pen.beginPath();
    pen.moveTo(u, 10); pen.lineTo(u + 9, 38); pen.lineTo(u, 31); pen.lineTo(u - 9, 38); pen.closePath(); pen.stroke(); pen.fill();
    pen.font = "bold 13px system-ui, sans-serif"; text("N", u, 48, "center");
  }
  function draw_legend() {
    const limits = choice.classes, last = limits.length - 1, title = `${choice.name} [${choice.unit}]`;
    const first = is_thickness(choice) ? scene.least_thickness : limits[0];
    const css = (k) => `rgb(${colour_of(choice, k).map((c) => Math.round(0.82 * c + 0.18 * 205)).join()})`;
    const others = [...new Map(scene.overlays.map((o) => [o.kind + o.name, o])).values()].filter((o) => o.kind === "release" || o.kind === "zone");
    const key = (o, u, v) => { const [c, w, d] = pens[o.kind]; pen.setLineDash(d); pen.strokeStyle = c; pen.lineWidth = w; pen.beginPath(); pen.moveTo(u, v); pen.lineTo(u + 22, v); pen.stroke(); pen.setLineDash([]); };
    pen.fillStyle = "#222"; pen.textBaseline = "middle"; pen.textAlign = "left";
    if (room.w < width) {
      const x = room.w + 16;
      pen.font = "bold 13px system-ui, sans-serif"; pen.fillText(choice.name, x, 14); pen.font = "13px system-ui, sans-serif"; pen.fillText(`[${choice.unit}]`, x, 32);
      limits.forEach((l, i) => {
        const k = last - i, y = 48 + 22 * i;
        pen.fillStyle = css(k); pen.fillRect(x, y, 26, 20);
        pen.fillStyle = "#222"; pen.fillText(`${short(k ? limits[k] : first)}${k === last && last ? " and more" : last ? (first < 0 ? " to " : " \u2013 ") + short(limits[k + 1]) : " and more"}`, x + 34, y + 11);
      });
      let y = 64 + 22 * limits.length;
      for (const o of others) { key(o, x, y); pen.fillStyle = "#222"; pen.fillText(o.name, x + 30, y); y += 22; }
      pen.strokeStyle = "#7a6450"; pen.lineWidth = 1; pen.beginPath(); pen.moveTo(x, y); pen.lineTo(x + 22, y); pen.stroke();
      pen.fillText(`Contours: ${short(contours.interval)} m`, x + 30, y);
      return;
    }
    const w = (width - 24) / limits.length, y = room.h + 24;
    pen.font = "bold 12px system-ui, sans-serif"; pen.fillText(title, 4, room.h + 12);
    pen.font = "11px system-ui, sans-serif";
    limits.forEach((l, k) => { pen.fillStyle = css(k); pen.fillRect(4 + w * k, y, w, 14); pen.fillStyle = "#222"; pen.fillText(short(k ? l : first), 4 + w * k, y + 23); });
    let x = 4;
    for (const o of others) { key(o, x, y + 44); pen.fillStyle = "#222"; pen.fillText(o.name, x + 26, y + 44); x += 40 + pen.measureText(o.name).width; }
    pen.fillText(`Contours: ${short(contours.interval)} m`, x, y + 44);
  }

  // ---- what is shown -------------------------------------------------------------------------------------------------

  async function show() {
    const mine = ++asked, c = choice;
    const got = c.in_time ? await values_of(`map-${c.id}-${now}`, frames[now][c.id]) : await values_of("map-" + c.id, c.packed);
    if (mine !== asked) return;
    values = got;
    picture = picture || Object.assign(document.createElement("canvas"), {width: pixels.columns, height: pixels.rows});
    const paper = picture.getContext("2d"), image = paper.createImageData(pixels.columns, pixels.rows);
    for (let r = 0; r < pixels.rows; ++r)
      for (let i = 0; i < pixels.columns; ++i) {
        const v = values[r * pixels.columns + i];
        if (is_drawn(c, v)) image.data.set([...colour_of(c, class_of(c, v)), 255], 4 * ((pixels.rows - 1 - r) * pixels.columns + i));
      }
    paper.putImageData(image, 0, 0);
    by_id("map_layer").value = choices.indexOf(c);
    by_id("map_instant").value = now;
    by_id("map_time").value = c.in_time ? `t = ${short(frames[now].time)} s` : "whole run";
    if (c.in_time) document.dispatchEvent(new CustomEvent("instant", {detail: frames[now].time}));
    if (pinned) read(pinned);
    draw();
  }
  const value_at = ([x, y]) => {
    const c = Math.floor((x - pixels.corner[0]) / pixels.pixel), r = Math.floor((y - pixels.corner[1]) / pixels.pixel);
    return c < 0 || r < 0 || c >= pixels.columns || r >= pixels.rows ? NaN : values[r * pixels.columns + c];
  };
  function read(at) {
    const v = value_at(at), h = height_at(...at);
    const what = Number.isNaN(v) || (v === 0 && is_thickness(choice)) ? "none" : `${short(v)} ${choice.unit}`;
    by_id("map_reading").textContent = `${choice.name}: ${what}; ground ${Number.isNaN(h) ? "unknown" : h.toFixed(1) + " m"}; ` +
      `east ${(at[0] + scene.origin[0]).toFixed(1)}, north ${(at[1] + scene.origin[1]).toFixed(1)} m (${scene.projection})`;
  }
  const in_time = () => { if (!choice.in_time) choice = choices.find((c) => c.id === "thickness"); };
  const player = window.talus_player(by_id("map_play"), async () => {
    in_time();
    now = (now + 1) % frames.length;
    await show();
    return now === frames.length - 1 ? 900 : 130;
  });

  // ---- hands on ------------------------------------------------------------------------------------------------------

  const on = (id, event, act) => by_id(id).addEventListener(event, act);
  choices.forEach((c, i) => { if (!c.in_time || frames.length) by_id("map_layer").add(new Option(`${c.name} [${c.unit}]`, i)); });
  by_id("map_instant").max = Math.max(0, frames.length - 1);
  on("map_layer", "change", () => { choice = choices[by_id("map_layer").value]; if (!choice.in_time) player.stop(); show(); });
  on("map_instant", "input", () => { player.stop(); in_time(); now = Number(by_id("map_instant").value); show(); });
  on("map_in", "click", () => zoom(1.6));
  on("map_out", "click", () => zoom(1 / 1.6));
  on("map_flow", "click", () => show_box(flow, 1.15));
  on("map_all", "click", () => show_box(whole, 1));
  on("map_save", "click", () => {
    paint();
    Object.assign(document.createElement("a"), {href: canvas.toDataURL("image/png"), download: `${choice.id}.png`}).click();
  });
  document.addEventListener("seek", (event) => {
    if (!choice.in_time) return;
    player.stop();
    const distance = frames.map((f) => Math.abs(f.time - event.detail));
    now = distance.indexOf(Math.min(...distance));
    show();
  });
  const down = new Map();
  let moved = false;
  canvas.addEventListener("pointerdown", (e) => { canvas.setPointerCapture(e.pointerId); down.set(e.pointerId, [e.offsetX, e.offsetY]); moved = down.size > 1; });
  canvas.addEventListener("pointermove", (e) => {
    const was = down.get(e.pointerId), is = [e.offsetX, e.offsetY];
    if (!was) { if (values) read(to_ground(...is)); return; }
    if (down.size === 1 && !moved && Math.hypot(is[0] - was[0], is[1] - was[1]) < 5) return;
    moved = true;
    const other = [...down].find(([id]) => id !== e.pointerId);
    down.set(e.pointerId, is);
    if (other) {
      const o = other[1], d = (p) => Math.max(20, Math.hypot(p[0] - o[0], p[1] - o[1]));
      zoom(d(is) / d(was), (is[0] + o[0]) / 2, (is[1] + o[1]) / 2);
    }
    const share = other ? 0.5 : 1;
    view.x -= share * (is[0] - was[0]) / view.scale;
    view.y += share * (is[1] - was[1]) / view.scale;
    draw();
  });
  canvas.addEventListener("pointerup", (e) => {
    down.delete(e.pointerId);
    if (!moved && values) { pinned = to_ground(e.offsetX, e.offsetY); read(pinned); draw(); }
  });
  canvas.addEventListener("pointercancel", (e) => down.delete(e.pointerId));
  canvas.addEventListener("pointerleave", () => { if (pinned && values) read(pinned); });
  canvas.addEventListener("wheel", (e) => { if (zoom(Math.exp(-0.0015 * e.deltaY), e.offsetX, e.offsetY)) e.preventDefault(); }, {passive: false});
  window.addEventListener("resize", () => { resize(); draw(); });

  // For scripts that drive the page.
  window.talus_map = {
    state: () => ({layer: choice.id, frame: now, frames: frames.length, time: frames.length ? frames[now].time : NaN, ready: values !== null, scale: view.scale}),
    value_at: (east, north) => value_at([east - scene.origin[0], north - scene.origin[1]]),
    screen: (east, north) => to_screen([east - scene.origin[0], north - scene.origin[1]]),
  };
  resize();
  show_box(flow, 1.15);
  show();
})();
