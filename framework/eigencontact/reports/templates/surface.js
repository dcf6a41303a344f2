"use strict";
// Height maps of surface fields, drawn by the painter's method: a grid seen from above is drawn from its far side to its
// near side, and needs no sorting. All data stand in the page.
(() => {
  const fields = JSON.parse(document.getElementById("surfaces").textContent);
  const find = (id) => document.getElementById(id);
  const canvas = find("canvas"), select = find("field"), slider = find("step");
  const one = ["#440154", "#472d7b", "#3b528b", "#2c728e", "#21918c", "#28ae80", "#5ec962", "#addc30", "#fde725"];
  const two = ["#053061", "#2f79b5", "#7bb6d6", "#c7dfed", "#f7f7f7", "#fbccb4", "#ec9274", "#c2383a", "#67001f"];
  const rest = { turn: -0.6, tilt: 0.62, zoom: 1 };
  let view = { ...rest }, queued = false;

  const rgb = (hex) => [1, 3, 5].map((at) => parseInt(hex.slice(at, at + 2), 16));
  const maps = [one, two].map((stops) => stops.map(rgb));
  function colour(map, part, light) {
    const place = Math.min(Math.max(part, 0), 1) * (map.length - 1), below = Math.min(Math.floor(place), map.length - 2);
    const mix = map[below].map((value, k) => Math.round(light * (value + (place - below) * (map[below + 1][k] - value))));
    return `rgb(${mix.join()})`;
  }

  function heights(field, at) {
    const step = field.steps[at];
    if (!step.levels) {
      const bytes = Uint8Array.from(atob(step.heights), (letter) => letter.charCodeAt(0));
      step.levels = Float32Array.from({ length: bytes.length / 2 }, (_, k) => (bytes[2 * k] + 256 * bytes[2 * k + 1]) / 65535);
    }
    return step.levels;
  }

  // Part of the colour map for a part of the range; a field of both signs has its zero in the middle.
  function tint(field) {
    const { low, high } = field;
    if (low < 0 && high > 0) {
      const end = Math.max(-low, high);
      return [maps[1], (part) => 0.5 + (low + part * (high - low)) / (2 * end)];
    }
    return [maps[0], high > 0 ? (part) => part : (part) => 1 - part];
  }

  function draw() {
    queued = false;
    const field = fields[select.value], level = heights(field, Number(slider.value)), [rows, columns] = field.shape;
    const scale = window.devicePixelRatio || 1, width = canvas.clientWidth, height = canvas.clientHeight;
    if (!width || !height) return;
    canvas.width = width * scale;
    canvas.height = height * scale;
    const pen = canvas.getContext("2d");
    pen.scale(scale, scale);
    const spanX = Math.abs(field.x[1] - field.x[0]), spanY = Math.abs(field.y[1] - field.y[0]), side = Math.max(spanX, spanY);
    const a = spanX / side, b = spanY / side, tall = 0.42 * field.sign;
    const zero = -field.low / (field.high - field.low);
    const size = view.zoom * 0.6 * Math.min(width - 110, 1.3 * height);
    const [cos, sin, up, flat] = [Math.cos(view.turn), Math.sin(view.turn), Math.cos(view.tilt), Math.sin(view.tilt)];
    const middle = tall * (0.5 - zero);
    const project = (u, v, h) => {
      const across = u * cos - v * sin, deep = u * sin + v * cos;
      return [(width - 70) / 2 + size * across, height / 2 - size * ((h - middle) * up + deep * flat)];
    };
    const at = (i, j) => level[i * columns + j];
    const points = [];
    for (let i = 0; i < rows; i++) {
      for (let j = 0; j < columns; j++) {
        points.push(project((j / (columns - 1) - 0.5) * a, (i / (rows - 1) - 0.5) * b, (at(i, j) - zero) * tall));
      }
    }
    const ink = getComputedStyle(canvas).color;
    frame(pen, project, a, b, field, ink, true);
    const [map, part] = tint(field);
    const dx = a / (columns - 1), dy = b / (rows - 1);
    pen.lineWidth = 0.6;
    pen.lineJoin = "round";
    for (let m = 0; m < rows - 1; m++) {
      const i = cos > 0 ? rows - 2 - m : m; // far first
      for (let n = 0; n < columns - 1; n++) {
        const j = sin > 0 ? columns - 2 - n : n;
        const corners = [i * columns + j, i * columns + j + 1, (i + 1) * columns + j + 1, (i + 1) * columns + j];
        const [p, q, r, s] = corners.map((corner) => level[corner]);
        const slopeX = (tall * (q + r - p - s)) / (2 * dx), slopeY = (tall * (s + r - p - q)) / (2 * dy);
        const light = 0.72 + 0.28 * Math.max(0, (1 - 0.5 * slopeX - 0.4 * slopeY) / Math.hypot(1, slopeX, slopeY) / 1.19);
        pen.fillStyle = pen.strokeStyle = colour(map, part((p + q + r + s) / 4), light);
        pen.beginPath();
        corners.forEach((corner, k) => (k ? pen.lineTo(...points[corner]) : pen.moveTo(...points[corner])));
        pen.closePath();
        pen.fill();
        pen.stroke();
      }
    }
    frame(pen, project, a, b, field, ink, false);
    bar(pen, field, map, part, width, height, ink);
    tell(field);
  }

  // The plane of zero: behind the surface its outline, before it the places along the two sides that are near.
  function frame(pen, project, a, b, field, ink, behind) {
    const [u, v] = [0.5 * a, 0.5 * b];
    pen.strokeStyle = pen.fillStyle = ink;
    pen.globalAlpha = behind ? 0.35 : 0.85;
    pen.lineWidth = 1;
    if (behind) {
      pen.beginPath();
      [[-u, -v], [u, -v], [u, v], [-u, v]].forEach(([x, y], k) => (k ? pen.lineTo(...project(x, y, 0)) : pen.moveTo(...project(x, y, 0))));
      pen.closePath();
      pen.stroke();
    } else {
      pen.font = "12px system-ui, sans-serif";
      pen.textAlign = "center";
      pen.textBaseline = "middle";
      const nearV = (Math.cos(view.turn) > 0 ? -1 : 1) * (v + 0.07), nearU = (Math.sin(view.turn) > 0 ? -1 : 1) * (u + 0.07);
      const say = (words, x, y) => pen.fillText(words, ...project(x, y, 0));
      const digits = (value) => String(Number(value.toPrecision(3)));
      say(digits(field.x[0]), -u, nearV);
      say(digits(field.x[1]), u, nearV);
      say(`x [${field.length}]`, 0, nearV * 1.12);
      say(digits(field.y[0]), nearU, -v);
      say(digits(field.y[1]), nearU, v);
      say(`y [${field.length}]`, nearU * 1.12, 0);
    }
    pen.globalAlpha = 1;
  }

  function bar(pen, field, map, part, width, height, ink) {
    const top = 46, long = height - 92, x = width - 62;
    for (let k = 0; k < long; k++) {
      pen.fillStyle = colour(map, part(1 - k / (long - 1)), 1);
      pen.fillRect(x, top + k, 12, 1.5);
    }
    pen.fillStyle = ink;
    pen.font = "12px system-ui, sans-serif";
    pen.textAlign = "left";
    pen.textBaseline = "middle";
    const say = (value, y) => pen.fillText(String(Number((value * field.factor).toPrecision(3))), x + 17, y);
    say(field.high, top);
    say(field.low, top + long);
    if (field.low < 0 && field.high > 0) {
      const y = top + (long * field.high) / (field.high - field.low);
      if (y > top + 14 && y < top + long - 14) say(0, y);
    } else {
      say((field.low + field.high) / 2, top + long / 2);
    }
    pen.textAlign = "right";
    pen.fillText(field.unit, width - 10, top - 22);
  }

  function tell(field) {
    const step = field.steps[slider.value];
    find("stepping").hidden = field.steps.length < 2;
    find("step-said").textContent = String(step.step);
    const cells = field.every > 1 ? `Every ${field.every}${field.every === 2 ? "nd" : field.every === 3 ? "rd" : "th"} cell is shown. ` : "";
    const some = field.steps.length > 1 ? `Colours and heights are the same for all steps shown.` : "";
    find("shown").textContent = cells + some;
  }

  function redraw() {
    if (!queued) {
      queued = true;
      requestAnimationFrame(draw);
    }
  }

  function turn(across, along) {
    view.turn = (view.turn + across) % (2 * Math.PI);
    view.tilt = Math.min(1.5, Math.max(0.05, view.tilt + along));
    redraw();
  }

  function zoom(factor) {
    view.zoom = Math.min(6, Math.max(0.4, view.zoom * factor));
    redraw();
  }

  function reset() {
    view = { ...rest };
    redraw();
  }

  function choose() {
    const steps = fields[select.value].steps.length;
    slider.max = String(steps - 1);
    slider.value = String(steps - 1);
    redraw();
  }

  const keys = {
    ArrowLeft: () => turn(-0.12, 0), ArrowRight: () => turn(0.12, 0), ArrowUp: () => turn(0, -0.08), ArrowDown: () => turn(0, 0.08),
    "+": () => zoom(1.15), "=": () => zoom(1.15), "-": () => zoom(1 / 1.15), 0: reset,
  };
  canvas.addEventListener("keydown", (event) => {
    if (event.key in keys && !event.ctrlKey && !event.metaKey && !event.altKey) {
      keys[event.key]();
      event.preventDefault();
    }
  });
  let held = null;
  canvas.addEventListener("pointerdown", (event) => {
    held = [event.clientX, event.clientY];
    canvas.setPointerCapture(event.pointerId);
  });
  canvas.addEventListener("pointermove", (event) => {
    if (held) {
      turn((event.clientX - held[0]) * 0.008, (event.clientY - held[1]) * 0.006);
      held = [event.clientX, event.clientY];
    }
  });
  ["pointerup", "pointercancel"].forEach((name) => canvas.addEventListener(name, () => { held = null; }));
  find("closer").addEventListener("click", () => zoom(1.25));
  find("farther").addEventListener("click", () => zoom(0.8));
  find("reset").addEventListener("click", reset);
  select.addEventListener("change", choose);
  slider.addEventListener("input", redraw);
  window.addEventListener("resize", redraw);
  window.matchMedia("(prefers-color-scheme: dark)").addEventListener("change", redraw);
  find("viewer").hidden = false;
  choose();
})();
