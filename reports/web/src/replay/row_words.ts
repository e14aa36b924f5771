// Collision rows in words: distances at their arrows, and a sentence on all of them.

import { h, replace } from '../dom';
import { fixed, integer, plural } from '../format';
import type { Words } from './plate';
import type { Row } from './rows';
import type { ReplayScene } from './scene';

/** So many rows that hold the command back have their distance written. */
const kLabels = 8;

const millimetres = (row: Row): string => `${fixed(1000 * row.d, 0)} mm`;

const named = (row: Row): string => `${row.link} to ${row.other} ${row.kind === 'passing' ? `(passing, ${fixed(row.d, 2)} m)` : millimetres(row)}`;

export class RowWords {
  /** Lies over the scene. */
  readonly labels = h('div', { class: 'row-labels', 'aria-hidden': 'true' });
  readonly sentence = h('p', { class: 'note rows-near' });

  /** Writes distances at the arrows of the rows that hold the command back, and of the nearest one. */
  label(scene: ReplayScene | null): Words['labels'] {
    const shown = scene?.rows.filter((row, i) => row.kind !== 'passing' && (row.active || i === 0)).slice(0, kLabels) ?? [];
    const written: { x: number; y: number; text: string; active: boolean }[] = [];
    for (const row of shown) {
      const at = scene?.project(row.first.clone().add(row.second).multiplyScalar(0.5)) ?? null;
      // Nearest first: what would lie over a nearer one's label is left out; the sentence names it.
      if (at === null || written.some(({ x, y }) => Math.abs(x - at[0]) < 62 && Math.abs(y - at[1]) < 16)) continue;
      written.push({ x: at[0], y: at[1], text: millimetres(row), active: row.active });
    }
    replace(this.labels, ...written.map(({ x, y, text, active }) => h('span', { class: active ? 'active' : null, style: `left:${x.toFixed(1)}px;top:${y.toFixed(1)}px` }, text)));
    return written;
  }

  /** `disturbed`: what of the controller's senses is. What `stage` shows is told in its data too. */
  tell(rows: readonly Row[], disturbed: string, stage: HTMLElement): void {
    const active = rows.filter((row) => row.active);
    const of = (kind: Row['kind']): Row[] => rows.filter((row) => row.kind === kind);
    const [sides, ends] = [of('passing'), of('end')];
    const [first] = rows;
    const sentences = first === undefined ? ['No collision rows now: nothing is within the distance of influence.'] : [
      `${plural(rows.length, 'collision row')}${ends.length > 0 ? `, ${integer(ends.length)} of them of the ends of capsules` : ''}, ${integer(active.length)} active (the command approaches as fast as allowed)${active.length > 0 ? `: ${active.slice(0, 4).map(named).join(', ')}` : ''}.`,
      first.kind === 'passing' ? '' : `Nearest: ${named(first)}.`,
      sides.length > 0 ? `${plural(sides.length, 'row')} for passing objects: the long arrow points to the side that the base keeps to.` : '',
    ];
    if (disturbed !== '') sentences.push(`The controller saw measured poses, not these true ones (disturbed: ${disturbed}).`);
    this.sentence.textContent = sentences.filter((text) => text !== '').join(' ');
    const distances = of('object').map((row) => row.d);
    Object.assign(stage.dataset, {
      leastDistance: distances.length > 0 ? String(Math.min(...distances)) : '', activeRows: String(active.length), arrows: String(rows.length),
      ends: String(ends.length), passing: String(sides.length),
      // Of rows whose nearest point is no matter of choice, as it is of parallel shapes.
      leastRoom: String(Math.min(Infinity, ...[...ends, ...sides].map((row) => row.room))),
    });
  }
}
