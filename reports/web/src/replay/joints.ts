// Joints within their limits, as bars.

import { h, replace } from '../dom';
import type { Robot } from './robot';
import type { Trace } from './trace';

/** Nearer than this share of its range to a limit, a joint is marked. */
const kNear = 0.04;

export class Joints {
  readonly element = h('div', { class: 'joints' });
  private bars: HTMLElement[] = [];

  show(robot: Robot): void {
    this.bars = robot.driven.map(() => h('i'));
    replace(this.element, ...robot.driven.map((joint, i) => h('div', null, h('span', null, joint.name), h('div', { class: 'rail' }, this.bars[i]))));
  }

  draw(robot: Robot, trace: Trace, t: number): void {
    robot.driven.forEach((joint, i) => {
      const bar = this.bars[i];
      if (bar === undefined) return;
      const bounded = Number.isFinite(joint.lower) && Number.isFinite(joint.upper);
      const share = bounded ? Math.min(1, Math.max(0, (trace.at(`q${i}`, t) - joint.lower) / (joint.upper - joint.lower))) : 0.5;
      bar.style.left = `${100 * share}%`;
      bar.parentElement?.classList.toggle('near', bounded && Math.min(share, 1 - share) < kNear);
    });
  }
}
