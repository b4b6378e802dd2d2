"use strict";
// The button of a finding shows its link: all else fades, axes stand in the link's frame, and the camera comes near.
(() => {
  const { THREE } = MeshCat;
  const { viewer, node } = window.ospace;
  const byId = (id) => document.getElementById(id);
  const shown = JSON.parse(byId("shown-data").textContent);
  const buttons = [...document.querySelectorAll("button[data-shown]")];
  const FADED = 0.07, NEAREST = 0.15, ROOM = 7; // share of opacity; of the distance; of the size of the link
  let before = null; // how the camera stood

  function paint(object, share) {
    object.traverse(({ material }) => {
      if (!material) return;
      const own = (material.userData.own ??= { opacity: material.opacity, transparent: material.transparent, depthWrite: material.depthWrite });
      const faded = share < 1;
      Object.assign(material, { opacity: share * own.opacity, transparent: faded || own.transparent, depthWrite: !faded && own.depthWrite, needsUpdate: true });
    });
  }

  function look(link) {
    const { camera, controls } = viewer;
    before ??= { position: camera.position.clone(), target: controls.target.clone() };
    camera.position.copy(before.position);
    controls.target.copy(before.target);
    if (link) {
      const box = new THREE.Box3(), centre = new THREE.Vector3().setFromMatrixPosition(node("/shown").matrixWorld);
      for (const path of link.paths) box.expandByObject(node(path));
      if (!box.isEmpty()) box.getCenter(centre);
      const size = box.isEmpty() ? 0 : box.getSize(new THREE.Vector3()).length();
      const arm = before.position.clone().sub(before.target), distance = arm.length();
      camera.parent.worldToLocal(controls.target.copy(centre));
      arm.setLength(Math.min(distance, Math.max(ROOM * size, NEAREST * distance)));
      camera.position.copy(controls.target).add(arm);
      node("/shown").scale.setScalar(Math.min(1, (2 * arm.length()) / distance));
    } else before = null;
    controls.update();
  }

  function show(button) {
    const link = button ? shown[Number(button.dataset.shown)] : null;
    for (const one of buttons) one.setAttribute("aria-pressed", String(one === button));
    byId("status").textContent = button ? `Shown: ${button.textContent}` : "";
    byId("labels").hidden = Boolean(button);
    paint(node("/robot"), link ? FADED : 1);
    const axes = node("/shown");
    axes.visible = Boolean(link);
    if (link) {
      for (const path of link.paths) paint(node(path), 1);
      viewer.set_transform(["shown"], link.at);
      axes.updateWorldMatrix(true, true);
      axes.traverse((one) => { if (one.material) { one.material.depthTest = false; one.renderOrder = 1; } }); // seen through the link
      byId("scene").scrollIntoView({ block: "nearest" });
    }
    look(link);
    viewer.set_dirty();
  }

  for (const button of buttons) {
    button.addEventListener("click", () => show(button.getAttribute("aria-pressed") === "true" ? null : button));
  }
  document.addEventListener("keydown", (event) => { if (event.key === "Escape" && before) show(null); });
  for (const link of document.querySelectorAll("a.code")) {
    link.addEventListener("click", () => { document.querySelector(link.hash).open = true; });
  }
})();
