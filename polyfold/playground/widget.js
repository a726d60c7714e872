// The playground's view: it shows the kernel's picture and sends what is drawn on it, in the camera's pixels.

function element(tag, attributes = {}, ...children) {
  const made = document.createElement(tag);
  for (const [name, value] of Object.entries(attributes)) {
    if (name.startsWith("on")) made.addEventListener(name.slice(2), value);
    else made.setAttribute(name, value);
  }
  made.append(...children);
  return made;
}

function render({ model, el }) {
  const send = (what, more = {}) => model.send({ do: what, ...more });
  const canvas = element("canvas", { class: "polyfold-table", tabindex: "0", role: "img" });
  const pen = canvas.getContext("2d");
  let shown = null; // what the kernel drew last
  let drag = null; // where the mouse went down and is now
  let arrows = []; // picks and places of the arms, in picture mode
  let waiting = false; // the kernel has not answered what was drawn last

  // The picture -----------------------------------------------------------------------------------------------------

  async function take(bytes) {
    if (!bytes || !bytes.byteLength) return;
    shown = await createImageBitmap(new Blob([bytes], { type: "image/png" }));
    draw();
  }

  function draw() {
    if (!shown) return;
    const [width, height] = model.get("size");
    if (canvas.width !== shown.width && !model.get("busy")) canvas.width = shown.width;
    if (canvas.height !== shown.height && !model.get("busy")) canvas.height = shown.height;
    pen.drawImage(shown, 0, 0, canvas.width, canvas.height);
    if (!drag) return;
    const picks = mode() === "picks";
    const zoom = canvas.width / width;
    const at = ([x, y]) => [(x + 0.5) * zoom, (y + 0.5) * (canvas.height / height)];
    const [x0, y0] = at(drag.start), [x1, y1] = at(drag.end);
    const colours = model.get("colours");
    pen.strokeStyle = picks ? colours.arms[arrows.length % 2] : colours.line;
    pen.lineWidth = 2.5;
    pen.beginPath();
    pen.moveTo(x0, y0);
    pen.lineTo(x1, y1);
    const angle = Math.atan2(y1 - y0, x1 - x0);
    for (const side of [-1, 1]) {
      pen.moveTo(x1, y1);
      pen.lineTo(x1 - 12 * Math.cos(angle + side * 0.4), y1 - 12 * Math.sin(angle + side * 0.4));
    }
    pen.stroke();
  }

  // The mouse -------------------------------------------------------------------------------------------------------

  function pixel(event) {
    const box = canvas.getBoundingClientRect(), [width, height] = model.get("size");
    const inside = (share, side) => Math.min(Math.max(share * side - 0.5, 0), side - 1);
    return [
      inside((event.clientX - box.left) / box.width, width),
      inside((event.clientY - box.top) / box.height, height),
    ];
  }

  function tell() {
    if (mode() === "picks") send("picks", { arrows: [...arrows, [drag.start, drag.end]].slice(-2) });
    else send("line", drag);
  }

  canvas.addEventListener("pointerdown", (event) => {
    if (model.get("busy") || event.button !== 0) return;
    canvas.setPointerCapture(event.pointerId);
    if (mode() === "picks" && arrows.length === 2) arrows = [];
    drag = { start: pixel(event), end: pixel(event) };
    event.preventDefault();
  });
  canvas.addEventListener("pointermove", (event) => {
    if (!drag) return;
    drag.end = pixel(event);
    // As often as the kernel answers, and no more often.
    if (!waiting && Math.hypot(drag.end[0] - drag.start[0], drag.end[1] - drag.start[1]) > 8) {
      waiting = true;
      tell();
    }
    draw();
  });
  canvas.addEventListener("pointerup", (event) => {
    if (!drag) return;
    drag.end = pixel(event);
    tell();
    if (mode() === "picks") arrows.push([drag.start, drag.end]);
    drag = null;
    draw();
  });
  canvas.addEventListener("keydown", (event) => {
    const undone = event.key === "z" && (event.ctrlKey || event.metaKey);
    if (!["Enter", "Escape"].includes(event.key) && !undone) return;
    if (!model.get("busy")) {
      if (event.key === "Enter") doing("fold");
      else if (undone) doing("undo");
      else clear();
    }
    event.preventDefault();
    event.stopPropagation(); // JupyterLab has uses for these keys as well
  });

  function doing(what, more = {}) {
    arrows = []; // what was drawn is done with
    send(what, more);
  }

  const clear = () => doing("clear");

  // The panel -------------------------------------------------------------------------------------------------------

  const choose = element("select", { "aria-label": "what the mouse draws", onchange: clear },
    element("option", { value: "line" }, "fold line"),
    element("option", { value: "picks" }, "picks and places"));
  const mode = () => choose.value;
  const button = (label, title, pressed) => element("button", { type: "button", title, onclick: pressed }, label);
  const fold = button("Fold", "do what is drawn (Enter)", () => doing("fold"));
  fold.classList.add("polyfold-main");
  const flip = button("Flip", "lift the other side of the line", () => send("flip"));
  const wipe = button("Clear", "forget what is drawn (Escape)", clear);
  const undo = button("Undo", "take back the last fold (Ctrl+Z)", () => doing("undo"));
  const sentence = element("input", {
    type: "text", placeholder: "or say it: fold it in half", "aria-label": "a sentence",
    onkeydown: (event) => {
      event.stopPropagation();
      if (event.key === "Enter") doing("say", { sentence: sentence.value });
    },
  });
  const say = button("Go", "fold as the sentence says", () => doing("say", { sentence: sentence.value }));
  const tick = (name, label) => {
    const box = element("input", { type: "checkbox", onchange: () => { model.set(name, box.checked); model.save_changes(); } });
    box.checked = model.get(name);
    return element("label", {}, box, label);
  };
  const name = element("input", {
    type: "text", value: "my-task", "aria-label": "name of the task or folder",
    onkeydown: (event) => event.stopPropagation(),
  });
  const turns = element("ol", { class: "polyfold-turns" });
  const status = element("p", { class: "polyfold-status", role: "status" });
  const text = element("textarea", { readonly: "", rows: "9", "aria-label": "to take home" });
  const panel = element("div", { class: "polyfold-panel" },
    element("div", {}, choose, fold, flip, wipe, undo),
    element("div", {}, sentence, say),
    element("div", {}, tick("polygon", "polygon"), tick("values", "policy's map")),
    status, turns,
    element("div", {}, name,
      button("Task", "as a task for others of its kind", () => send("task", { name: name.value })),
      button("Code", "as Python that does it again", () => send("code")),
      button("Save", "episode, filmstrip and film into a folder of this name", () => send("save", { name: name.value }))),
    text);

  // What the kernel says --------------------------------------------------------------------------------------------

  function update() {
    const busy = model.get("busy");
    status.textContent = model.get("status");
    canvas.setAttribute("aria-label", `the table; ${model.get("status")}`);
    turns.replaceChildren(...model.get("turns").map((turn) => element("li", {}, turn)));
    text.value = model.get("text");
    text.hidden = !text.value;
    for (const control of panel.querySelectorAll("button, select, input")) control.disabled = busy;
    fold.disabled = busy || !model.get("planned");
    flip.disabled = busy || !model.get("planned") || mode() === "picks";
    canvas.classList.toggle("polyfold-busy", busy);
  }

  const names = ["status", "turns", "text", "busy", "planned"];
  const changed = () => update();
  const pictured = () => take(model.get("picture"));
  const framed = (message, buffers) => {
    if (message.do === "frame") take(buffers[0]);
    if (message.do === "answered") waiting = false;
  };
  for (const trait of names) model.on(`change:${trait}`, changed);
  model.on("change:picture", pictured);
  model.on("msg:custom", framed);
  el.classList.add("polyfold-playground");
  el.append(canvas, panel);
  update();
  pictured();
  return () => {
    for (const trait of names) model.off(`change:${trait}`, changed);
    model.off("change:picture", pictured);
    model.off("msg:custom", framed);
  };
}

export default { render };
