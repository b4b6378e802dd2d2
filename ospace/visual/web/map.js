"use strict";
// The field of a map: a cube where the hand can be, coloured by a quantity; a click puts the robot there.
(() => {
  const { THREE } = MeshCat;
  const { viewer, node, ready, unpack } = window.ospace;
  const byId = (id) => document.getElementById(id);
  const data = JSON.parse(byId("map-data").textContent);
  const quantity = byId("field-quantity"), end = byId("field-end"), slice = byId("field-slice"), place = byId("field-place");
  const told = byId("field-told"), pane = byId("pane");
  // viridis, by its authors free for all: dark is little, light is much, for all kinds of colour vision
  const SCALE = ["#440154", "#46327e", "#365c8d", "#277f8e", "#1fa187", "#4ac16d", "#a0da39", "#fde725"].map((one) => new THREE.Color(one));
  const SIDE = 0.42; // of a cube, as a share of the space between two: the robot is seen between them
  const F = data.titles.length, N = data.joints.length, C = data.count;
  let centres, ends, layers, cubes = null, shown = [], x = data.home;

  const colour = (share, out) => {
    const at = Math.min(Math.max(share, 0), 1) * (SCALE.length - 1), k = Math.min(Math.floor(at), SCALE.length - 2);
    return out.copy(SCALE[k]).lerp(SCALE[k + 1], at - k);
  };
  byId("field-bar").style.background = `linear-gradient(90deg, ${SCALE.map((one) => `#${one.getHexString()}`).join(", ")})`;
  const written = (number) => String(Number(number.toPrecision(4)));
  const withUnit = (number, unit) => `${written(number)}${unit ? ` ${unit}` : ""}`;
  const posture = (values) => data.joints.map(({ name, unit }, k) => {
    const degrees = unit === "rad" ? ` (${((180 / Math.PI) * values[k]).toFixed(1)} deg)` : "";
    return `${name} ${values[k].toFixed(4)} ${unit}${degrees}`;
  }).join(", ");

  // -- the robot: forward kinematics of the joints that vary
  function put(values) {
    x = [...values];
    const at = [];
    data.bodies.forEach((body, k) => {
      const T = new THREE.Matrix4().fromArray(body.rest);
      if (body.joint >= 0) {
        const moved = body.offset + body.ratio * x[body.joint], axis = new THREE.Vector3(...body.axis);
        const by = new THREE.Matrix4();
        if (body.turns) by.makeRotationAxis(axis, moved);
        else by.makeTranslation(...axis.multiplyScalar(moved).toArray());
        T.multiply(by);
      }
      at[k] = body.parent < 0 ? T : T.premultiply(at[body.parent]);
      viewer.set_transform(body.node.split("/").filter(Boolean), at[k].toArray());
    });
    viewer.set_dirty();
  }

  // -- the cubes
  function values() { return ends[end.value].values.subarray(Number(quantity.value) * C, (Number(quantity.value) + 1) * C); }
  function at(cube) {
    const from = (cube * F + Number(quantity.value)) * N;
    return Array.from(ends[end.value].postures.subarray(from, from + N));
  }
  function draw() {
    const of = values(), axis = slice.value === "" ? -1 : Number(slice.value);
    place.hidden = axis < 0;
    byId("field-at").textContent = "";
    shown = [...Array(C).keys()];
    if (axis >= 0) {
      const at = layers[axis][Number(place.value)];
      byId("field-at").textContent = `${"xyz"[axis]} = ${written(at)} m`;
      shown = shown.filter((cube) => Math.abs(centres[3 * cube + axis] - at) < 0.5 * data.size);
    }
    let least = Infinity, most = -Infinity;
    for (const one of of) { least = Math.min(least, one); most = Math.max(most, one); }
    const unit = data.units[Number(quantity.value)], span = most > least ? most - least : 1;
    byId("field-least").textContent = withUnit(least, unit);
    byId("field-most").textContent = withUnit(most, unit);
    const T = new THREE.Matrix4(), paint = new THREE.Color();
    shown.forEach((cube, k) => {
      cubes.setMatrixAt(k, T.makeTranslation(centres[3 * cube], centres[3 * cube + 1], centres[3 * cube + 2]));
      cubes.setColorAt(k, colour((of[cube] - least) / span, paint));
    });
    cubes.count = shown.length;
    cubes.instanceMatrix.needsUpdate = cubes.instanceColor.needsUpdate = true;
    cubes.boundingSphere = cubes.boundingBox = null;
    viewer.set_dirty();
  }
  function describe(cube) {
    const k = Number(quantity.value), [cx, cy, cz] = [0, 1, 2].map((axis) => written(centres[3 * cube + axis]));
    return `${data.titles[k]}, ${end.selectedOptions[0].textContent}: ${withUnit(values()[cube], data.units[k])} with the hand about (${cx}, ${cy}, ${cz}) m, at ${posture(at(cube))}`;
  }

  // -- what the mouse points at
  const ray = new THREE.Raycaster();
  function pointed({ offsetX, offsetY }) {
    if (!cubes || !node(data.node).visible) return -1;
    ray.setFromCamera(new THREE.Vector2((2 * offsetX) / pane.clientWidth - 1, 1 - (2 * offsetY) / pane.clientHeight), viewer.camera);
    const [hit] = ray.intersectObject(cubes);
    return hit ? shown[hit.instanceId] : -1;
  }
  let pressed = null;
  pane.addEventListener("pointermove", (event) => {
    if (event.buttons) return; // the view is turned
    const cube = pointed(event);
    pane.title = cube < 0 ? "" : describe(cube);
  });
  pane.addEventListener("pointerdown", ({ clientX, clientY }) => { pressed = [clientX, clientY]; });
  pane.addEventListener("pointerup", (event) => {
    if (!pressed || Math.hypot(event.clientX - pressed[0], event.clientY - pressed[1]) > 4) return;
    const cube = pointed(event);
    if (cube < 0) return;
    put(at(cube));
    told.textContent = describe(cube);
  });

  // -- the controls
  function choose() { // what is best of a cube: much dexterity, little else
    end.value = data.best[Number(quantity.value)];
    draw();
  }
  quantity.addEventListener("change", choose);
  end.addEventListener("change", draw);
  place.addEventListener("input", draw);
  function cut() {
    if (slice.value !== "") {
      const of = layers[Number(slice.value)];
      place.max = String(of.length - 1);
      place.value = String(Math.floor(of.length / 2));
    }
    draw();
  }
  slice.addEventListener("change", cut);
  byId("field-home").addEventListener("click", () => { put(data.home); told.textContent = ""; });
  for (const button of document.querySelectorAll("button.posture")) {
    button.addEventListener("click", () => {
      put(data.extremes[Number(button.dataset.end)][Number(button.dataset.quantity)]);
      told.textContent = `${button.getAttribute("aria-label")}: ${posture(x)}`;
    });
  }

  async function load() {
    const numbers = new Float32Array((await unpack(data.numbers)).buffer);
    let from = 0;
    const take = (count) => numbers.subarray(from, (from += count));
    centres = take(3 * C);
    const byQuantity = (rows) => { // (C, F) to (F, C)
      const columns = new Float32Array(C * F);
      for (let cube = 0; cube < C; cube++) for (let k = 0; k < F; k++) columns[k * C + cube] = rows[cube * F + k];
      return columns;
    };
    const low = byQuantity(take(C * F)), high = byQuantity(take(C * F));
    ends = { low: { values: low, postures: take(C * F * N) }, high: { values: high, postures: take(C * F * N) } };
    layers = [0, 1, 2].map((axis) => [...new Set([...Array(C).keys()].map((cube) => centres[3 * cube + axis]))].sort((a, b) => a - b));
    if (!C || !F) { byId("field-controls").hidden = byId("field-scale").hidden = true; return; }
    const side = SIDE * data.size;
    cubes = new THREE.InstancedMesh(new THREE.BoxGeometry(side, side, side), new THREE.MeshBasicMaterial(), C);
    cubes.name = "cubes";
    cubes.frustumCulled = false;
    node(data.node).add(cubes);
    quantity.value = String(data.first);
    end.value = data.best[data.first];
    if (layers.every((of) => of.length > 1)) slice.value = "1"; // all of them would hide the robot
    cut();
  }
  window.ospaceMap = { data, put, pointed, describe, loaded: ready.then(load), get shown() { return shown; }, get cubes() { return cubes; }, get x() { return x; } };
})();
