// The QP's rows about distances, as the controller posed them (moma writes them down when it simulates the trial again), and the
// same in words: distances at their arrows, and a sentence on all of them.

import { Matrix4, Vector3 } from 'three';

import type { ReplayData } from '../data';
import { h, replace } from '../dom';
import { fixed, integer, plural } from '../format';
import { unpacked } from '../packed';
import type { Words } from './captioned_picture';
import type { ReplayScene } from './scene';

/** Numbers of a row, in the order of reports/render/replay_data.h. */
const kKinds = ['object', 'floor', 'self'] as const;
const kActive = 8;
const kColumns = 10;

export interface Row {
  kind: (typeof kKinds)[number];
  link: string;
  other: string;
  d: number;
  first: Vector3;    // on the robot
  second: Vector3;
  /** At its limit: it holds the command back. */
  active: boolean;
}

/** Rows of each sample, in the order of the problem; null where none were written down. Throws an Error where they do not fit. */
export function readRows({ rows, map }: ReplayData): Row[][] | null {
  if (rows === undefined) return null;
  const total = rows.n.reduce((sum, n) => sum + n, 0);
  const values = unpacked(rows.data, Int16Array);
  if (values.length !== kColumns * total) throw new Error('the rows do not fit their number');
  const at = (column: number, i: number): number => values[column * total + i] ?? 0;
  // The boxes of a map are objects of the controller's, numbered by chance.
  const ofMap = (name: string): string => name.replace(/^map\d+$/, 'the map').replace(/^unseen\d+$/, 'unseen space');
  const name = (i: number): string => (map === undefined ? rows.names[i] ?? '' : ofMap(rows.names[i] ?? ''));
  const point = (column: number, i: number): Vector3 => new Vector3(at(column, i), at(column + 1, i), at(column + 2, i)).divideScalar(1000);
  let next = 0;
  return rows.n.map((n) => Array.from({ length: n }, (): Row => {
    const i = next++;
    return { kind: kKinds[at(0, i) & (kActive - 1)] ?? 'object', active: at(0, i) >= kActive, link: name(at(1, i)), other: name(at(2, i)), d: at(3, i) / 10000, first: point(4, i), second: point(7, i) };
  }));
}

/** Moves the rows' ends with their links and objects. `place` gives a pose `then` and `now`. */
export function carried(rows: readonly Row[], place: (name: string, when: 'then' | 'now') => Matrix4): Row[] {
  const move = (point: Vector3, name: string): Vector3 => point.clone().applyMatrix4(place(name, 'then').clone().invert()).applyMatrix4(place(name, 'now'));
  return rows.map((row) => ({ ...row, first: move(row.first, row.link), second: move(row.second, row.other) }));
}

/** Most active rows whose distance is written. */
const kLabels = 8;

/** Height of a label [px], and how wide one is at most. */
const kHigh = 18;
const wide = (text: string): number => 9 + 7.6 * text.length;

const within = (value: number, low: number, high: number): number => Math.max(low, Math.min(high, value));

const millimetres = (row: Row): string => `${fixed(1000 * row.d, 0)} mm`;

const named = (row: Row): string => `${row.link} to ${row.other} ${millimetres(row)}`;

function nearest(rows: readonly Row[]): Row[] {
  return [...rows].sort((a, b) => a.d - b.d);
}

export class RowWords {
  /** Lies over the scene. */
  readonly labels = h('div', { class: 'row-labels', 'aria-hidden': 'true' });
  readonly sentence = h('p', { class: 'note rows-near' });
  /** Box for labels [px]. */
  private place = { top: 0, width: Infinity, height: Infinity };

  /** Keeps labels within the scene and below what is written at its top. */
  keepClear(stage: HTMLElement, caption: HTMLElement, changed: () => void): void {
    const observer = new ResizeObserver(() => {
      this.place = { top: caption.offsetTop + caption.offsetHeight, width: stage.clientWidth, height: stage.clientHeight };
      changed();
    });
    observer.observe(stage);
    observer.observe(caption);
  }

  /** Writes distances at the arrows of the rows that hold the command back, and of the nearest one. */
  label(scene: ReplayScene | null): Words['labels'] {
    const shown = nearest(scene?.rows ?? []).filter((row, i) => row.active || i === 0).slice(0, kLabels);
    const { top, width, height } = this.place;
    const written: { left: number; y: number; text: string; active: boolean }[] = [];
    for (const row of shown) {
      const at = scene?.project(row.first.clone().add(row.second).multiplyScalar(0.5)) ?? null;
      if (at === null) continue;
      const text = millimetres(row);
      // Right of its arrow, where there is room.
      const left = within(at[0] + 8 + wide(text) < width ? at[0] + 8 : at[0] - 8 - wide(text), 2, width - wide(text));
      const y = within(at[1], top + kHigh / 2, height - kHigh / 2);
      // Nearest first: what would lie over a nearer one's label is left out; the sentence names it.
      if (written.some((other) => Math.abs(other.left - left) < Math.max(wide(text), wide(other.text)) && Math.abs(other.y - y) < kHigh)) continue;
      written.push({ left, y, text, active: row.active });
    }
    replace(this.labels, ...written.map(({ left, y, text, active }) => h('span', { class: active ? 'active' : null, style: `left:${left.toFixed(1)}px;top:${y.toFixed(1)}px` }, text)));
    return written.map(({ left, y, text, active }) => ({ x: left + wide(text) / 2, y, text, active }));
  }

  /** `known`: whether the motion has rows at all; `disturbed`: what of the controller's senses is. What `stage` shows is told in its data too. */
  tell(rows: readonly Row[], known: boolean, disturbed: string, stage: HTMLElement): void {
    const active = rows.filter((row) => row.active);
    const first = nearest(rows)[0];
    const sentences = !known ? ['Its collision rows are not at hand: this moma cannot simulate the trial again, or its controller is another program\u2019s.'] : first === undefined ? ['No collision rows now: nothing is within the distance of influence.'] : [
      `${plural(rows.length, 'collision row')}, ${integer(active.length)} active (the command approaches as fast as allowed)${active.length > 0 ? `: ${active.slice(0, 4).map(named).join(', ')}` : ''}.`,
      `Nearest: ${named(first)}.`,
    ];
    if (known && disturbed !== '') sentences.push(`Rows are those of what the controller measured (disturbed: ${disturbed}); robot and objects stand where they truly were.`);
    this.sentence.textContent = sentences.join(' ');
    const distances = rows.filter((row) => row.kind === 'object').map((row) => row.d);
    Object.assign(stage.dataset, {
      leastDistance: distances.length > 0 ? String(Math.min(...distances)) : '', activeRows: String(active.length), arrows: String(rows.length),
    });
  }
}
