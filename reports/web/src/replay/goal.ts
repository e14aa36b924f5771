// The goal: its axes, a ball as large as the tolerance, and the hand as it has to arrive.

import { Color, Matrix4, Mesh, MeshStandardMaterial, SphereGeometry, type Group } from 'three';

import { triad } from './marks';
import type { Robot } from './robot';
import type { Skin } from './skins';

/** A ball that is smaller than this would not be seen [m]. */
const kLeast = 0.008;

/**
 * In the goal's axes. `skins`: what is drawn of the robot, of which the hand is taken; the robot may stand as it likes, for
 * its hand is rigid. `tolerance`: radius around the goal that counts as reached [m].
 */
export function goalMark(robot: Robot, skins: readonly Skin[], tolerance: number, colour: string): Group {
  const group = triad(0.26, true);
  const pale = (opacity: number, depthWrite: boolean): MeshStandardMaterial => new MeshStandardMaterial({ color: new Color(colour), roughness: 0.62, metalness: 0.05, transparent: true, opacity, depthWrite });
  group.add(new Mesh(new SphereGeometry(Math.max(tolerance, kLeast), 24, 16), pale(0.75, true)));
  const toTip = robot.tipPose(new Matrix4()).invert();
  for (const { surface, link, local } of skins) {
    if (!robot.inHand(link)) continue;
    const mesh = new Mesh(surface, pale(0.24, false));
    mesh.name = `hand: ${link}`;
    mesh.matrixAutoUpdate = false;
    mesh.matrix.copy(toTip).multiply(robot.pose(link)).multiply(local);
    group.add(mesh);
  }
  return group;
}
