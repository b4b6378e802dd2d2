"use strict";
// The curves go by the clock of the animation, and a click on one moves it.
(() => {
  const figures = [...document.querySelectorAll("figure")].map((figure) => {
    const { left, right, start, end } = Object.fromEntries(Object.entries(figure.dataset).map(([key, value]) => [key, Number(value)]));
    const cursor = figure.querySelector(".cursor");
    figure.addEventListener("click", (event) => {
      const box = figure.getBoundingClientRect();
      const share = ((event.clientX - box.left) / box.width - left) / (right - left);
      if (share >= 0 && share <= 1) window.ospace.seek(start + share * (end - start));
    });
    return (time) => { cursor.style.left = `${100 * (left + (right - left) * Math.min(1, Math.max(0, (time - start) / (end - start))))}%`; };
  });
  const move = (time) => figures.forEach((figure) => figure(time));
  document.addEventListener("ospace:time", (event) => move(event.detail));
  for (const button of document.querySelectorAll("#phases button")) button.addEventListener("click", () => window.ospace.seek(Number(button.dataset.time)));
  move(0);
})();
