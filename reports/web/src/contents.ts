// The page below the verdict. It brings along the libraries for figures and scenes, which are started after it is painted.

import type { FigureSpec } from './chart';
import type { Model } from './data';
import { figure } from './figure';
import { arrival } from './figures/arrival';
import { difficulty } from './figures/difficulty';
import { distribution } from './figures/distribution';
import { forest } from './figures/forest';
import { outcomes } from './figures/outcomes';
import { paired } from './figures/paired';
import { pareto } from './figures/pareto';
import { phases } from './figures/phases';
import { risk } from './figures/risk';
import { scatter } from './figures/scatter';
import { heat, slices } from './figures/sweep';
import { timing } from './figures/timing';
import { tuning } from './figures/tuning';
import { player } from './replay/player';
import { comparison } from './sections/comparison';
import { failures } from './sections/failures';
import { provenance } from './sections/provenance';
import { summary } from './sections/summary';
import { trials } from './sections/trials';

export { startPaper } from './paper';

/** Content of the sections, by the names of their places in the page. */
export function contents(model: Model): Record<string, () => Node[]> {
  const drawn = (...specs: FigureSpec[]): Node[] => specs.map(figure);
  const several = new Set(model.page.points.map((p) => [p.suite, p.controller, p.point].join('\n'))).size > 1;
  return {
    tuning: () => tuning(model),
    risk: () => risk(model),
    results: () => [summary(model), ...drawn(forest(), outcomes())],
    time: () => drawn(arrival(), phases()),
    difficulty: () => drawn(difficulty()),
    sweep: () => drawn(heat(), slices(), pareto()),
    quality: () => drawn(distribution('manipulability', 'manip_mean'), distribution('metric', 'command_change_mean'), scatter()),
    pairs: () => [...(several ? [comparison(model)] : []), ...drawn(paired())],
    failures: () => [failures(model)],
    replay: () => [player(model)],
    timing: () => drawn(timing()),
    trials: () => [trials(model)],
    provenance: () => [provenance(model)],
  };
}
