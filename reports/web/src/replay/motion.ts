// Motions of objects and goals: the motions of world files, evaluated as world/motion.cc does.

import { Quaternion, Vector3 } from 'three';

import { quaternion } from './robot';

export interface MotionJson {
  kind: string;
  velocity?: number[];
  times?: number[]; positions?: number[][]; quaternions?: number[][];
  center?: number[]; axis?: number[]; rate?: number;
}

export interface Placed { position: Vector3; turn: Quaternion }

export function vector(values: readonly number[] | undefined): Vector3 {
  const [x = 0, y = 0, z = 0] = values ?? [];
  return new Vector3(x, y, z);
}

/** Interval of `times` that holds t, and how far into it (0 to 1); held at the ends. */
export function between(times: readonly number[], t: number): [number, number] {
  const last = times.length - 1;
  if (t <= (times[0] ?? 0)) return [0, 0];
  if (t >= (times[last] ?? 0)) return [Math.max(0, last - 1), 1];
  let i = 0;
  while (i + 1 < last && (times[i + 1] ?? 0) <= t) ++i;
  return [i, (t - (times[i] ?? 0)) / ((times[i + 1] ?? 1) - (times[i] ?? 0))];
}

/** Second derivatives of the natural cubic spline at its knots, one coordinate. */
function curvatures(times: readonly number[], values: readonly number[]): number[] {
  const n = times.length;
  const m = new Array<number>(n).fill(0);
  const upper = new Array<number>(n).fill(0);
  const at = (list: readonly number[], i: number): number => list[i] ?? 0;
  for (let i = 1; i + 1 < n; ++i) {
    const h0 = at(times, i) - at(times, i - 1);
    const h1 = at(times, i + 1) - at(times, i);
    const right = 6 * ((at(values, i + 1) - at(values, i)) / h1 - (at(values, i) - at(values, i - 1)) / h0);
    const pivot = 2 * (h0 + h1) - h0 * at(upper, i - 1);
    upper[i] = h1 / pivot;
    m[i] = (right - h0 * at(m, i - 1)) / pivot;
  }
  for (let i = n - 2; i > 0; --i) m[i] = at(m, i) - at(upper, i) * at(m, i + 1);
  return m;
}

/** For each object the column of samples with the time of its motion; '' where that is the trial's time. */
export function clocksOf(objects: readonly { yields?: unknown }[]): string[] {
  let givingWay = 0;
  return objects.map(({ yields }) => (yields === undefined ? '' : `object_time${givingWay++}`));
}

/** The pose at time t of what starts at `start`. */
export function placeAt(motion: MotionJson | undefined, start: Placed, t: number): Placed {
  const position = start.position.clone();
  const turn = start.turn.clone();
  switch (motion?.kind) {
    case 'linear': {
      const rate = vector(motion.velocity?.slice(0, 3));
      const speed = rate.length();
      if (speed > 0) turn.premultiply(new Quaternion().setFromAxisAngle(rate.divideScalar(speed), speed * t));
      position.addScaledVector(vector(motion.velocity?.slice(3, 6)), t);
      break;
    }
    case 'path': case 'spline': {
      const { times = [], positions = [], quaternions = [] } = motion;
      if (times.length === 0) break;
      const [i, b] = between(times, t);
      const j = Math.min(i + 1, times.length - 1);
      if (motion.kind === 'path') {
        position.copy(vector(positions[i])).lerp(vector(positions[j]), b);
        if (quaternions.length > 0) turn.copy(quaternion(quaternions[i])).slerp(quaternion(quaternions[j]), b);
        break;
      }
      const h = (times[j] ?? 0) - (times[i] ?? 0);
      const a = 1 - b;
      const coordinate = (k: number): number => {
        const values = positions.map((p) => p[k] ?? 0);
        const m = curvatures(times, values);
        return a * (values[i] ?? 0) + b * (values[j] ?? 0) + (((a ** 3 - a) * (m[i] ?? 0) + (b ** 3 - b) * (m[j] ?? 0)) * h * h) / 6;
      };
      position.set(coordinate(0), coordinate(1), coordinate(2));
      break;
    }
    case 'circle': {
      const centre = vector(motion.center);
      const by = new Quaternion().setFromAxisAngle(vector(motion.axis ?? [0, 0, 1]).normalize(), (motion.rate ?? 0) * t);
      position.sub(centre).applyQuaternion(by).add(centre);
      turn.premultiply(by);
      break;
    }
    default:
  }
  return { position, turn };
}
