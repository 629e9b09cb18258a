"use strict";
// A click on an entry of a legend hides its curve; the pointer shows the values at its place.
for (const figure of document.querySelectorAll("figure.chart")) {
  const picture = figure.querySelector(":scope > svg");
  const output = figure.querySelector("output");
  for (const button of figure.querySelectorAll(".legend button")) {
    button.addEventListener("click", () => {
      const shown = button.getAttribute("aria-pressed") !== "true";
      button.setAttribute("aria-pressed", String(shown));
      const colour = button.dataset.colour;
      const parts = `polyline[stroke="${colour}"],circle[fill="${colour}"],rect[fill="${colour}"]`;
      for (const part of picture.querySelectorAll(parts)) part.style.visibility = shown ? "" : "hidden";
    });
  }
  const [left, right, top, bottom] = figure.dataset.edges.split(" ").map(Number);
  const [x0, x1, y0, y1] = figure.dataset.values.split(" ").map(Number);
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
    const [x, y] = [(event.clientX - box.left) * scale, (event.clientY - box.top) * scale];
    if (x < left || x > right || y < top || y > bottom) return leave();
    const value = (part, low, high) => Number((low + part * (high - low)).toPrecision(4));
    const at = value((x - left) / (right - left), x0, x1);
    const level = value((bottom - y) / (bottom - top), y0, y1);
    output.textContent = `${figure.dataset.x}: ${at} · ${figure.dataset.y}: ${level}`;
    cross.setAttribute("d", `M${x} ${top}V${bottom}M${left} ${y}H${right}`);
  };
  picture.addEventListener("pointerdown", show);
  picture.addEventListener("pointermove", show);
}
