"use strict";
// A click on an entry of a legend hides what belongs to it; the pointer shows the values at its place, or the point that is near.
for (const figure of document.querySelectorAll("figure.chart")) {
  const picture = figure.querySelector(":scope > svg");
  const output = figure.querySelector("output");
  for (const button of figure.querySelectorAll(".legend button")) {
    button.addEventListener("click", () => {
      const shown = button.getAttribute("aria-pressed") !== "true";
      button.setAttribute("aria-pressed", String(shown));
      const parts = picture.querySelectorAll(`[data-series="${button.dataset.hides}"]`);
      for (const part of parts) part.style.visibility = shown ? "" : "hidden";
    });
  }
  const [left, right, top, bottom] = figure.dataset.edges.split(" ").map(Number);
  const [x0, x1, y0, y1] = figure.dataset.values.split(" ").map(Number);
  const points = JSON.parse(figure.dataset.points ?? "[]");
  const cross = document.createElementNS("http://www.w3.org/2000/svg", "path");
  cross.setAttribute("class", "cross");
  picture.append(cross);
  const leave = () => {
    output.textContent = "";
    cross.setAttribute("d", "");
  };
  picture.addEventListener("pointerleave", leave);
  const show = (event) => {
    const box = picture.getBoundingClientRect();
    const scale = picture.viewBox.baseVal.width / box.width;
    let [x, y] = [(event.clientX - box.left) * scale, (event.clientY - box.top) * scale];
    if (x < left || x > right || y < top || y > bottom) return leave();
    const away = (point) => Math.hypot(point[0] - x, point[1] - y);
    const near = points.filter((point) => away(point) < 14).sort((a, b) => away(a) - away(b));
    let name = "";
    if (near.length) {
      [x, y] = near[0];
      name = `${near.map((point) => point[2]).join(", ")} · `;
    }
    const value = (part, low, high) => Number((low + part * (high - low)).toPrecision(4));
    const at = value((x - left) / (right - left), x0, x1);
    const level = value((bottom - y) / (bottom - top), y0, y1);
    output.textContent = `${name}${figure.dataset.x}: ${at} · ${figure.dataset.y}: ${level}`;
    cross.setAttribute("d", `M${x} ${top}V${bottom}M${left} ${y}H${right}`);
  };
  picture.addEventListener("pointerdown", show);
  picture.addEventListener("pointermove", show);
}
// What is wider than the page says that it can be scrolled.
const hint = () => {
  for (const part of document.querySelectorAll(".wide")) {
    part.classList.toggle("scrolls", part.scrollWidth > part.clientWidth + 1);
  }
};
addEventListener("resize", hint);
addEventListener("toggle", hint, true);
hint();
