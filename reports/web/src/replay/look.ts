// The robot in a scene: the visual elements of its URDF, as reports/render/mesh_data.h writes them, the shapes of links that have
// none, and their poses.

import { BoxGeometry, BufferAttribute, BufferGeometry, CapsuleGeometry, Color, CylinderGeometry, Float32BufferAttribute, Matrix4, SphereGeometry } from 'three';
import { toCreasedNormals } from 'three/examples/jsm/utils/BufferGeometryUtils.js';

import { unpacked } from '../packed';
import { poseMatrix, type Robot, type ShapeJson } from './robot';
import type { Trace } from './trace';

interface PartJson {
  link: string; position: number[]; rotation: number[]; colour?: number[];
  shape?: string; size?: number[];
  n?: number; low?: number[]; step?: number; vertices?: string; triangles?: string;
}

/** A surface fixed to a link: a visual, or a shape of a link that has none. */
export interface Skin { surface: BufferGeometry; link: string; local: Matrix4; colour: string | null }

/** Edges sharper than this stay edges [rad]. */
const kCrease = 0.6;

function surface({ shape, size, n = 0, low = [], step = 0, vertices = '', triangles = '' }: PartJson): BufferGeometry {
  if (shape !== undefined) return solid(size === undefined ? { shape } : { shape, size });
  const places = unpacked(vertices, Uint16Array);
  if (places.length !== 3 * n) throw new Error('a mesh does not fit its number of vertices');
  const points = new Float32Array(3 * n);
  for (let i = 0; i < points.length; ++i) points[i] = (low[i % 3] ?? 0) + step * (places[i] ?? 0);
  const changes = unpacked(triangles, Uint16Array);
  const indices = new Uint16Array(changes.length);
  let last = 0;
  for (let i = 0; i < changes.length; ++i) indices[i] = last = (last + (changes[i] ?? 0)) & 0xffff;
  const mesh = new BufferGeometry();
  mesh.setAttribute('position', new BufferAttribute(points, 3));
  mesh.setIndex(new BufferAttribute(indices, 1));
  return toCreasedNormals(mesh, kCrease);
}

/** Throws an Error where a mesh cannot be read. */
export function readLook(look: unknown): Skin[] {
  return ((look ?? []) as PartJson[]).map((part) => {
    const [r = 0, g = 0, b = 0] = part.colour ?? [];
    return {
      link: part.link, local: poseMatrix(part), surface: surface(part),
      colour: part.colour === undefined ? null : `#${new Color().setRGB(r, g, b, 'srgb').getHexString()}`,
    };
  });
}

export function solid(shape: ShapeJson): BufferGeometry {
  const [a = 0.05, b = 0.1, c = 0.1] = shape.size ?? [];
  switch (shape.shape) {
    case 'box': return new BoxGeometry(a, b, c);
    case 'cylinder': return new CylinderGeometry(a, a, b, 32).rotateX(Math.PI / 2);
    case 'capsule': return new CapsuleGeometry(a, b, 6, 24).rotateX(Math.PI / 2);
    case 'convex': {
      const out = new BufferGeometry();
      out.setAttribute('position', new Float32BufferAttribute((shape.vertices ?? []).flat(), 3));
      out.setIndex((shape.triangles ?? []).flat());
      const flat = out.toNonIndexed();
      flat.computeVertexNormals();
      return flat;
    }
    default: return new SphereGeometry(a, 24, 16);
  }
}

const kWheel = 0.05;

/** Wheels of a base that has no visuals, each on its axle along y and on the floor. */
export function wheels(robot: Robot, look: readonly Skin[]): Skin[] {
  const { radius, separation, wheelbase = 0 } = robot.wheels ?? {};
  if (radius === undefined || separation === undefined || look.some((part) => robot.has(part.link) && robot.rigid(part.link) === '@base')) return [];
  return (wheelbase > 0 ? [-wheelbase / 2, wheelbase / 2] : [0]).flatMap((x) => [-1, 1].map((side) => ({
    surface: new CylinderGeometry(radius, radius, kWheel, 28), link: '@base', colour: null, local: new Matrix4().makeTranslation(x, (side * separation) / 2, radius),   // three's cylinders lie along y
  })));
}

/** One visual among links that are rigid with each other is enough: their shapes are then left out. */
export function skins(robot: Robot, look: readonly Skin[]): Skin[] {
  const seen = new Set(look.filter((part) => robot.has(part.link)).map((part) => robot.rigid(part.link)));
  const bare = (link: string): boolean => !seen.has(robot.rigid(link));
  return [
    ...look.filter((part) => robot.has(part.link)),
    ...robot.shapes.filter((s) => robot.has(s.link) && bare(s.link)).map(({ link, shape, local }) => ({ surface: solid(shape), link, local, colour: null })),
  ];
}

/** Puts the robot where it is at time t of its motion, or at the motion's end. */
export function poseAt(robot: Robot, trace: Trace, t: number): void {
  const at = Math.min(t, trace.end);
  robot.update(trace.at('base_x', at), trace.at('base_y', at), trace.at('base_phi', at), (i) => trace.at(`q${i}`, at));
}
