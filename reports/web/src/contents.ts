// The page below the verdict. It brings along the libraries for figures and scenes, which are started after it is painted.

import type { Model } from './data';
import { figure } from './figure';
import { kFigures } from './figures/all';
import { risk } from './figures/risk';
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
  const drawn = (part: keyof typeof kFigures): Node[] => kFigures[part](model).map(figure);
  const several = new Set(model.page.points.map((p) => [p.suite, p.controller, p.point].join('\n'))).size > 1;
  return {
    tuning: () => tuning(model),
    risk: () => risk(model),
    results: () => [summary(model), ...drawn('results')],
    time: () => drawn('time'),
    difficulty: () => drawn('difficulty'),
    sweep: () => drawn('sweep'),
    quality: () => drawn('quality'),
    pairs: () => [...(several ? [comparison(model)] : []), ...drawn('pairs')],
    failures: () => [failures(model)],
    replay: () => [player(model)],
    timing: () => drawn('timing'),
    trials: () => [trials(model)],
    provenance: () => [provenance(model)],
  };
}
