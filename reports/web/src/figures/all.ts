// Every figure of the page, by section.

import type { FigureSpec } from '../chart';
import type { Model } from '../data';
import { arrival } from './arrival';
import { difficulty } from './difficulty';
import { distribution } from './distribution';
import { forest } from './forest';
import { outcomes } from './outcomes';
import { paired } from './paired';
import { pareto } from './pareto';
import { phases } from './phases';
import { scatter } from './scatter';
import { sweep } from './sweep';
import { isSwept } from './swept';
import { timing } from './timing';

export const kFigures = {
  results: () => [forest(), outcomes()],
  time: () => [arrival(), phases()],
  difficulty: () => [difficulty()],
  sweep: (model: Model) => (isSwept(model) ? [...sweep(), pareto()] : []),
  quality: () => [
    distribution('manipulability', 'manip_mean'),
    distribution('metric', 'command_change_mean'),
    scatter(),
  ],
  pairs: () => [paired()],
  timing: () => [timing()],
} satisfies Record<string, (model: Model) => FigureSpec[]>;
