"""A page in a real browser, and what stands in its three.js scene."""

from pathlib import Path

import numpy as np

_SLOW = "GPU stall due to ReadPixels"  # a warning that the driver gives to who looks closely at a picture
_MS = 30_000
_PLACE = """
  const { THREE } = MeshCat, { scene } = ospace.viewer;
  scene.updateMatrixWorld(true);
  const back = scene.matrixWorld.clone().invert();  // meshcat's scene stands with its z axis upwards
  const place = (one) => one.matrixWorld.clone().premultiply(back);
"""
_MESHES = (
    f"""() => {{{_PLACE}"""
    """
  const found = [], at = new THREE.Vector3();
  scene.traverse((one) => {
    if (!one.isMesh) return;
    const path = [], position = one.geometry.getAttribute("position"), { index } = one.geometry;
    let shown = true;
    for (let up = one; up && up !== scene; up = up.parent) { path.unshift(up.name); shown &&= up.visible; }
    const box = new THREE.Box3(), T = place(one);
    for (let k = 0; k < position.count; k++)
      box.expandByPoint(at.fromBufferAttribute(position, k).applyMatrix4(T));
    found.push({
      path: "/" + path.filter(Boolean).join("/"), shown,
      triangles: (index ? index.count : position.count) / 3,
      lower: box.min.toArray(), upper: box.max.toArray(), world: T.elements,
      colour: one.material.color.getHex(), opacity: one.material.opacity,
    });
  });
  return found;
}"""
)
_PLACED = f"""(paths) => {{{_PLACE} return paths.map((path) => place(ospace.node(path)).elements); }}"""
_ALONG = f"""([paths, times]) => times.map((time) => {{
  ospace.seek(time); {_PLACE}
  return paths.map((path) => place(ospace.node(path)).elements);
}})"""

# Of a scene whose numbers alone are wanted, nothing is drawn: by a processor it takes most of the time.
_UNDRAWN = """(() => {
  let kept;
  Object.defineProperty(window, "ospace", {
    get: () => kept,
    set: (made) => { kept = made; made.viewer.renderer.render = () => {}; },
  });
})()"""


class Opened:
    """A page of its own context: a text, which is written to `file` and read without a network, or an address."""

    def __init__(self, browser, source, file, size, bare=False, drawn=False):
        self.address = source if str(source).startswith("http://") else None
        if self.address is None:
            if not isinstance(source, Path):
                file.write_text(source, encoding="utf-8")
                source = file
            self.address = source.resolve().as_uri()
        live = self.address.startswith("http://")
        width, height = size
        self._context = browser.new_context(viewport={"width": width, "height": height}, offline=not live)
        self._context.set_default_timeout(_MS)
        self.page = self._context.new_page()
        if not drawn:
            self.page.add_init_script(_UNDRAWN)
        self.requests, self.complaints = [], []
        self.page.on("request", lambda request: self.requests.append(request.url))
        self.page.on("websocket", lambda socket: self.requests.append(socket.url))
        self.page.on("pageerror", lambda error: self.complaints.append(str(error)))
        self.page.on("console", self._said)
        self.page.goto(self.address)
        if not bare:
            self.page.evaluate("window.ospace.ready")

    def _said(self, message):
        if message.type in ("error", "warning") and _SLOW not in message.text:
            self.complaints.append(f"{message.type}: {message.text}")

    def judge(self):
        """Fail where the page asked for anything but itself, or complained."""
        own = self.address.replace("http://", "ws://") + "socket" if self.address.startswith("http://") else None
        foreign = [
            url for url in self.requests if url not in (self.address, own) and not url.startswith(("data:", "blob:"))
        ]
        assert foreign == []
        assert self.complaints == []

    def close(self):
        self._context.close()

    def __getattr__(self, name):
        return getattr(self.page, name)

    def meshes(self):
        """Return what is made of triangles, by path: shown, triangles, lower, upper, world (4, 4), colour, opacity."""
        found = {}
        for one in self.page.evaluate(_MESHES):
            assert one["path"] not in found
            found[one["path"]] = one | {"world": matrix(one["world"])}
        return found

    def placed(self, *paths):
        """Return where nodes are in the world, (N, 4, 4)."""
        return np.array([matrix(one) for one in self.page.evaluate(_PLACED, list(paths))])

    def along(self, paths, times):
        """Return where nodes are at times, (T, N, 4, 4)."""
        found = self.page.evaluate(_ALONG, [list(paths), [float(time) for time in times]])
        return np.array([[matrix(one) for one in nodes] for nodes in found])

    def until(self, condition, argument=None):
        """Wait until a function of the page returns something true."""
        return self.page.wait_for_function(condition, arg=argument, timeout=_MS)


def matrix(elements):
    """Return a matrix of three.js, which is stored by columns."""
    return np.array(elements, dtype=float).reshape(4, 4).T
