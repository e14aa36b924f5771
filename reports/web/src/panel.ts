// Panels between the page's figures: they are filled when seen, and offer their data as CSV.

import { drawLater, drawOrWait } from './draw_order';
import { button, download, h, type Child } from './dom';
import { csv, type Table } from './format';
import * as state from './state';
import { kView } from './view';

/** Fills a part now, and anew for each other view or theme. */
export function keepFilled(fill: () => void): void {
  fill();
  state.listen([...kView, 'theme'], fill);
}

/** Fills a slow part when it comes near the window, or when the page is idle; anew for each other view or theme, or change of `more`. */
export function fillLater(element: HTMLElement, fill: () => void, ...more: string[]): void {
  drawLater(element, fill);
  state.listen([...kView, 'theme', ...more], () => drawOrWait(element, fill));
}

/** A button that saves a table; `data` gives it when it is clicked, null where there is none. */
export function saveCsv(name: string, data: () => Table | null): HTMLButtonElement {
  return button('Data CSV', () => {
    const table = data();
    if (table !== null) download(`${name}.csv`, new Blob([csv(table)], { type: 'text/csv' }));
  });
}

/** What stands below a figure or a table: a note, and what can be done with it. */
export function footer(note: Child, ...actions: Node[]): HTMLElement {
  return h('footer', null, note, h('div', { class: 'actions' }, ...actions));
}
