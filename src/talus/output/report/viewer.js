// The particles of a run through time. Everything stands in the page:
//   #scene               JSON: quantities, frames with their times, ranges and the scales of what is packed
//   #place-FRAME-AXIS    packed places along an axis, 16 bits within the frame's bounding box
//   #solid-SOLID-AXIS    the same of points on a solid's surface as it stood at first; frames hold its poses
//   #value-FRAME-Q-C     packed component C of quantity Q, half precision times 2^exponent
// "Packed" is base64 of zlib of the differences between neighbouring particles, high bytes first; viewer.cpp packs.
"use strict";

(() => {
  const by_id = (id) => document.getElementById(id);
  const scene = JSON.parse(by_id("scene").textContent);
  const frames = scene.frames, flat = scene.dim === 2, up = scene.dim - 1;

  // ---- unpacking -----------------------------------------------------------------------------------------------

  async function unpack(id) {
    const text = atob(by_id(id).textContent), packed = new Uint8Array(text.length);
    for (let i = 0; i < text.length; ++i) packed[i] = text.charCodeAt(i);
    const stream = new Blob([packed]).stream().pipeThrough(new DecompressionStream("deflate"));
    const bytes = new Uint8Array(await new Response(stream).arrayBuffer());
    const n = bytes.length / 2, words = new Uint16Array(n);
    for (let i = 0, word = 0; i < n; ++i) words[i] = word = (word + (bytes[i] << 8 | bytes[n + i])) & 0xffff;
    return words;
  }

  // What was unpacked lately; the oldest goes first.
  const kept = new Map(), most_kept = 120;
  function keep(key, make) {
    const found = kept.get(key) || make();
    kept.delete(key);
    kept.set(key, found);
    if (kept.size > most_kept) kept.delete(kept.keys().next().value);
    return found;
  }

  const half = new Float32Array(65536);  // IEEE 754 binary16
  for (let i = 0; i < 65536; ++i) {
    const exponent = i >> 10 & 31, fraction = i & 1023;
    half[i] = (i & 0x8000 ? -1 : 1) * (exponent === 31 ? (fraction ? NaN : Infinity)
      : exponent ? 2 ** (exponent - 15) * (1 + fraction / 1024) : 2 ** -24 * fraction);
  }

  async function unpack_places(id, {n, low, step_of_place}) {
    const axes = await Promise.all([0, 1, 2].map((a) => unpack(`${id}-${a}`))), out = new Float32Array(3 * n);
    for (let a = 0; a < 3; ++a)
      for (let i = 0; i < n; ++i) out[3 * i + a] = low[a] - origin[a] + step_of_place[a] * axes[a][i];
    return out;
  }
  const places = (f) => keep("places " + f, () => unpack_places("place-" + f, frames[f]));

  const component = (f, q, c) => keep(`value ${f} ${q} ${c}`, async () => {
    const words = await unpack(`value-${f}-${q}-${c}`), unit = 2 ** frames[f].values[q][c].exponent;
    return Float32Array.from(words, (w) => half[w] * unit);
  });

  async function values(f, colour) {
    if (colour.c >= 0) return component(f, colour.q, colour.c);
    const [x, y, z] = await Promise.all([0, 1, 2].map((c) => component(f, colour.q, c)));
    return x.map((v, i) => Math.hypot(v, y[i], z[i]));
  }

  // What particles can be coloured by: scalars, vectors by magnitude and component, tensors by component.
  // Symbols stand beside words; other quantities are named by words already.
  const words_of = {p: "mean pressure", q: "von Mises stress", kappa: "plastic strain", I: "inertial number", mu: "friction coefficient",
                    e_c: "critical void ratio", f_Phi: "momentum exchange", lode: "Lode angle", p_col: "collisional pressure",
                    p_f: "frictional pressure", q_f: "frictional von Mises stress", phi_p: "peak friction angle",
                    phi_pt: "phase transformation angle"};
  const label_of = (name) => {
    const words = words_of[name.split(" ")[0]];
    return words ? `${words} ${name}` : name.replaceAll("_", " ");
  };
  const colours = [];
  scene.quantities.forEach((quantity, q) => {
    const names = {1: [""], 3: [" x", " y", " z"], 6: [" xx", " yy", " zz", " xy", " yz", " zx"]}[quantity.components];
    if (quantity.components === 3) colours.push({q, c: -1, name: quantity.name + " magnitude"});
    names.forEach((name, c) => colours.push({q, c, name: quantity.name + name}));
  });
  const range_at = (f, colour) =>
    frames[f].values[colour.q][colour.c < 0 ? 3 : colour.c].range;  // [least, 1 %, 99 %, most], null where no value is

  // ---- lengths and numbers ---------------------------------------------------------------------------------------

  const box = {low: [0, 1, 2].map((a) => Math.min(...frames.map((f) => f.low[a]))),
               high: [0, 1, 2].map((a) => Math.max(...frames.map((f) => f.low[a] + 65535 * f.step_of_place[a])))};
  box.low[up] = Math.min(box.low[up], scene.floor);
  for (let a = 0; a < scene.dim; ++a) {
    box.high[a] += scene.spacing / 2;
    if (a !== up) box.low[a] -= scene.spacing / 2;
    if (!scene.solids.length) continue;
    const rim = 0.05 * (box.high[a] - box.low[a]);  // of what is around the particles
    box.high[a] += rim;
    box.low[a] -= rim;
  }
  const origin = box.low.map((l, a) => (l + box.high[a]) / 2);  // the pictures' own origin, so that 32 bits suffice
  for (const end of [box.low, box.high]) end.forEach((x, a) => { end[a] = x - origin[a]; });
  const extent = Math.max(...box.high.map((h, a) => h - box.low[a]));
  const [length_unit, per_metre] = extent < 2 ? ["mm", 1e3] : extent < 5000 ? ["m", 1] : ["km", 1e-3];

  const short = (x) => {
    if (x === 0) return "0";
    const size = Math.abs(x);
    return size >= 1e5 || size < 1e-3 ? x.toExponential(2).replace(/\.?0+e/, "e").replace("e+", "e")
                                      : String(Number(x.toPrecision(3)));
  };
  // 1, 2 or 5 times a power of ten, not less than x.
  const round_step = (x) => {
    const ten = 10 ** Math.floor(Math.log10(x));
    return ten * [1, 2, 5, 10].find((m) => m * ten >= x * (1 - 1e-9));
  };
  const ticks = (low, high, step) => {
    const out = [];
    for (let i = Math.ceil(low / step - 1e-6); i <= high / step + 1e-6; ++i) out.push(i * step);
    return out;
  };

  // ---- colour maps -----------------------------------------------------------------------------------------------

  // Both are perceptually uniform. viridis (Smith and van der Walt 2015, CC0): ten samples, as in the pictures.
  // cividis (Nunez, Anderton and Renslow 2018), made for the colour-blind: the polynomial of d3-scale-chromatic (ISC).
  const samples = [[68, 1, 84], [72, 40, 120], [62, 74, 137], [49, 104, 142], [38, 130, 142],
                   [31, 158, 137], [53, 183, 121], [109, 205, 89], [180, 222, 44], [253, 231, 37]];
  const maps = {
    viridis: (t) => {
      const i = Math.min(8, Math.floor(9 * t)), w = 9 * t - i;
      return samples[i].map((s, k) => s * (1 - w) + samples[i + 1][k] * w);
    },
    cividis: (t) => [
      -4.54 - t * (35.34 - t * (2381.73 - t * (6402.7 - t * (7024.72 - t * 2710.57)))),
      32.49 + t * (170.73 + t * (52.82 - t * (131.46 - t * (176.58 - t * 67.37)))),
      81.24 + t * (442.36 - t * (2482.43 - t * (6167.24 - t * (6614.94 - t * 2475.67))))],
  };
  const colour_at = (t) => maps[by_id("map").value](t).map((c) => Math.max(0, Math.min(255, Math.round(c))));
  const no_value = "#b0b0b0";

  // ---- the picture ---------------------------------------------------------------------------------------------------

  const stage = by_id("stage"), under = by_id("frame"), pen = under.getContext("2d"), canvas = by_id("particles");
  let bar_width = 130;  // of the colour scale
  const margin = {left: 80, right: 24, top: 24, bottom: 64};
  let renderer;
  try {
    if (typeof DecompressionStream === "undefined") throw new Error("DecompressionStream is missing");
    renderer = new THREE.WebGLRenderer({canvas, alpha: true, antialias: true, preserveDrawingBuffer: true});
    renderer.setClearColor(0xffffff, 0);  // the axes are beneath
  } catch (error) {
    by_id("viewer").hidden = true;
    by_id("without").hidden = false;
    return;
  }
  const camera = new THREE.OrthographicCamera(-1, 1, 1, -1, -10 * extent, 10 * extent);
  const controls = new THREE.OrbitControls(camera, canvas);
  controls.enableKeys = false;
  controls.screenSpacePanning = true;
  if (flat) {
    controls.enableRotate = false;
    controls.mouseButtons.LEFT = THREE.MOUSE.PAN;
    controls.touches.ONE = THREE.TOUCH.PAN;
  }

  const most = Math.max(...frames.map((f) => f.n));
  const geometry = new THREE.BufferGeometry();
  geometry.setAttribute("position", new THREE.BufferAttribute(new Float32Array(3 * most), 3));
  geometry.setAttribute("shade", new THREE.BufferAttribute(new Float32Array(most), 1));
  const material = new THREE.ShaderMaterial({
    uniforms: {
      diameter: {value: 1},                             // of a particle [pixels]
      plane: {value: new THREE.Vector4(0, 0, 0, 1)},    // shown is where plane.xyz . x <= plane.w
      map: {value: null},
      relief: {value: flat ? 0 : 0.45},                 // how much darker a sphere's rim is than its middle
    },
    vertexShader: `
      attribute float shade;
      uniform float diameter;
      uniform vec4 plane;
      varying float s;
      void main() {
        s = shade;
        gl_PointSize = max(diameter, 1.5);
        gl_Position = dot(plane.xyz, position) > plane.w ? vec4(2., 2., 2., 1.)
                                                         : projectionMatrix * modelViewMatrix * vec4(position, 1.);
      }`,
    fragmentShader: `
      uniform sampler2D map;
      uniform float relief;
      varying float s;
      void main() {
        vec2 d = 2. * gl_PointCoord - 1.;
        float r2 = dot(d, d);
        if (r2 > 1.) discard;
        vec3 colour = s < 0. ? vec3(.69) : texture2D(map, vec2((s * 255. + .5) / 256., .5)).rgb;
        gl_FragColor = vec4(colour * (1. - relief * (1. - sqrt(1. - r2))), 1.);
      }`,
  });
  const cloud = new THREE.Points(geometry, material);
  cloud.frustumCulled = false;
  const world = new THREE.Scene();
  world.add(cloud);

  // Solids: their surfaces as grey points, where they are in the box; in space one looks through between these.
  const grey = scene.solids.map((solid, k) => {
    const points = new THREE.BufferGeometry();
    const dots = new THREE.Points(points, new THREE.ShaderMaterial({
      uniforms: {
        diameter: {value: 1},
        plane: material.uniforms.plane,
        low: {value: new THREE.Vector3(...box.low)},
        high: {value: new THREE.Vector3(...box.high)},
      },
      vertexShader: `
        uniform float diameter;
        uniform vec4 plane;
        uniform vec3 low, high;
        void main() {
          vec3 x = (modelMatrix * vec4(position, 1.)).xyz;
          gl_PointSize = max(diameter, 1.5);
          bool shown = dot(plane.xyz, x) <= plane.w && (${flat} || all(equal(clamp(x, low, high), x)));
          gl_Position = shown ? projectionMatrix * viewMatrix * vec4(x, 1.) : vec4(2., 2., 2., 1.);
        }`,
      fragmentShader: "void main() { gl_FragColor = vec4(.3, .3, .3, 1.); }",
    }));
    dots.frustumCulled = dots.matrixAutoUpdate = dots.visible = false;
    world.add(dots);
    unpack_places("solid-" + k, solid).then((x) => {
      points.setAttribute("position", new THREE.BufferAttribute(x, 3));
      dots.visible = true;
      draw();
    });
    return dots;
  });
  function set_poses() {
    grey.forEach((dots, k) => {
      const p = frames[now].poses[k], [x, y, z] = origin, turned = [0, 4, 8].map((i) => p[i] * x + p[i + 1] * y + p[i + 2] * z);
      dots.matrix.set(p[0], p[1], p[2], p[3] + turned[0] - x, p[4], p[5], p[6], p[7] + turned[1] - y,
                      p[8], p[9], p[10], p[11] + turned[2] - z, 0, 0, 0, 1);
      dots.matrixWorldNeedsUpdate = true;
    });
  }

  let now = 0;                  // the frame shown
  let colour = colours[0];
  let ends = [0, 1];            // of the colour scale
  let shown = {places: null, values: null};
  let width = 0, height = 0;    // of the stage [CSS pixels]
  let asked = 0;                // counts what was asked for, so that a late answer is not shown

  const pixels_per_metre = () => (width - bar_width) * camera.zoom / (camera.right - camera.left);
  function on_screen(x) {
    const p = new THREE.Vector3(...x).project(camera);
    return [(p.x + 1) / 2 * (width - bar_width), (1 - p.y) / 2 * height];
  }

  // Turns the camera to look along a direction, with everything in view.
  function look(direction) {
    controls.target.set(0, 0, 0);
    camera.up.set(...(flat ? [0, 1, 0] : [0, 0, 1]));
    camera.position.set(...direction).multiplyScalar(extent);
    camera.zoom = 1;
    controls.update();
    fit();
    draw();
  }

  function fit() {
    camera.updateMatrixWorld();
    const right = new THREE.Vector3(), above = new THREE.Vector3();
    camera.matrixWorld.extractBasis(right, above, new THREE.Vector3());
    const size = (axis) => [0, 1, 2].reduce((sum, a) => sum + Math.abs(axis.getComponent(a)) * (box.high[a] - box.low[a]), 0);
    const w = width - bar_width, room_x = w - margin.left - margin.right, room_y = height - margin.top - margin.bottom;
    const metres = Math.max(size(right) / room_x, size(above) / room_y, 1e-12);  // a pixel
    // The middle of the box stands in the middle of the room.
    const dx = (margin.left - margin.right) / 2 * metres, dy = (margin.bottom - margin.top) / 2 * metres;
    camera.left = -w / 2 * metres - dx;
    camera.right = w / 2 * metres - dx;
    camera.top = height / 2 * metres - dy;
    camera.bottom = -height / 2 * metres - dy;
    camera.updateProjectionMatrix();
  }

  function resize() {
    width = stage.clientWidth;
    bar_width = width < 500 ? 106 : 130;
    margin.left = width < 500 ? 62 : 80;
    if (flat) {  // as high as the material needs at full width
      const high = (width - bar_width - margin.left - margin.right) * (box.high[1] - box.low[1]) / (box.high[0] - box.low[0]);
      stage.style.height = Math.max(240, Math.min(640, window.innerHeight - 270, high + margin.top + margin.bottom)) + "px";
    }
    height = stage.clientHeight;
    const sharp = window.devicePixelRatio || 1;
    under.width = width * sharp;
    under.height = height * sharp;
    under.style.width = width + "px";
    under.style.height = height + "px";
    renderer.setPixelRatio(sharp);
    renderer.setSize(width - bar_width, height);
    fit();
    draw();
  }

  function draw() {
    if (!shown.places) return;
    camera.updateMatrixWorld();
    pen.setTransform(window.devicePixelRatio || 1, 0, 0, window.devicePixelRatio || 1, 0, 0);
    pen.fillStyle = "#fff";
    pen.fillRect(0, 0, width, height);
    const inside = draw_axes();
    draw_bar();
    material.uniforms.diameter.value =
      scene.spacing * Number(by_id("size").value) * pixels_per_metre() * renderer.getPixelRatio();
    grey.forEach((dots, k) => {
      dots.material.uniforms.diameter.value =
        (flat ? 1.5 : 0.35) * scene.solids[k].spacing * pixels_per_metre() * renderer.getPixelRatio();
    });
    renderer.setScissorTest(flat);
    if (flat) renderer.setScissor(inside[0], height - inside[3], inside[2] - inside[0], inside[3] - inside[1]);
    renderer.setScissorTest(false);
    renderer.clear();
    renderer.setScissorTest(flat);
    renderer.render(world, camera);
  }

  // A box around the particles with a grid on its far sides, and numbers along its outline. Returns what of the screen
  // the box takes. Seen straight on, the box is the part that is in view.
  function draw_axes() {
    const low = [...box.low], high = [...box.high];
    if (flat) {
      const scale = pixels_per_metre(), [x0, y0] = on_screen([0, 0, 0]), w = width - bar_width;
      low[0] = Math.max(low[0], (margin.left - x0) / scale);
      high[0] = Math.min(high[0], (w - margin.right - x0) / scale);
      low[1] = Math.max(low[1], (y0 - (height - margin.bottom)) / scale);
      high[1] = Math.min(high[1], (y0 - margin.top) / scale);
      if (!(high[0] > low[0] && high[1] > low[1])) return [0, 0, 0, 0];
    }
    const view = camera.getWorldDirection(new THREE.Vector3());
    const front = (a, side) => -side * view.getComponent(a) > 1e-6;  // does the face look at us?
    const corner = (a, x, b, y, c, z) => { const p = []; p[a] = x; p[b] = y; p[c] = z; return on_screen(p); };
    const line = (p, q) => { pen.beginPath(); pen.moveTo(...p); pen.lineTo(...q); pen.stroke(); };
    const at = (a, side) => side < 0 ? low[a] : high[a];
    const others = (a) => [(a + 1) % 3, (a + 2) % 3];

    // The edge that carries the numbers, and steps that leave room for them.
    const axes = [];
    for (let a = 0; a < scene.dim; ++a) {
      const [b, c] = others(a);
      let best = null;
      for (const sb of [-1, 1])
        for (const sc of [-1, 1]) {
          if (front(b, sb) === front(c, sc)) continue;
          const p = corner(a, low[a], b, at(b, sb), c, at(c, sc)), q = corner(a, high[a], b, at(b, sb), c, at(c, sc));
          const merit = a === up ? -(p[0] + q[0]) : p[1] + q[1];
          if (!best || merit > best.merit) best = {p, q, merit};
        }
      if (!best) continue;
      const length = Math.hypot(best.q[0] - best.p[0], best.q[1] - best.p[1]);
      const spread = Math.abs(best.q[0] - best.p[0]) > length / 2 ? 70 : 36;  // numbers are wider than high
      const step = length > 25 ? round_step((high[a] - low[a]) * per_metre * spread / length) / per_metre : 0;
      axes.push({a, ...best, length,
                 ticks: step ? ticks(low[a] + origin[a], high[a] + origin[a], step).map((x) => x - origin[a]) : []});
    }
    pen.lineWidth = 1;
    pen.strokeStyle = "#e6e6e6";
    for (const {a, ticks: at_a} of axes)
      for (const b of others(a)) {
        const c = 3 - a - b;
        for (const side of [-1, 1])
          if (!front(c, side) && (front(c, -side) || flat))
            for (const x of at_a) line(corner(a, x, b, low[b], c, at(c, side)), corner(a, x, b, high[b], c, at(c, side)));
      }
    pen.strokeStyle = "#bbb";
    for (let a = 0; a < scene.dim; ++a) {
      const [b, c] = others(a);
      for (const sb of [-1, 1])
        for (const sc of [-1, 1])
          if (!(front(b, sb) && front(c, sc)))
            line(corner(a, low[a], b, at(b, sb), c, at(c, sc)), corner(a, high[a], b, at(b, sb), c, at(c, sc)));
    }

    const middle = on_screen(low.map((l, a) => (l + high[a]) / 2));
    pen.strokeStyle = pen.fillStyle = "#333";
    pen.textBaseline = "middle";
    for (const {a, p, q, length, ticks: at_a} of axes) {
      line(p, q);
      if (length < 1) continue;
      let out = [-(q[1] - p[1]) / length, (q[0] - p[0]) / length];  // across the edge, away from the middle
      const half_way = [(p[0] + q[0]) / 2, (p[1] + q[1]) / 2];
      if (out[0] * (half_way[0] - middle[0]) + out[1] * (half_way[1] - middle[1]) < 0) out = out.map((x) => -x);
      pen.font = "13px system-ui, sans-serif";
      pen.textAlign = Math.abs(out[0]) < 0.35 ? "center" : out[0] < 0 ? "right" : "left";
      let widest = 0;
      for (const x of at_a) {
        const w = (x - low[a]) / (high[a] - low[a]), t = [p[0] + w * (q[0] - p[0]), p[1] + w * (q[1] - p[1])];
        line(t, [t[0] + 5 * out[0], t[1] + 5 * out[1]]);
        const text = short(Number(((x + origin[a]) * per_metre).toPrecision(6)));
        widest = Math.max(widest, pen.measureText(text).width);
        pen.fillText(text, t[0] + 9 * out[0], t[1] + 14 * out[1]);
      }
      const away = 26 + Math.abs(out[0]) * widest + 6;
      pen.font = "bold 14px system-ui, sans-serif";
      const name = `${"xyz"[a]} [${length_unit}]`, title = [half_way[0] + away * out[0], half_way[1] + away * out[1]];
      if (Math.abs(out[0]) > 0.9) {
        pen.save();
        pen.translate(...title);
        pen.rotate(-Math.PI / 2);
        pen.textAlign = "center";
        pen.fillText(name, 0, 0);
        pen.restore();
      } else {
        pen.fillText(name, ...title);
      }
    }
    if (!flat) draw_ruler();
    return [...corner(0, low[0], 1, high[1], 2, 0), ...corner(0, high[0], 1, low[1], 2, 0)];
  }

  // How long a length is; true everywhere, because there is no perspective.
  function draw_ruler() {
    const length = round_step(60 / pixels_per_metre() * per_metre) / per_metre, pixels = length * pixels_per_metre();
    const x = 16, y = height - 16;
    pen.lineWidth = 2;
    pen.beginPath();
    pen.moveTo(x, y - 5); pen.lineTo(x, y); pen.lineTo(x + pixels, y); pen.lineTo(x + pixels, y - 5);
    pen.stroke();
    pen.font = "13px system-ui, sans-serif";
    pen.textAlign = "center";
    pen.fillText(`${short(length * per_metre)} ${length_unit}`, x + pixels / 2, y - 14);
    pen.lineWidth = 1;
  }

  const logarithmic = () => by_id("log").checked;
  const share = (v) => logarithmic() ? (v > 0 ? Math.log(v / ends[0]) / Math.log(ends[1] / ends[0]) : NaN)
                                     : (v - ends[0]) / (ends[1] - ends[0]);

  function draw_bar() {
    const x = width - bar_width + 14, w = 18, top = 70, bottom = height - 60, length = bottom - top;
    const css = (t) => `rgb(${colour_at(t).join()})`;
    for (let y = 0; y < length; ++y) {
      pen.fillStyle = css(1 - y / (length - 1));
      pen.fillRect(x, top + y, w, 1.5);
    }
    // Pointed ends where values lie beyond.
    const beyond = shown.range || [ends[0], 0, 0, ends[1]];
    for (const [is, y, tip, t] of [[beyond[3] > ends[1], top, top - 12, 1], [beyond[0] < ends[0], bottom, bottom + 12, 0]]) {
      if (!is) continue;
      pen.fillStyle = css(t);
      pen.beginPath();
      pen.moveTo(x, y); pen.lineTo(x + w, y); pen.lineTo(x + w / 2, tip);
      pen.fill();
    }
    pen.strokeStyle = pen.fillStyle = "#333";
    pen.strokeRect(x, top, w, length);
    pen.font = "13px system-ui, sans-serif";
    pen.textAlign = "left";
    pen.textBaseline = "middle";
    let marks = [];
    if (!(ends[1] > ends[0])) marks = [ends[0]];
    else if (logarithmic()) {
      const least = Math.ceil(Math.log10(ends[0]) - 1e-9), last = Math.floor(Math.log10(ends[1]) + 1e-9);
      const every = Math.max(1, Math.ceil((last - least) / 8));
      for (let e = least; e <= last; e += every) marks.push(10 ** e);
      if (marks.length < 2) marks = [ends[0], Math.sqrt(ends[0] * ends[1]), ends[1]];
    } else marks = ticks(ends[0], ends[1], round_step((ends[1] - ends[0]) / 7));
    for (const v of marks) {
      const y = bottom - length * (ends[1] > ends[0] ? share(v) : 0);
      pen.beginPath();
      pen.moveTo(x + w, y); pen.lineTo(x + w + 4, y);
      pen.stroke();
      pen.fillText(short(Number(v.toPrecision(6))), x + w + 8, y);
    }
    pen.font = "bold 14px system-ui, sans-serif";
    const unit = scene.quantities[colour.q].unit, words = label_of(colour.name).split(" ");
    const lines = [""];  // the name, broken where it is too long
    for (const word of [...words, `[${unit === "1" ? "-" : unit}]`]) {
      const longer = (lines[lines.length - 1] + " " + word).trim();
      if (pen.measureText(longer).width > bar_width - 20 && lines[lines.length - 1]) lines.push(word);
      else lines[lines.length - 1] = longer;
    }
    lines.forEach((text, i) => pen.fillText(text, x, 16 + 17 * i));
    if (shown.without) {
      pen.fillStyle = no_value;
      pen.fillRect(x, bottom + 22, w, 14);
      pen.fillStyle = "#333";
      pen.font = "13px system-ui, sans-serif";
      pen.fillText("no value", x + w + 8, bottom + 29);
    }
  }

  // ---- what is shown -----------------------------------------------------------------------------------------------

  function set_ends() {
    const how = by_id("range").value, log = logarithmic();
    if (how === "own") {
      ends = [Number(by_id("low").value), Number(by_id("high").value)];
    } else {
      const ranges = (how === "now" ? [now] : frames.map((_, f) => f)).map((f) => range_at(f, colour)).filter(Boolean);
      const [i, k] = how === "usual" ? [1, 2] : [0, 3];
      ends = ranges.length ? [Math.min(...ranges.map((r) => r[i])), Math.max(...ranges.map((r) => r[k]))] : [0, 1];
      if (!(ends[1] > ends[0])) ends = [Math.min(...ranges.map((r) => r[0]), ends[0]), Math.max(...ranges.map((r) => r[3]), ends[1])];
    }
    if (log && !(ends[1] > 0)) by_id("log").checked = false;  // nothing to take a logarithm of
    else if (log && !(ends[0] > 0)) ends[0] = 1e-6 * ends[1];
    if (how !== "own") [by_id("low").value, by_id("high").value] = ends.map(short);
    const usable = Number.isFinite(ends[0]) && Number.isFinite(ends[1]) && ends[1] >= ends[0];
    for (const id of ["low", "high"]) by_id(id).setCustomValidity(usable ? "" : "The lower end must lie below the upper end.");
  }

  function set_shades() {
    set_ends();
    const shade = geometry.attributes.shade, n = frames[now].n, constant = !(ends[1] > ends[0]);
    shown.without = false;
    for (let i = 0; i < n; ++i) {
      const v = shown.values[i], t = constant ? (Number.isNaN(v) ? NaN : 0) : share(v);
      if (Number.isNaN(t)) shown.without = true;
      shade.array[i] = Number.isNaN(t) ? -1 : Math.max(0, Math.min(1, t));
    }
    shade.needsUpdate = true;
  }

  function set_map() {
    const bytes = new Uint8Array(1024);
    for (let i = 0; i < 256; ++i) bytes.set([...colour_at(i / 255), 255], 4 * i);
    material.uniforms.map.value = new THREE.DataTexture(bytes, 256, 1, THREE.RGBAFormat);
    material.uniforms.map.value.needsUpdate = true;
  }

  function set_clip() {
    const axis = by_id("clip_axis").value;
    by_id("clip").hidden = axis === "";
    if (axis === "") {
      material.uniforms.plane.value.set(0, 0, 0, 1);
      return;
    }
    const a = Number(axis), w = Number(by_id("clip_place").value) / 1000, side = by_id("clip_side").checked ? -1 : 1;
    const x = box.low[a] + w * (box.high[a] - box.low[a]), normal = [0, 0, 0];
    normal[a] = side;
    material.uniforms.plane.value.set(...normal, side * x);
    by_id("clip_text").value =
      `${"xyz"[a]} ${side > 0 ? "<" : ">"} ${short(Number(((x + origin[a]) * per_metre).toPrecision(3)))} ${length_unit}`;
  }
  const is_kept = (i) => {
    const p = material.uniforms.plane.value, x = shown.places;
    return p.x * x[3 * i] + p.y * x[3 * i + 1] + p.z * x[3 * i + 2] <= p.w;
  };

  async function show(frame) {
    const mine = ++asked;
    const [x, v] = await Promise.all([places(frame), values(frame, colour)]);
    if (mine !== asked) return;
    now = frame;
    shown = {places: x, values: v, range: range_at(frame, colour)};
    geometry.attributes.position.array.set(x);
    geometry.attributes.position.needsUpdate = true;
    geometry.setDrawRange(0, frames[frame].n);
    set_poses();
    set_shades();
    by_id("instant").value = frame;
    by_id("time").value = `t = ${short(frames[frame].time)} s, step ${frames[frame].step}`;
    by_id("unit").textContent = scene.quantities[colour.q].unit.replace(/^1$/, "");
    by_id("meaning").textContent = `${label_of(scene.quantities[colour.q].name)}: ${scene.quantities[colour.q].meaning}.`;
    by_id("reading").hidden = true;
    draw();
    document.dispatchEvent(new CustomEvent("instant", {detail: frames[frame].time}));
  }
  const step_to = (frame) => show(Math.max(0, Math.min(frames.length - 1, frame)));

  const player = window.talus_player(by_id("play"), async () => {
    await show((now + 1) % frames.length);
    return now === frames.length - 1 ? 900 : 90;
  });

  // ---- hands on ----------------------------------------------------------------------------------------------------

  const on = (id, event, act) => by_id(id).addEventListener(event, act);
  const again = () => { set_shades(); draw(); };

  colours.forEach((c, i) => by_id("quantity").add(new Option(label_of(c.name), i)));
  for (let a = 0; a < scene.dim; ++a) by_id("clip_axis").add(new Option("xyz"[a], a));
  by_id("instant").max = frames.length - 1;
  on("quantity", "change", () => {
    colour = colours[by_id("quantity").value];
    if (by_id("range").value === "own") by_id("range").value = "usual";
    show(now);
  });
  on("range", "change", again);
  on("log", "change", again);
  for (const id of ["low", "high"]) on(id, "change", () => { by_id("range").value = "own"; again(); by_id(id).reportValidity(); });
  on("map", "change", () => { set_map(); draw(); });
  on("instant", "input", () => { player.stop(); show(Number(by_id("instant").value)); });
  on("size", "input", draw);
  on("clip_axis", "change", () => {  // what is kept lies behind the cut, as seen from here
    const axis = by_id("clip_axis").value;
    if (axis !== "") by_id("clip_side").checked = camera.getWorldDirection(new THREE.Vector3()).getComponent(Number(axis)) > 0;
    set_clip();
    draw();
  });
  for (const id of ["clip_place", "clip_side"]) on(id, "input", () => { set_clip(); draw(); });
  const views = flat ? [["Reset view", [0, 0, 1]]]
                     : [["Oblique", [1, -1.6, 0.9]], ["From the front", [0, -1, 0]], ["From the side", [1, 0, 0]], ["From above", [0, -1e-4, 1]]];
  for (const [name, direction] of views) {
    const button = document.createElement("button");
    button.textContent = name;
    button.addEventListener("click", () => look(direction));
    by_id("views").append(button, " ");
  }
  on("save", "click", () => {
    const both = document.createElement("canvas");
    both.width = under.width;
    both.height = under.height;
    const paper = both.getContext("2d");
    paper.drawImage(under, 0, 0);
    paper.drawImage(canvas, 0, 0);
    const link = document.createElement("a");
    link.href = both.toDataURL("image/png");
    link.download = `${colour.name.replaceAll(" ", "_")}_${short(frames[now].time)}s.png`;
    link.click();
  });
  stage.addEventListener("keydown", (event) => {
    const act = {ArrowRight: () => step_to(now + 1), ArrowLeft: () => step_to(now - 1), Home: () => step_to(0),
                 End: () => step_to(frames.length - 1), " ": player.press}[event.key];
    if (!act) return;
    event.preventDefault();
    if (event.key !== " ") player.stop();
    act();
  });
  document.addEventListener("seek", (event) => {
    player.stop();
    const distance = frames.map((f) => Math.abs(f.time - event.detail));
    show(distance.indexOf(Math.min(...distance)));
  });

  // The particle under the pointer: of those within half its width, the nearest to us.
  canvas.addEventListener("pointermove", (event) => {
    const tip = by_id("reading");
    tip.hidden = true;
    if (event.buttons || !shown.places) return;
    const x = event.offsetX, y = event.offsetY, reach = Math.max(3, scene.spacing / 2 * pixels_per_metre());
    const m = new THREE.Matrix4().multiplyMatrices(camera.projectionMatrix, camera.matrixWorldInverse).elements;
    const w = (width - bar_width) / 2, h = height / 2, p = shown.places;
    let best = -1, nearest = Infinity;
    for (let i = 0; i < frames[now].n; ++i) {
      const a = p[3 * i], b = p[3 * i + 1], c = p[3 * i + 2];
      const dx = (m[0] * a + m[4] * b + m[8] * c + m[12] + 1) * w - x;
      const dy = (1 - m[1] * a - m[5] * b - m[9] * c - m[13]) * h - y;
      if (dx * dx + dy * dy > reach * reach) continue;
      const depth = flat ? dx * dx + dy * dy : m[2] * a + m[6] * b + m[10] * c + m[14];
      if (depth < nearest && is_kept(i)) { best = i; nearest = depth; }
    }
    if (best < 0) return;
    const unit = scene.quantities[colour.q].unit.replace(/^1$/, "");
    const place = [0, 1, 2].slice(0, scene.dim).map((a) => short((p[3 * best + a] + origin[a]) * per_metre)).join(", ");
    tip.textContent = `${label_of(colour.name)} ${short(shown.values[best])} ${unit}\n${scene.numbered ? `particle ${best * scene.every}, ` : ""}at ${place} ${length_unit}`;
    tip.hidden = false;
    tip.style.left = Math.min(x + 14, width - bar_width - tip.offsetWidth) + "px";
    tip.style.top = Math.min(y + 14, height - tip.offsetHeight - 4) + "px";
  });
  canvas.addEventListener("pointerleave", () => { by_id("reading").hidden = true; });
  controls.addEventListener("change", draw);
  window.addEventListener("resize", resize);

  by_id("how").textContent = (flat ? "Drag to move, use the wheel to zoom." : "Drag to rotate, use the wheel to zoom, right button to move.") +
    " Point at a particle to read its value; edit the ends of the scale to change it. With the view selected, arrow keys" +
    " step through time and the space bar plays. " + scene.notes;

  // For scripts that drive the page: what is shown now.
  window.talus = {
    state: () => ({frame: now, frames: frames.length, time: frames[now].time, quantity: colour.name, low: ends[0], high: ends[1],
                   ready: shown.places !== null && grey.every((dots) => dots.visible), particles: frames[now].n,
                   kept: shown.places ? Array.from({length: frames[now].n}, (_, i) => i).filter(is_kept).length : 0,
                   camera: camera.position.toArray()}),
    // Places [m] of the particles that are shown, one after another, and their values.
    places: () => Array.from(shown.places, (x, i) => x + origin[i % 3]),
    values: () => Array.from(shown.values),
    // Of every solid, places of the points on its surface [m].
    solids: () => grey.map((dots) => {
      dots.updateMatrixWorld();
      const at_first = dots.geometry.attributes.position, x = new THREE.Vector3(), places = [];
      for (let i = 0; i < at_first.count; ++i)
        places.push(...x.fromBufferAttribute(at_first, i).applyMatrix4(dots.matrixWorld).toArray().map((v, a) => v + origin[a]));
      return places;
    }),
  };

  const first = colours.findIndex((c) => c.name === "velocity magnitude");
  by_id("quantity").value = Math.max(0, first);
  colour = colours[Math.max(0, first)];
  set_map();
  set_clip();
  resize();
  look(views[0][1]);
  show(frames.length - 1);  // the deposit
})();
