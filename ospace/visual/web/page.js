"use strict";
// One page for all: a file that carries its scene, or a live view that gets it through a socket.
(() => {
  const { THREE } = MeshCat;
  const data = JSON.parse(document.getElementById("scene-data").textContent);
  const byId = (id) => document.getElementById(id);
  const pane = byId("pane"), player = byId("player"), slider = byId("time"), clock = byId("clock"), play = byId("play");
  const viewer = new MeshCat.Viewer(pane);
  const fit = viewer.set_3d_pane_size, WIDE = 1.25;
  let field = viewer.camera.fov;
  viewer.set_3d_pane_size = () => {
    const narrow = Math.max(1, (WIDE * pane.clientHeight) / pane.clientWidth); // nothing is cut off at the sides
    viewer.camera.fov = (360 / Math.PI) * Math.atan(narrow * Math.tan((field * Math.PI) / 360));
    fit.call(viewer, pane.clientWidth, pane.clientHeight);
  };
  new ResizeObserver(() => viewer.set_3d_pane_size()).observe(pane);
  viewer.controls.enableKeys = false;

  const set = viewer.set_property;
  viewer.set_property = (path, property, value) => {
    set.call(viewer, path, property, value);
    if (property === "target") viewer.controls.target.fromArray(value); // where the camera looks to
    if (property === "fov") {
      field = value;
      viewer.set_3d_pane_size();
    }
  };

  const split = (path) => path.split("/").filter(Boolean);
  const node = (path) => viewer.scene_tree.find(split(path)).object;

  // -- layers and labels
  const boxes = new Map();
  function show(name, on) {
    const layer = data.layers.find((one) => one.name === name);
    for (const path of layer.paths) node(path).visible = on;
    viewer.set_dirty();
  }
  for (const box of document.querySelectorAll("#layers input")) {
    boxes.set(box.dataset.layer, box);
    box.addEventListener("change", () => {
      show(box.dataset.layer, box.checked);
      const legend = box.parentElement.querySelector("small");
      if (legend) legend.hidden = !box.checked;
    });
  }
  const labels = data.labels.map((label) => {
    const tag = document.createElement("span");
    tag.textContent = label.text;
    tag.title = label.hint;
    byId("labels").append(tag);
    return { ...label, tag };
  });
  const at = new THREE.Vector3();
  function placeLabels() {
    const width = pane.clientWidth, height = pane.clientHeight, taken = [];
    for (const { tag, path, layer } of labels) {
      node(path).getWorldPosition(at).project(viewer.camera);
      const seen = boxes.get(layer)?.checked && Math.abs(at.z) < 1 && Math.abs(at.x) < 1 && Math.abs(at.y) < 1;
      tag.hidden = !seen;
      if (!seen) continue;
      const x = Math.min((at.x + 1) * 0.5 * width + 10, width - tag.offsetWidth - 4);
      let y = (1 - at.y) * 0.5 * height - 26;
      while (taken.some((one) => Math.abs(one.y - y) < 22 && x < one.right && one.left < x + tag.offsetWidth)) y += 22;
      taken.push({ left: x, right: x + tag.offsetWidth, y });
      tag.style.transform = `translate(${x}px, ${y}px)`;
    }
  }

  // -- hints: what there is to say of the link that the mouse points at
  const ray = new THREE.Raycaster();
  let pointer = null;
  pane.addEventListener("pointermove", ({ offsetX, offsetY, buttons }) => { // not while the view is turned
    if (data.hints.length && !buttons) pointer = new THREE.Vector2((2 * offsetX) / pane.clientWidth - 1, 1 - (2 * offsetY) / pane.clientHeight);
  });
  function placeHint() {
    if (!pointer) return;
    const hints = new Map(data.hints.map(([path, text]) => [node(path), text]));
    const above = (object) => { const way = []; for (let up = object; up; up = up.parent) way.push(up); return way; };
    ray.setFromCamera(pointer, viewer.camera);
    const hit = ray.intersectObject(viewer.scene, true).find(({ object }) => object.isMesh && above(object).every((one) => one.visible));
    const hinted = hit && above(hit.object).find((one) => hints.has(one));
    pane.title = hinted ? hints.get(hinted) : "";
    pointer = null;
  }

  // -- time
  let now = 0, playing = false, before = 0;
  function seek(time) {
    now = Math.max(0, Math.min(duration(), time));
    viewer.animator.seek(now);
    slider.value = String(now);
    slider.setAttribute("aria-valuetext", `${now.toFixed(2)} s`);
    clock.textContent = `${now.toFixed(2)} s`;
    document.dispatchEvent(new CustomEvent("ospace:time", { detail: now }));
  }
  const duration = () => viewer.animator.duration;
  function setPlaying(on) {
    playing = on;
    play.textContent = on ? "Pause" : "Play";
    play.setAttribute("aria-pressed", String(on));
  }
  const animate = viewer.set_animation;
  viewer.set_animation = (animations, options) => {
    animate.call(viewer, animations, options);
    viewer.animator.pause(); // this page moves the clock: the plots go by it too
    player.hidden = animations.length === 0; // none: what is displayed from now on stands still
    setPlaying(false);
    slider.max = String(duration());
    seek(0);
  };
  play.addEventListener("click", () => {
    if (!playing && now >= duration()) seek(0);
    setPlaying(!playing);
  });
  slider.addEventListener("input", () => { setPlaying(false); seek(Number(slider.value)); });

  // -- keys
  pane.addEventListener("keydown", (event) => {
    const turns = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, -1], ArrowDown: [0, 1] };
    const nearer = { "+": 0.9, "=": 0.9, "-": 1 / 0.9 };
    const { position } = viewer.camera, { target } = viewer.controls;
    const arm = position.clone().sub(target);
    if (turns[event.key]) {
      const ball = new THREE.Spherical().setFromVector3(arm);
      ball.theta += 0.08 * turns[event.key][0];
      ball.phi += 0.08 * turns[event.key][1];
      position.setFromSpherical(ball.makeSafe()).add(target);
    } else if (nearer[event.key]) {
      position.copy(arm.multiplyScalar(nearer[event.key]).add(target));
    } else if (event.key === " " && !player.hidden) {
      play.click();
    } else return;
    event.preventDefault();
    viewer.set_dirty();
  });

  // -- the scene
  async function unpack(text) {
    const packed = Uint8Array.from(atob(text), (letter) => letter.charCodeAt(0));
    const stream = new Blob([packed]).stream().pipeThrough(new DecompressionStream("gzip"));
    return new Uint8Array(await new Response(stream).arrayBuffer());
  }
  async function load() {
    const bytes = await unpack(data.commands);
    const view = new DataView(bytes.buffer);
    for (let start = 0; start < bytes.length;) {
      const length = view.getUint32(start, true);
      viewer.handle_command_bytearray(bytes.subarray(start + 4, start + 4 + length));
      start += 4 + length;
    }
  }
  function connect() {
    viewer.connect(`ws://${location.host}/socket`);
    viewer.connection.addEventListener("close", () => { byId("status").textContent = "The program that showed this has ended."; });
  }
  function frame(time) {
    if (playing) {
      seek(now + (time - before) / 1000);
      if (now >= duration()) setPlaying(false);
    }
    before = time;
    placeLabels();
    placeHint();
    requestAnimationFrame(frame);
  }
  const ready = data.live ? Promise.resolve(connect()) : load();
  // #t=14.7 opens the page at that time, #bare leaves the picture alone
  const asked = new URLSearchParams(location.hash.slice(1));
  document.body.classList.toggle("bare", asked.has("bare"));
  ready.then(() => {
    if (asked.has("t") && duration() > 0) seek(Number(asked.get("t")) || 0);
    requestAnimationFrame(frame);
  });
  window.ospace = { viewer, node, seek, duration, ready, show, data, unpack };
})();
