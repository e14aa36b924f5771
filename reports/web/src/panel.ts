// Panels between the page's figures: they are filled when seen, and offer their data as CSV.

import { drawLater, drawOrWait } from './draw_order';
import { download, h } from './dom';
import { csv } from './format';
import { onTheme } from './theme';
import { onView } from './view';

/** Fills a part now, and anew for each other view or theme. */
export function keepFilled(fill: () => void): void {
  fill();
  onView(fill);
  onTheme(fill);
}

/** Fills a slow part when it comes near the window, or when the page is idle. */
export function fillLater(element: HTMLElement, fill: () => void): void {
  drawLater(element, fill);
  const refill = (): void => drawOrWait(element, fill);
  onView(refill);
  onTheme(refill);
}

/** A button that saves a table; `data` gives it when it is clicked. */
export function saveCsv(name: string, columns: readonly string[], data: () => readonly (readonly (string | number | null)[])[]): HTMLButtonElement {
  return h('button', { type: 'button', class: 'quiet', click: () => download(`${name}.csv`, 'text/csv', csv(columns, data())) }, 'Data CSV');
}
