// Distance and nearest points of two convex shapes: GJK (Gilbert, Johnson and Keerthi, IEEE J. Robot. Autom. 4, 1988) on
// their cores, spheres and capsules being points and segments with a radius.

import { Matrix4, Vector3 } from 'three';

import type { ShapeJson } from './robot';

/** A shape's core in its own frame. */
export interface Core {
  /** Farthest point of the core along a direction. */
  support: (direction: Vector3, out: Vector3) => Vector3;
  radius: number;
  /** Half the length of a capsule between the centres of its caps; 0 for what is no capsule. */
  half: number;
  /** Of a ball around the shape's origin that holds all of it. */
  reach: number;
}

export function coreOf(shape: ShapeJson): Core {
  const [a = 0, b = 0, c = 0] = shape.size ?? [];
  const sign = (v: number): number => (v < 0 ? -1 : 1);
  switch (shape.shape) {
    case 'box':
      return { radius: 0, half: 0, reach: Math.hypot(a, b, c) / 2, support: (d, out) => out.set((sign(d.x) * a) / 2, (sign(d.y) * b) / 2, (sign(d.z) * c) / 2) };
    case 'capsule':
      return { radius: a, half: b / 2, reach: a + b / 2, support: (d, out) => out.set(0, 0, (sign(d.z) * b) / 2) };
    case 'cylinder':
      return {
        radius: 0, half: 0, reach: Math.hypot(a, b / 2),
        support: (d, out) => {
          const flat = Math.hypot(d.x, d.y);
          return out.set(flat > 1e-12 ? (a * d.x) / flat : 0, flat > 1e-12 ? (a * d.y) / flat : 0, (sign(d.z) * b) / 2);
        },
      };
    case 'convex': {
      const v = shape.vertices ?? [];
      let reach = 0;
      for (let i = 0; i + 2 < v.length; i += 3) reach = Math.max(reach, Math.hypot(v[i] ?? 0, v[i + 1] ?? 0, v[i + 2] ?? 0));
      return {
        radius: 0, half: 0, reach,
        support: (d, out) => {
          let best = -Infinity;
          for (let i = 0; i + 2 < v.length; i += 3) {
            const along = (v[i] ?? 0) * d.x + (v[i + 1] ?? 0) * d.y + (v[i + 2] ?? 0) * d.z;
            if (along <= best) continue;
            best = along;
            out.set(v[i] ?? 0, v[i + 1] ?? 0, v[i + 2] ?? 0);
          }
          return out;
        },
      };
    }
    default:
      return { radius: a, half: 0, reach: a, support: (_, out) => out.set(0, 0, 0) };
  }
}

/** A point of the difference of two cores, with the points that make it. */
interface Corner { a: Vector3; b: Vector3; w: Vector3 }

/** Weights of the corners' point nearest to the origin: over every face, the one whose weights are all positive. */
function nearest(corners: readonly Corner[]): number[] {
  let best: number[] = [];
  let least = Infinity;
  for (let face = 1; face < 1 << corners.length; ++face) {
    const used = corners.map((_, i) => i).filter((i) => face & (1 << i));
    const weights = affine(used.map((i) => corners[i]!.w));
    if (weights === null || weights.some((w) => w < 0)) continue;
    const point = new Vector3();
    used.forEach((i, k) => point.addScaledVector(corners[i]!.w, weights[k]!));
    const size = point.lengthSq();
    if (size >= least) continue;
    least = size;
    best = corners.map((_, i) => (face & (1 << i) ? weights[used.indexOf(i)]! : 0));
  }
  return best;
}

/** Weights, of sum 1, of the point nearest to the origin in the points' affine hull; null where they are degenerate. */
function affine(points: readonly Vector3[]): number[] | null {
  const [first] = points;
  const k = points.length - 1;
  if (first === undefined) return null;
  const edges = points.slice(1).map((p) => p.clone().sub(first));
  const m = edges.map((e, i) => [...edges.map((f) => e.dot(f)), -(edges[i] ?? e).dot(first)]);
  let scale = 0;
  for (let i = 0; i < k; ++i) scale = Math.max(scale, m[i]![i]!);
  for (let i = 0; i < k; ++i) {   // Gauss on a symmetric matrix of at most 3 rows
    let pivot = i;
    for (let r = i + 1; r < k; ++r) if (Math.abs(m[r]![i]!) > Math.abs(m[pivot]![i]!)) pivot = r;
    [m[i], m[pivot]] = [m[pivot]!, m[i]!];
    if (Math.abs(m[i]![i]!) <= 1e-13 * scale) return null;
    for (let r = 0; r < k; ++r) {
      if (r === i) continue;
      const factor = m[r]![i]! / m[i]![i]!;
      for (let c = i; c <= k; ++c) m[r]![c]! -= factor * m[i]![c]!;
    }
  }
  const rest = m.map((row, i) => row[k]! / row[i]!);
  return [1 - rest.reduce((sum, w) => sum + w, 0), ...rest];
}

export interface Nearest { d: number; first: Vector3; second: Vector3 }

const kSteps = 64;

/** Nearest points of two placed shapes, in world axes; null where their cores touch, so that there is no direction. */
export function nearestPoints(first: Core, place1: Matrix4, second: Core, place2: Matrix4): Nearest | null {
  const inverse1 = place1.clone().invert();
  const inverse2 = place2.clone().invert();
  const corner = (direction: Vector3): Corner => {
    const a = first.support(direction.clone().transformDirection(inverse1), new Vector3()).applyMatrix4(place1);
    const b = second.support(direction.clone().negate().transformDirection(inverse2), new Vector3()).applyMatrix4(place2);
    return { a, b, w: a.clone().sub(b) };
  };
  let corners = [corner(new Vector3().setFromMatrixPosition(place2).sub(new Vector3().setFromMatrixPosition(place1)))];
  let weights = [1];
  const point = corners[0]!.w.clone();
  for (let step = 0; step < kSteps; ++step) {
    const size = point.lengthSq();
    if (size < 1e-16) return null;
    const next = corner(point.clone().negate());
    if (size - point.dot(next.w) <= 1e-9 * size || corners.some((c) => c.w.distanceToSquared(next.w) < 1e-18)) break;
    corners.push(next);
    weights = nearest(corners);
    if (weights.length === 0) break;
    corners = corners.filter((_, i) => weights[i]! > 0);
    weights = weights.filter((w) => w > 0);
    point.set(0, 0, 0);
    corners.forEach((c, i) => point.addScaledVector(c.w, weights[i]!));
    if (corners.length === 4) return null;
  }
  const core = point.length();
  if (core < 1e-8) return null;
  const [a, b] = [new Vector3(), new Vector3()];
  corners.forEach((c, i) => { a.addScaledVector(c.a, weights[i]!); b.addScaledVector(c.b, weights[i]!); });
  const n = point.divideScalar(core);   // from the second to the first
  return { d: core - first.radius - second.radius, first: a.addScaledVector(n, -first.radius), second: b.addScaledVector(n, second.radius) };
}
