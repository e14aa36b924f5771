// What is drawn of a robot, and where.

import { Matrix4, type BufferGeometry } from 'three';

import type { Part } from './look';
import type { Robot } from './robot';
import { solid } from './solid';
import type { Trace } from './trace';

/** A surface fixed to a link: a visual, or a shape of a link that has none. */
export interface Skin { surface: BufferGeometry; link: string; local: Matrix4; colour: string | null }

/** Of links that are rigid to each other one visual is enough: their shapes, and the wheels of a base, are then left out. */
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
