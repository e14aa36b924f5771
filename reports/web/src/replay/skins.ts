// What is drawn of a robot, and where.

import { CylinderGeometry, Matrix4, type BufferGeometry } from 'three';

import type { Part } from './look';
import type { Robot } from './robot';
import { solid } from './solid';
import type { Trace } from './trace';

/** A surface fixed to a link: a visual, or a shape of a link that has none. */
export interface Skin { surface: BufferGeometry; link: string; local: Matrix4; colour: string | null }

/** Width of the wheels that are drawn [m]. */
const kWheel = 0.05;

/** Wheels of a base that has no visuals, each on its axle along y and on the floor. */
export function wheels(robot: Robot, look: readonly Part[]): Skin[] {
  const { radius, separation, wheelbase = 0 } = robot.wheels ?? {};
  if (radius === undefined || separation === undefined || look.some((part) => robot.has(part.link) && robot.rigid(part.link) === '@base')) return [];
  return (wheelbase > 0 ? [-wheelbase / 2, wheelbase / 2] : [0]).flatMap((x) => [-1, 1].map((side) => ({
    surface: new CylinderGeometry(radius, radius, kWheel, 28), link: '@base', colour: null, local: new Matrix4().makeTranslation(x, (side * separation) / 2, radius),   // three's cylinders lie along y
  })));
}

/** Of links that are rigid to each other one visual is enough: their shapes are then left out. */
export function skins(robot: Robot, look: readonly Part[]): Skin[] {
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
