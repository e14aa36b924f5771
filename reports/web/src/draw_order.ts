// When things are drawn: when they come near the window, when nothing else is to do, and for paper at once.

/** Parts within this distance of the window are drawn [px]. */
const kMargin = 300;

const waiting = new Map<Element, () => void>();
let observer: IntersectionObserver | null = null;

/** Made when first needed: figures are also drawn where there is no window. */
function seen(): IntersectionObserver {
  return observer ??= new IntersectionObserver((entries) => {
    for (const entry of entries) if (entry.isIntersecting) drawWaiting(entry.target);
  }, { rootMargin: `${kMargin}px` });
}

/** Calls back once, when the element comes near the window. */
export function whenSeen(element: Element, call: () => void): void {
  waiting.set(element, call);
  seen().observe(element);
}

export function isNear(element: Element): boolean {
  const box = element.getBoundingClientRect();
  return box.bottom > -kMargin && box.top < innerHeight + kMargin;
}

/** Parts that wait: they are drawn when they are seen, when the page is idle, or for paper. */
const figures: Element[] = [];

function drawWaiting(element: Element): void {
  const call = waiting.get(element);
  seen().unobserve(element);
  waiting.delete(element);
  call?.();
}

let idling = 0;

/** Draws the figures that nobody has looked at yet, one at a time, after so long [ms]: a picture of the whole page shows them. */
export function drawSoon(delay: number): void {
  const inTime = { timeout: 1000 };  // [ms]; a slow machine has no idle moment while a motion plays
  const idle = (): void => {
    const next = figures.find((element) => waiting.has(element));
    if (next === undefined) return;
    drawWaiting(next);
    requestIdleCallback(idle, inTime);
  };
  clearTimeout(idling);
  idling = window.setTimeout(() => requestIdleCallback(idle, inTime), delay);
}

const afterwards = new Set<() => void>();

/** Calls back after the next frame has been shown, or before the page is printed. */
export function afterFrame(call: () => void): void {
  afterwards.add(call);
  requestAnimationFrame(() => setTimeout(() => { if (afterwards.delete(call)) call(); }));
}

export function drawAll(): void {
  for (const call of afterwards) {   // those that are added meanwhile, too
    afterwards.delete(call);
    call();
  }
  figures.forEach(drawWaiting);
}

/** An element like a figure: first drawn when it is seen, or nothing else is to do. */
export function drawLater(element: Element, draw: () => void): void {
  figures.push(element);
  whenSeen(element, draw);
}

/** Draws now where the element is near the window, else when it comes there or nothing else is to do. */
export function drawOrWait(element: Element, draw: () => void): void {
  if (isNear(element)) {
    waiting.delete(element);
    draw();
    return;
  }
  whenSeen(element, draw);
  drawSoon(1500);
}
