// Pairs of a robot's own shapes whose rows are worth showing: those whose distance some joint changes.

import { coreOf, nearestPoints } from './distance';
import type { Robot } from './robot';

/** Postures all over the joints' range: multiples of irrational steps, so that no two joints move alike. */
const kPostures = 6;
const kSteps = [0.6180339887, 0.4142135624, 0.7320508076, 0.2360679775, 0.6457513111, 0.3166247904, 0.6055512755, 0.1231056256, 0.3588989435, 0.7958315233];
/** A distance that changes by less never does [m]. */
const kStill = 1e-4;

const known = new WeakMap<Robot, [number, number][]>();

/**
 * Left out are pairs of links that are rigid to each other, and of round shapes about the only joint between them: their rows
 * stand at one distance all through every motion. Leaves the robot in another posture.
 */
export function movingPairs(robot: Robot): [number, number][] {
  const found = known.get(robot);
  if (found !== undefined) return found;
  const linkOf = (i: number): string => robot.shapes[i]?.link ?? '';
  const cores = robot.shapes.map(({ shape }) => coreOf(shape));
  const pairs = robot.pairs.filter(([i, j]) => cores[i] !== undefined && cores[j] !== undefined && robot.rigid(linkOf(i)) !== robot.rigid(linkOf(j)));
  const least = pairs.map(() => Infinity);
  const most = pairs.map(() => -Infinity);
  for (let k = 1; k <= kPostures; ++k) {
    robot.update(0, 0, 0, (i) => {
      const { lower = -Infinity, upper = Infinity } = robot.driven[i] ?? {};
      const [from, to] = Number.isFinite(upper - lower) ? [lower, upper] : [-Math.PI, Math.PI];
      return from + (to - from) * ((0.5 + k * kSteps[i % kSteps.length]!) % 1);
    });
    const now = robot.shapes.map(({ link, local }) => robot.pose(link).clone().multiply(local));
    pairs.forEach(([i, j], n) => {
      const d = nearestPoints(cores[i]!, now[i]!, cores[j]!, now[j]!)?.d ?? -1;   // deep in each other
      least[n] = Math.min(least[n]!, d);
      most[n] = Math.max(most[n]!, d);
    });
  }
  const moving = pairs.filter((_, n) => most[n]! - least[n]! > kStill);
  known.set(robot, moving);
  return moving;
}
