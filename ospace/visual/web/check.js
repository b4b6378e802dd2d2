"use strict";
// The button of a finding shows its link: all else fades, and axes stand in the link's frame.
(() => {
  const { viewer, node } = window.ospace;
  const shown = JSON.parse(document.getElementById("shown-data").textContent);
  const buttons = [...document.querySelectorAll("button[data-shown]")];
  const FADED = 0.1;

  function paint(object, share) {
    object.traverse(({ material }) => {
      if (!material) return;
      const { opacity, transparent, depthWrite } = (material.userData.own ??= { ...material });
      const faded = share < 1;
      Object.assign(material, { opacity: share * opacity, transparent: faded || transparent, depthWrite: !faded && depthWrite, needsUpdate: true });
    });
  }

  function show(button) {
    for (const one of buttons) one.setAttribute("aria-pressed", String(one === button));
    document.getElementById("status").textContent = button ? `${button.textContent}: all else is faded` : "";
    paint(node("/robot"), button ? FADED : 1);
    node("/shown").visible = Boolean(button);
    if (button) {
      const { paths, at } = shown[Number(button.dataset.shown)];
      for (const path of paths) paint(node(path), 1);
      viewer.set_transform(["shown"], at);
      node("/shown").traverse((one) => { if (one.material) { one.material.depthTest = false; one.renderOrder = 1; } }); // seen through the link
      document.getElementById("scene").scrollIntoView({ block: "nearest" });
    }
    viewer.set_dirty();
  }

  for (const button of buttons) {
    button.addEventListener("click", () => show(button.getAttribute("aria-pressed") === "true" ? null : button));
  }
  document.addEventListener("keydown", (event) => { if (event.key === "Escape") show(null); });
  for (const link of document.querySelectorAll("a.code")) {
    link.addEventListener("click", () => { document.querySelector(link.hash).open = true; });
  }
})();
