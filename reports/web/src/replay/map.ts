// The map of a controller that is told by depth (docs/explanation/map.md), as boxes of occupied and of unseen cells: moma writes
// them down when it simulates the trial again.

import { BoxGeometry, BufferAttribute, BufferGeometry, EdgesGeometry, Group, LineBasicMaterial, LineSegments, Mesh, MeshStandardMaterial } from 'three';

import type { ReplayData } from '../data';
import { columnsOf, unpacked } from '../packed';
import { between } from './motion';
import type { Gaze } from './robot';

/** Numbers of a box, in the order of reports/render/replay_data.h. */
const kColumns = 9;

export const kCells = ['occupied', 'unseen'] as const;
export type Cells = (typeof kCells)[number];

interface MapBox {
  cells: Cells;
  /** Pictures of the map: shown from one on, until before the other. */
  from: number; to: number;
  low: number[]; size: number[];   // [m]
}

/** `hz`: pictures per second. `looks`: of each sensor whose head turns. */
export interface SeenMap { hz: number; pictures: number; boxes: MapBox[]; looks: (({ t: number } & Gaze)[] | undefined)[] }

/** The map of a motion; null without one. Throws an Error where it does not fit its columns. */
export function readMap({ map }: ReplayData): SeenMap | null {
  if (map === undefined) return null;
  const values = unpacked(map.data, Int16Array);
  const count = values.length / kColumns;
  if (!Number.isInteger(count)) throw new Error('the map does not fit its columns');
  const at = (column: number, i: number): number => values[column * count + i] ?? 0;
  const metres = (column: number, i: number): number[] => [0, 1, 2].map((k) => map.cell * at(column + k, i));
  const boxes = Array.from({ length: count }, (_, i): MapBox => ({ from: at(0, i), to: at(1, i), cells: at(2, i) === 1 ? 'occupied' : 'unseen', low: metres(3, i), size: metres(6, i) }));
  const { n } = map.looks;
  const columns = columnsOf(map.looks.data, n, 4, 'the looks of sensors');
  const looks: SeenMap['looks'] = [];
  for (let i = 0; i < n; ++i) (looks[columns[i] ?? 0] ??= []).push({ t: columns[n + i] ?? 0, pan: columns[2 * n + i] ?? 0, tilt: columns[3 * n + i] ?? 0 });
  return { hz: map.hz, pictures: boxes.reduce((most, { to }) => Math.max(most, to), 0), boxes, looks };
}

/** The picture of the map at time t: the last one before it. */
export function pictureAt({ hz, pictures }: SeenMap, t: number): number {
  return Math.min(Math.floor(t * hz + 1e-4), pictures - 1);
}

/** Where a sensor looks at time t; straight ahead where it never turns. */
export function gazeAt(map: SeenMap | null, sensor: number, t: number): Gaze {
  const looks = map?.looks[sensor] ?? [];
  const [i, s] = between(looks.map((look) => look.t), t);
  const [a, b] = [looks[i], looks[i + 1] ?? looks[i]];
  if (a === undefined || b === undefined) return { pan: 0, tilt: 0 };
  return { pan: a.pan + s * (b.pan - a.pan), tilt: a.tilt + s * (b.tilt - a.tilt) };
}

const kFaces = new BoxGeometry(1, 1, 1).toNonIndexed();
const kEdges = new EdgesGeometry(kFaces);

/** A shape of edge 1 about the origin, once for each box. */
function each(unit: BufferGeometry, boxes: readonly MapBox[]): BufferGeometry {
  const corners = unit.getAttribute('position').array;
  const points = new Float32Array(corners.length * boxes.length);
  boxes.forEach(({ low, size }, i) => {
    for (let k = 0; k < corners.length; ++k) points[i * corners.length + k] = (low[k % 3] ?? 0) + (0.5 + (corners[k] ?? 0)) * (size[k % 3] ?? 0);
  });
  return new BufferGeometry().setAttribute('position', new BufferAttribute(points, 3));
}

/** Opacity of a box's faces and of its edges. */
const kOpacity: Record<Cells, [number, number]> = { occupied: [0.3, 0.6], unseen: [0.1, 0.45] };

export function mapMark(cells: Cells, boxes: readonly MapBox[], colour: string): Group {
  const [faces, edges] = kOpacity[cells];
  const glass = { color: colour, transparent: true, depthWrite: false };
  return new Group().add(
    new Mesh(each(kFaces, boxes), new MeshStandardMaterial({ ...glass, opacity: faces, roughness: 0.9, flatShading: true })),
    new LineSegments(each(kEdges, boxes), new LineBasicMaterial({ ...glass, opacity: edges })));
}
