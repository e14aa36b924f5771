// Rows that let objects in motion pass on one side of the base (docs/explanation/moma-controller.md, 4): half a velocity obstacle
// (Fiorini and Shiller, IJRR 17(7), 1998), n . (v_robot - v_object) >= -max(gap, 0) / horizon. As the controller poses them.

import { Vector3, type Matrix4 } from 'three';

import type { Core } from './distance';

export interface PassingParameters { horizon: number; clearance: number }

/** Something that moves, where it is and how fast its centre goes [m/s]. */
export interface Mover { core: Core; place: Matrix4; velocity: Vector3 }

const kMoving = 0.01;
const kAbove = 0.05;
const kWidest = 0.8;
const kTiny = 1e-9;

/** The point of a solid that is farthest along a unit vector. */
function farthest({ core, place }: Mover, along: Vector3): Vector3 {
  return core.support(along.clone().transformDirection(place.clone().invert()), new Vector3()).applyMatrix4(place).addScaledVector(along, core.radius);
}

function flat(v: Vector3): Vector3 {
  return new Vector3(v.x, v.y, 0);
}

function leftOf(v: Vector3): Vector3 {
  return new Vector3(-v.y, v.x, 0);
}

function centreOf({ place }: Mover): Vector3 {
  return new Vector3().setFromMatrixPosition(place);
}

/** Whether two solids are at heights where they could touch. */
function level(a: Mover, b: Mover): boolean {
  const up = new Vector3(0, 0, 1);
  const down = new Vector3(0, 0, -1);
  return farthest(a, down).z <= farthest(b, up).z + kAbove && farthest(a, up).z >= farthest(b, down).z - kAbove;
}

export interface Passing { n: Vector3; gap: number; limit: number; rate: number }

/** The row of one shape of the base and one object; null where there is none. `fastest`: the shape's centre can go [m/s]. */
export function passing(of: PassingParameters, robot: Mover, object: Mover, fastest: number): Passing | null {
  const v = flat(object.velocity);
  if (!(v.length() > kMoving) || !level(robot, object)) return null;
  const centre = flat(centreOf(object).sub(centreOf(robot)));
  const distance = centre.length();
  if (!(distance > kTiny)) return null;
  const to = centre.clone().divideScalar(distance);
  const gap = to.dot(farthest(object, to.clone().negate()).sub(farthest(robot, to)));
  if (gap >= of.horizon * (v.length() + fastest)) return null;
  // The tangent from the origin to the object less the robot, by Newton's method in the angle of its normal.
  let n = leftOf(to);
  const side = n.dot(v) > 0 ? -1 : 1;
  n.multiplyScalar(side);
  for (let k = 0; k < 30; ++k) {
    const m = flat(farthest(object, n).sub(farthest(robot, n.clone().negate())));
    const length = m.length();
    if (!(length > kTiny)) return null;
    if (n.dot(m) <= kTiny * length) {
      const sine = Math.min(of.clearance / length, kWidest);
      n = n.clone().multiplyScalar(Math.sqrt(1 - sine * sine)).addScaledVector(m.divideScalar(length), -sine);
      return { n, gap, limit: -Math.max(gap, 0) / of.horizon, rate: n.dot(flat(robot.velocity).sub(v)) };
    }
    n = leftOf(m).multiplyScalar(side / length);
  }
  return null;
}
