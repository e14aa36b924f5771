// The wheels of a base that has no visuals of its own.

import { CylinderGeometry, Matrix4, type BufferGeometry } from 'three';

import type { Part } from './look';
import type { Robot } from './robot';

/** Of the wheels that are drawn [m]. */
const kWide = 0.05;

/** Wheels in base axes, each on its axle along y and on the floor. None where visuals show the base. */
export function wheels(robot: Robot, look: readonly Part[]): { surface: BufferGeometry; local: Matrix4 }[] {
  const { radius, separation, wheelbase = 0 } = robot.wheels ?? {};
  if (radius === undefined || separation === undefined || look.some((part) => robot.has(part.link) && robot.rigid(part.link) === '@base')) return [];
  return (wheelbase > 0 ? [-wheelbase / 2, wheelbase / 2] : [0]).flatMap((x) => [-1, 1].map((side) => ({
    surface: new CylinderGeometry(radius, radius, kWide, 28), local: new Matrix4().makeTranslation(x, (side * separation) / 2, radius),   // three's cylinders lie along y
  })));
}
