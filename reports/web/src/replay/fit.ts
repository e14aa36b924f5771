// Where the camera stands so that the whole of a motion is seen.

import { Matrix4, Vector3, type PerspectiveCamera } from 'three';

import type { Robot } from './robot';
import { poseAt } from './look';
import type { Trace } from './trace';

/** Of the picture's half height and width, this much is used. */
const kUsed = 0.9;
/** Nearer than this to the middle of what is seen the camera never is [m]. */
const kNearest = 0.6;

/** At least every tenth of a second, or sixty times: where base and hand are, with some room around them. */
export function extent(robot: Robot, trace: Trace): Vector3[] {
  const out: Vector3[] = [];
  const pose = new Matrix4();
  for (let t = 0; t <= trace.end; t += Math.max(0.1, trace.end / 60)) {
    poseAt(robot, trace, t);
    const base = new Vector3().setFromMatrixPosition(robot.pose('@base'));
    const hand = new Vector3().setFromMatrixPosition(robot.tipPose(pose));
    for (const [x, y] of [[-0.4, -0.4], [-0.4, 0.4], [0.4, -0.4], [0.4, 0.4]] as const) out.push(base.clone().add(new Vector3(x, y, 0)), base.clone().add(new Vector3(x, y, 0.8)));
    out.push(hand.clone().add(new Vector3(0, 0, 0.15)));
  }
  return out;
}

/**
 * Places the camera on the side of `towards` (a unit vector from what is seen to the camera), as near as all of `points`
 * allow. Returns the middle of the picture, which it looks at.
 */
export function fit(camera: PerspectiveCamera, points: readonly Vector3[], towards: Vector3): Vector3 {
  const right = new Vector3(0, 0, 1).cross(towards).normalize();
  const up = towards.clone().cross(right);
  // In the camera's axes: the middle of what is to be seen, then the distance from which all of it is.
  const span = (axis: Vector3): [number, number] => { const values = points.map((p) => p.dot(axis)); return [Math.min(...values), Math.max(...values)]; };
  const [r, u, d] = [span(right), span(up), span(towards)];
  const middle = right.clone().multiplyScalar((r[0] + r[1]) / 2).addScaledVector(up, (u[0] + u[1]) / 2).addScaledVector(towards, (d[0] + d[1]) / 2);
  const tall = Math.tan((camera.fov * Math.PI) / 360) * kUsed;
  const wide = tall * camera.aspect;
  let best = { middle: middle.clone(), away: Infinity };
  // What is near looks larger than what is far: the middle is moved to that of the picture, a few times, and the one kept
  // that lets the camera come nearest.
  for (let k = 0; k < 6; ++k) {
    const of = points.map((point) => point.clone().sub(middle)).map((p) => ({ d: p.dot(towards), r: p.dot(right), u: p.dot(up) }));
    const away = Math.max(kNearest, ...of.map((p) => p.d + Math.max(Math.abs(p.r) / wide, Math.abs(p.u) / tall)));
    if (away < best.away) best = { middle: middle.clone(), away };
    const across = (to: 'r' | 'u'): number => {
      const seen = of.map((p) => p[to] / Math.max(0.05, away - p.d));
      return (away * (Math.min(...seen) + Math.max(...seen))) / 2;
    };
    const [x, y] = [across('r'), across('u')];
    middle.addScaledVector(right, x).addScaledVector(up, y);
  }
  camera.position.copy(best.middle).addScaledVector(towards, best.away);
  return best.middle;
}
