/* What turns the figure: pointers, the wheel, keys and buttons. */

const TURNS = { // degrees; the arrows act as if what is near were pushed that way
  ArrowLeft: [6, 0],
  ArrowRight: [-6, 0],
  ArrowUp: [0, -5],
  ArrowDown: [0, 5],
};

/** Turns the figure by an arrow key; false if it is another key. */
export function turnByKey(figureView, key) {
  if (!TURNS[key]) return false;
  figureView.turn(...TURNS[key]);
  return true;
}

/** Does what a button of the views says. */
export function changeView(figureView, name) {
  if (name === "closer") figureView.zoom(1.25);
  else if (name === "farther") figureView.zoom(1 / 1.25);
  else figureView.go(name, performance.now());
}

/** Turns and zooms the figure by one or two pointers, and by the wheel. */
export function followPointers(canvas, figureView, redraw) {
  const pointers = new Map();
  let apart = 0;
  const spread = () => {
    const [a, b] = [...pointers.values()];
    return Math.hypot(a.x - b.x, a.y - b.y);
  };
  canvas.addEventListener("pointerdown", (event) => {
    canvas.setPointerCapture(event.pointerId);
    pointers.set(event.pointerId, { x: event.clientX, y: event.clientY });
    if (pointers.size === 2) apart = spread();
    canvas.classList.add("dragged");
  });
  canvas.addEventListener("pointermove", (event) => {
    const before = pointers.get(event.pointerId);
    if (!before) return;
    pointers.set(event.pointerId, { x: event.clientX, y: event.clientY });
    if (pointers.size === 1) figureView.turn(-0.5 * (event.clientX - before.x), 0.4 * (event.clientY - before.y));
    else if (pointers.size === 2) {
      const now = spread();
      if (apart > 0) figureView.zoom(now / apart);
      apart = now;
    }
    redraw();
  });
  for (const name of ["pointerup", "pointercancel"])
    canvas.addEventListener(name, (event) => {
      pointers.delete(event.pointerId);
      canvas.classList.toggle("dragged", pointers.size > 0);
    });
  canvas.addEventListener("wheel", (event) => {
    event.preventDefault();
    const across = event.shiftKey ? event.deltaX || event.deltaY : event.deltaX;
    if (Math.abs(across) > 0 && (event.shiftKey || Math.abs(across) > Math.abs(event.deltaY)))
      figureView.turn(0.15 * across, 0);
    else figureView.zoom(Math.exp(-0.0015 * event.deltaY));
    redraw();
  }, { passive: false });
}
