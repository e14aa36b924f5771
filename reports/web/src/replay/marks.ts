// Marks of a scene, beside robot and objects: colours, a grid, axes, arrows, paths, the goal.

import { BufferGeometry, Color, ConeGeometry, CylinderGeometry, DoubleSide, Float32BufferAttribute, Group, LineBasicMaterial, LineSegments, Matrix4, Mesh, MeshBasicMaterial, MeshStandardMaterial, SphereGeometry, TorusGeometry, Vector3, type MeshStandardMaterialParameters } from 'three';
import { Line2 } from 'three/examples/jsm/lines/Line2.js';
import { LineGeometry } from 'three/examples/jsm/lines/LineGeometry.js';
import { LineMaterial } from 'three/examples/jsm/lines/LineMaterial.js';

import type { Palette } from '../theme';
import { poseAt, type Skin } from './look';
import type { Robot, SensorJson } from './robot';
import type { Row } from './rows';
import type { Trace } from './trace';

/** What robots and objects are made of. */
export function matt(colour: string, more: MeshStandardMaterialParameters = {}): MeshStandardMaterial {
  return new MeshStandardMaterial({ color: colour, roughness: 0.62, metalness: 0.05, ...more });
}

/** Lines one metre apart, in pieces of one metre: some drivers drop a long line that begins behind the camera. */
export function grid(colour: string): LineSegments {
  const reach = 15;
  const points: number[] = [];
  for (let a = -reach; a <= reach; ++a) {
    for (let b = -reach; b < reach; ++b) points.push(a, b, 0, a, b + 1, 0, b, a, 0, b + 1, a, 0);
  }
  return new LineSegments(new BufferGeometry().setAttribute('position', new Float32BufferAttribute(points, 3)), new LineBasicMaterial({ color: colour }));
}

/** An arrow from the origin along `direction`, a unit vector: a rod with a cone as its head. */
function arrow(direction: Vector3, length: number, rod: number, head: { length: number; radius: number }, material: MeshStandardMaterial): Group {
  const shaft = new Mesh(new CylinderGeometry(rod, rod, length - head.length, 10), material);
  shaft.position.y = (length - head.length) / 2;
  const cone = new Mesh(new ConeGeometry(head.radius, head.length, 14), material);
  cone.position.y = length - head.length / 2;
  const group = new Group().add(shaft, cone);
  group.quaternion.setFromUnitVectors(new Vector3(0, 1, 0), direction);
  return group;
}

/** A frame's axes: x red, y green, z blue. */
export function triad(size: number, solid: boolean): Group {
  const group = new Group();
  const axes: [Vector3, number][] = [[new Vector3(1, 0, 0), 0xd0453c], [new Vector3(0, 1, 0), 0x3d9a50], [new Vector3(0, 0, 1), 0x3b72c9]];
  for (const [axis, colour] of axes) {
    const material = new MeshStandardMaterial({ color: colour, transparent: !solid, opacity: solid ? 1 : 0.6, roughness: 0.6 });
    group.add(arrow(axis, size, 0.045 * size, { length: 0.2 * size, radius: 0.11 * size }, material));
  }
  return group;
}

/** A collision row as an arrow from the robot to what it must not touch; bold where it holds the command back. */
export function rowArrow({ first, second, active }: Row, colours: Palette['scene']): Group {
  const along = second.clone().sub(first);
  const length = along.length();
  if (length < 1e-4) return new Group();
  const thick = active ? 0.008 : 0.003;
  const material = new MeshStandardMaterial({ color: active ? colours.hit : colours.path, transparent: !active, opacity: active ? 1 : 0.45, depthTest: !active });
  const group = arrow(along.divideScalar(length), length, thick, { length: Math.min(0.5 * length, 5 * thick), radius: 2.4 * thick }, material);
  group.renderOrder = active ? 2 : 1;
  group.position.copy(first);
  return group;
}

/**
 * Path of the end effector, coloured from its begin to its end: all of it faint, what has been travelled bold. The bold
 * one has a piece between every two samples, to be shown by its geometry's instanceCount.
 */
export function handPath(robot: Robot, trace: Trace, begin: string, end: string): { all: Line2; travelled: Line2 } {
  const points = new Float32Array(3 * trace.n);
  const shades = new Float32Array(3 * trace.n);
  const pose = new Matrix4();
  const [from, to] = [new Color(begin), new Color(end)];
  for (let i = 0; i < trace.n; ++i) {
    poseAt(robot, trace, trace.t[i] ?? 0);
    robot.tipPose(pose);
    points.set([pose.elements[12] ?? 0, pose.elements[13] ?? 0, pose.elements[14] ?? 0], 3 * i);
    const shade = from.clone().lerp(to, trace.end > 0 ? (trace.t[i] ?? 0) / trace.end : 0);
    shades.set([shade.r, shade.g, shade.b], 3 * i);
  }
  const line = (opacity: number, linewidth: number): Line2 => {
    const out = new Line2(new LineGeometry().setPositions(points).setColors(shades), new LineMaterial({ vertexColors: true, transparent: true, opacity, linewidth }));
    out.frustumCulled = false;
    return out;
  };
  return { all: line(0.45, 1.5), travelled: line(1, 3) };
}

/** Places of the base as a line just above the floor, with a ring around the last of them. */
export function floorPath(places: readonly (readonly [number, number])[], colour: string): Group {
  const group = new Group();
  const [x, y] = places[places.length - 1] ?? [0, 0];
  if (places.length === 0) return group;
  const above = 0.012;
  if (places.length > 1) {
    const line = new Line2(new LineGeometry().setPositions(places.flatMap(([px, py]) => [px, py, above])), new LineMaterial({ color: colour, linewidth: 3 }));
    line.frustumCulled = false;
    group.add(line);
  }
  const ring = new Mesh(new TorusGeometry(0.09, 0.012, 8, 32), new MeshStandardMaterial({ color: colour, roughness: 0.8 }));
  ring.position.set(x, y, above);
  group.add(ring);
  return group;
}

/** Most that two rays of a drawn field are apart [rad]. */
const kApart = 0.1;

/** Field of view of a sensor to its range, in the sensor's axes: a part of a ball, flat where there is one row of rays. */
export function fieldMark({ field_of_view: [azimuth = 0, elevation = 0], range }: SensorJson, colour: string): Group {
  const [columns, rows] = [Math.ceil(azimuth / kApart), Math.ceil(elevation / kApart)];
  const point = (column: number, row: number): Vector3 => {
    const [a, e] = [azimuth * (column / columns - 0.5), rows === 0 ? 0 : elevation * (row / rows - 0.5)];
    return new Vector3(Math.cos(e) * Math.cos(a), Math.cos(e) * Math.sin(a), Math.sin(e)).multiplyScalar(range);
  };
  const steps = (n: number): number[] => Array.from({ length: n }, (_, i) => i);
  // The ends of the outermost rays, piece by piece.
  const rim = [...new Set([0, rows])].flatMap((k) => steps(columns).map((i) => [point(i, k), point(i + 1, k)]))
    .concat([0, columns].flatMap((i) => steps(rows).map((k) => [point(i, k), point(i, k + 1)])));
  const origin = new Vector3();
  const sides = rim.flatMap((piece) => [origin, ...piece]);
  const cap = steps(columns).flatMap((i) => steps(rows).flatMap((k) => {
    const [a, b, c, d] = [point(i, k), point(i + 1, k), point(i + 1, k + 1), point(i, k + 1)];
    return [a, b, c, a, c, d];
  }));
  const corners = [point(0, 0), point(columns, 0), point(0, rows), point(columns, rows)].flatMap((corner) => [origin, corner]);
  const glass = { color: colour, transparent: true, depthWrite: false };
  const group = new Group().add(
    new Mesh(new BufferGeometry().setFromPoints([...sides, ...cap]), new MeshBasicMaterial({ ...glass, opacity: 0.035, side: DoubleSide })),
    new LineSegments(new BufferGeometry().setFromPoints([...rim.flat(), ...corners]), new LineBasicMaterial({ ...glass, opacity: 0.6 })));
  group.matrixAutoUpdate = false;
  return group;
}

/** A ball that is smaller than this would not be seen [m]. */
const kLeast = 0.008;

/**
 * In the goal's axes. `skins`: what is drawn of the robot, of which the hand is taken; the robot may stand as it likes, for
 * its hand is rigid. `tolerance`: radius around the goal that counts as reached [m].
 */
export function goalMark(robot: Robot, skins: readonly Skin[], tolerance: number, colour: string): Group {
  const group = triad(0.26, true);
  group.add(new Mesh(new SphereGeometry(Math.max(tolerance, kLeast), 24, 16), matt(colour, { transparent: true, opacity: 0.75 })));
  const toTip = robot.tipPose(new Matrix4()).invert();
  for (const { surface, link, local } of skins) {
    if (!robot.inHand(link)) continue;
    const mesh = new Mesh(surface, matt(colour, { transparent: true, opacity: 0.24, depthWrite: false }));
    mesh.name = `hand: ${link}`;
    mesh.matrixAutoUpdate = false;
    mesh.matrix.copy(toTip).multiply(robot.pose(link)).multiply(local);
    group.add(mesh);
  }
  return group;
}
