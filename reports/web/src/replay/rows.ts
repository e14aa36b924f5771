// The QP's rows about distances, as the controller posed them: moma writes them down when it simulates the trial again.

import { Matrix4, Vector3 } from 'three';

import type { ReplayData } from '../data';
import { unpacked16 } from '../packed';

/** In the order of reports/render/replay_data.h. "end": of a capsule's end against an object; "passing": d is the gap, second lies on the side to pass on. */
const kKinds = ['object', 'floor', 'self', 'end', 'passing'] as const;
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
export function readRows({ rows }: ReplayData): Row[][] | null {
  if (rows === undefined) return null;
  const total = rows.n.reduce((sum, n) => sum + n, 0);
  const values = new Int16Array(unpacked16(rows.data).buffer);
  if (values.length !== kColumns * total) throw new Error('the rows do not fit their number');
  const at = (column: number, i: number): number => values[column * total + i] ?? 0;
  const name = (i: number): string => rows.names[i] ?? '';
  const point = (column: number, i: number): Vector3 => new Vector3(at(column, i), at(column + 1, i), at(column + 2, i)).divideScalar(1000);
  let next = 0;
  return rows.n.map((n) => Array.from({ length: n }, (): Row => {
    const i = next++;
    return { kind: kKinds[at(0, i) & (kActive - 1)] ?? 'object', active: at(0, i) >= kActive, link: name(at(1, i)), other: name(at(2, i)), d: at(3, i) / 10000, first: point(4, i), second: point(7, i) };
  }));
}

/** The same rows a little later: what their ends are on has moved. `place` gives the pose of a link or an object `then` and `now`. */
export function carried(rows: readonly Row[], place: (name: string, when: 'then' | 'now') => Matrix4): Row[] {
  const move = (point: Vector3, name: string): Vector3 => point.clone().applyMatrix4(place(name, 'then').clone().invert()).applyMatrix4(place(name, 'now'));
  return rows.map((row) => ({ ...row, first: move(row.first, row.link), second: move(row.second, row.kind === 'passing' ? row.link : row.other) }));
}
