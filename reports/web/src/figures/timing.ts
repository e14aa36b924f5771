// Times of control steps against the control period.

import { axis, kNarrow, pathSeries, plain, plots, shareAxis, stairs, tip, tipOf, type FigureSpec, type Option } from '../chart';
import { integer, percent, plural, significant } from '../format';
import * as state from '../state';
import { quantile, thinned } from '../stats';
import { outcomeColour, kDashes, seriesColour } from '../theme';
import { view } from '../view';
import type { Series } from '../data';

const kStatistics = [
  { key: 'median_us', name: 'median', style: { opacity: 0.55, width: 1.4, dash: kDashes[0] } }, { key: 'p99_us', name: '99th percentile', style: { opacity: 1, width: 2, dash: kDashes[0] } },
  { key: 'max_us', name: 'longest', style: { opacity: 0.75, width: 1.4, dash: kDashes[2] } },
] as const;
/** Each has three curves: those of more controllers are drawn each in a plot of its own. */
const kTogether = 4;
const kParts = [['step', 'whole control step'], ['solve', 'solution of the QP']] as const;

interface Curve { s: Series; key: string; statistic: (typeof kStatistics)[number]; values: number[] }

export function timing(): FigureSpec {
  state.setDefault('f.timing', 'step');
  const part = (): (typeof kParts)[number] => kParts.find(([key]) => key === state.get('f.timing')) ?? kParts[0];
  return {
    id: 'timing',
    title: 'Time of a control step',
    caption: 'Share of trials whose median (thin), 99th percentile (bold) and longest (dotted) control step, or solution of its QP, took at most so long. The upright line is the control period: the deadline.',
    empty: 'The store holds no timings of these trials.',
    choices: [{ key: 'f.timing', label: 'Time of the', options: () => kParts }],
    draw: (p, width) => {
      const { model, series } = view();
      const t = model.trials;
      const curves = series.flatMap((s) => kStatistics.map((statistic): Curve => {
        const key = `t_${part()[0]}_${statistic.key}`;
        return { s, key, statistic, values: s.rows.map((row) => t.number(key, row)).filter((v) => v > 0).sort((a, b) => a - b) };
      })).filter((c) => c.values.length > 0);
      if (curves.length === 0) return null;
      const deadline = Math.min(...series.map((s) => s.info.control_period_s * 1e6));
      const least = Math.min(...curves.map((c) => c.values[0] ?? 1));
      const most = Math.max(...curves.map((c) => c.values[c.values.length - 1] ?? 1), deadline);
      const sum = (s: Series, key: string): number => s.rows.reduce((all, row) => all + (t.number(key, row) || 0), 0);
      const groups = series.filter((s) => curves.some((c) => c.s === s));
      const alarm = outcomeColour(p, 'collision');
      const deadlineLine: Option[] = [{
        name: 'deadline', type: 'line', data: [[deadline, 0], [deadline, 1]], showSymbol: false, silent: true, z: 1, lineStyle: { color: alarm, width: 1.3 }, itemStyle: { color: alarm },
        endLabel: { show: groups.length <= kTogether, formatter: 'deadline', color: alarm, fontSize: 11, offset: [-24, -9] },
      }];
      return {
        note: series.map((s) => `${s.short}: n = ${integer(s.rows.length)} trials, ${plural(sum(s, 'deadline_misses'), 'deadline miss', 'deadline misses')} in ${plural(sum(s, 'steps'), 'step')}`).join('; ') + '. Wall times of the machine named above; they differ from run to run.',
        columns: ['controller', 'point', 'statistic', 'microseconds', 'share'],
        rows: curves.flatMap((c) => c.values.map((v, i) => [c.s.controller, c.s.point, c.key, v, (i + 1) / c.values.length])),
        ...plots(p, width, {
          groups, most: kTogether, height: 350, behind: deadlineLine,
          x: (marks) => axis(p, `time of the ${part()[1]} [\u00b5s]`, { type: 'log', min: 10 ** Math.floor(Math.log10(least)), max: 10 ** Math.ceil(Math.log10(most * 1.01)) },
            (v) => (v < 1000 ? significant(v, 1) : width < kNarrow || marks === 3 ? `${plain(v / 1000)}k` : integer(v))),
          y: shareAxis(p, 0.25),
          series: (i, alone) => [...(alone ? deadlineLine : []), ...curves.filter((c) => c.s === groups[i]).map((c) => pathSeries(c.s.short,
            stairs(thinned(c.values.length).map((k) => [c.values[k] ?? 0, (k + 1) / c.values.length] as const)), { colour: seriesColour(p, c.s.mark), ...c.statistic.style }, {}, c))],
          tooltip: tipOf((c: Curve) => tip(`${c.s.short}: ${c.statistic.name}`, [
            ['n', integer(c.values.length)], ['median trial', `${significant(quantile(c.values, 0.5))} \u00b5s`], ['95 % of trials below', `${significant(quantile(c.values, 0.95))} \u00b5s`],
            ['greatest', `${significant(c.values[c.values.length - 1])} \u00b5s`], ['over the deadline', percent(c.values.filter((v) => v > deadline).length / c.values.length)],
          ], seriesColour(p, c.s.mark))),
        }),
      };
    },
  };
}
