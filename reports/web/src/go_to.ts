// Links within the page: their target stays below the bar while what lies above it is still being drawn.

let target: Element | null = null;
let place = 0;
let changes: ResizeObserver | null = null;

function align(): void {
  target?.scrollIntoView({ behavior: 'instant' });
  place = scrollY;
}

function release(): void {
  if (target === null) return;
  target = null;
  document.documentElement.style.overflowAnchor = '';
  changes?.disconnect();
}

/** Scrolls to a section and keeps it there, whatever changes its height above, until the reader scrolls, clicks or types. */
export function goToSection(id: string): void {
  const element = document.getElementById(id);
  if (element === null) return;
  if (changes === null) {
    changes = new ResizeObserver(align);
    for (const act of ['wheel', 'touchstart', 'pointerdown', 'keydown']) addEventListener(act, release, { capture: true, passive: true });
    // Dragging the scroll bar fires no event of its own; the browser's scroll anchoring is off, so any scroll that align() did not make is the reader's.
    addEventListener('scroll', () => { if (target !== null && Math.abs(scrollY - place) > 2 && scrollY + innerHeight < document.documentElement.scrollHeight - 2) release(); }, { passive: true });
  }
  target = element;
  document.documentElement.style.overflowAnchor = 'none';
  align();
  changes.observe(document.body);
}
