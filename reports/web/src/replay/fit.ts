// Place of the camera that shows the whole of a motion.

import { Matrix4, Vector3, type PerspectiveCamera } from 'three';

import type { Robot } from './robot';
import { poseAt } from './look';
import type { Trace } from './trace';

/** Used share of the picture's half height and width. */
const kUsed = 0.9;
/** Nearer than this to the middle of what is seen, or to any point of it, which its near plane would cut off, the camera never is [m]. */
const kNearest = 0.6;
const kClear = 0.06;

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
  const depths = points.map((p) => p.dot(towards));
  const tall = Math.tan((camera.fov * Math.PI) / 360) * kUsed;
  /** Each point lies between two planes through the camera of this slope: where it stands along `axis`, and how far away at least. */
  const between = (axis: Vector3, slope: number): [number, number] => {
    const [high, low] = [1, -1].map((side) => Math.max(...points.map((p, i) => side * p.dot(axis) + slope * (depths[i] ?? 0)))) as [number, number];
    return [(high - low) / 2, (high + low) / (2 * slope)];
  };
  const [[x, ofWidth], [y, ofHeight]] = [between(right, tall * camera.aspect), between(up, tall)];
  const [far, near] = [Math.min(...depths), Math.max(...depths)];
  const depth = (far + near) / 2;
  const middle = right.clone().multiplyScalar(x).addScaledVector(up, y).addScaledVector(towards, depth);
  camera.position.copy(middle).addScaledVector(towards, Math.max(ofWidth, ofHeight, depth + kNearest, near + kClear) - depth);
  return middle;
}
