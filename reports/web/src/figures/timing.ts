// How long control steps took, against the control period.

import { axis, kNarrow, legend, legendHeight, pathSeries, plain, smallMultiples, stairs, tip, type FigureSpec, type Option } from '../chart';
import { integer, percent, plural, significant } from '../format';
import { choice } from '../dom';
import * as state from '../state';
import { quantile, thinned } from '../stats';
import { outcomeColour, kDashes, seriesColour, seriesInk, type Palette } from '../theme';
import { view } from '../view';

const kKinds = [['median_us', 'median', 0.55], ['p99_us', '99th percentile', 1], ['max_us', 'longest', 0.75]] as const;
/** Each has three curves: those of more controllers are drawn each in a plot of its own. */
const kTogether = 4;
const kParts = [['step', 'whole control step'], ['solve', 'solution of the QP']] as const;

export function timing(): FigureSpec {
  state.setDefault('f.timing', 'step');
  const part = (): string => (state.get('f.timing') === 'solve' ? 'solve' : 'step');
  const what = (): string => kParts.find(([key]) => key === part())?.[1] ?? '';
  return {
    id: 'timing',
    title: 'Time of a control step',
    caption: 'Share of trials whose median (thin), 99th percentile (bold) and longest (dotted) control step, or solution of its QP, took at most so long. The upright line is the control period: the deadline.',
    empty: 'The store holds no timings of these trials.',
    controls: (redraw) => [choice('Time of the', kParts, part(), (value) => { state.set({ 'f.timing': value }); redraw(); })],
    draw: (p: Palette, width: number) => {
      const { model, series } = view();
      const t = model.trials;
      const curves = series.flatMap((s) => kKinds.map(([statistic, name, opacity], kind) => [`t_${part()}_${statistic}`, name, opacity, kind] as const).map(([key, name, opacity, kind]) => ({
        s, key, name, opacity, kind,
        values: s.rows.map((row) => t.number(key, row)).filter((v) => v > 0).sort((a, b) => a - b),
      }))).filter((c) => c.values.length > 0);
      if (curves.length === 0) return null;
      type Curve = (typeof curves)[number];
      const deadline = Math.min(...series.map((s) => (s.info?.control_period_s ?? Infinity) * 1e6));
      const least = Math.min(...curves.map((c) => c.values[0] ?? 1));
      const most = Math.max(...curves.map((c) => c.values[c.values.length - 1] ?? 1), Number.isFinite(deadline) ? deadline : 0);
      const misses = series.map((s) => s.rows.reduce((sum, row) => sum + (t.number('deadline_misses', row) || 0), 0));
      const steps = series.map((s) => s.rows.reduce((sum, row) => sum + (t.number('steps', row) || 0), 0));
      const groups = series.filter((s) => curves.some((c) => c.s === s));
      const names = groups.map((s) => s.short);
      const xAxis = axis(p, `time of the ${what()} [\u00b5s]`, {
        type: 'log', min: 10 ** Math.floor(Math.log10(least)), max: 10 ** Math.ceil(Math.log10(most * 1.01)), nameGap: 28,
        axisLabel: { color: p.muted, hideOverlap: true, formatter: (v: number) => (v >= 1000 ? (width < kNarrow ? `${plain(v / 1000)}k` : integer(v)) : significant(v, 1)) },
      });
      const yAxis = axis(p, '', { min: 0, max: 1, interval: 0.25, axisLabel: { color: p.muted, formatter: (v: number) => `${Math.round(100 * v)} %` } });
      const tooltip = (of: (seriesIndex: number) => Curve | undefined): Option => ({
        trigger: 'item',
        formatter: ({ seriesIndex }: { seriesIndex: number }) => {
          const c = of(seriesIndex);
          if (c === undefined) return '';
          return tip(`${c.s.short}: ${c.name}`, [
            ['n', integer(c.values.length)], ['median trial', `${significant(quantile(c.values, 0.5))} \u00b5s`],
            ['95 % of trials below', `${significant(quantile(c.values, 0.95))} \u00b5s`],
            ['greatest', `${significant(c.values[c.values.length - 1])} \u00b5s`],
            ['over the deadline', percent(c.values.filter((v) => v > deadline).length / c.values.length)],
          ], seriesColour(p, c.s.mark));
        },
      });
      const curve = (c: Curve): Option => pathSeries(c.s.short,
        stairs(thinned(c.values.length).map((k) => [c.values[k] ?? 0, (k + 1) / c.values.length] as const)),
        { colour: seriesColour(p, c.s.mark), width: c.kind === 1 ? 2 : 1.4, opacity: c.opacity, dash: kDashes[[0, 0, 2][c.kind] ?? 0] });
      const deadlineLine = (named: boolean): Option[] => (!Number.isFinite(deadline) ? [] : [{
        name: 'deadline', type: 'line', data: [[deadline, 0], [deadline, 1]], showSymbol: false, silent: true, z: 1,
        lineStyle: { color: outcomeColour(p, 'collision'), width: 1.3, type: 'solid', opacity: 1 }, itemStyle: { color: outcomeColour(p, 'collision') },
        endLabel: { show: named, formatter: 'deadline', color: outcomeColour(p, 'collision'), fontSize: 11, offset: [-24, -9] },
      }]);
      return {
        note: series.map((s, i) => `${s.short}: n = ${integer(s.rows.length)} trials, ${plural(misses[i] ?? 0, 'deadline miss', 'deadline misses')} in ${plural(steps[i] ?? 0, 'step')}`).join('; ') + '. Wall times of the machine named above; they differ from run to run.',
        columns: ['controller', 'point', 'statistic', 'microseconds', 'share'],
        rows: curves.flatMap((c) => c.values.map((v, i) => [c.s.controller, c.s.point, c.key, v, (i + 1) / c.values.length])),
        ...(groups.length <= kTogether ? {
          height: 350,
          option: {
            legend: legend(p, names), xAxis, yAxis, tooltip: tooltip((i) => curves[i]),
            grid: { left: 8, right: 26, top: legendHeight(names, width) + 10, bottom: 8, outerBoundsMode: 'same', outerBoundsContain: 'all' },
            series: [...curves.map(curve), ...deadlineLine(true)],
          },
        } : smallMultiples(width, groups.map((s) => ({ title: s.short, colour: seriesInk(p, s.mark) })),
          { ...xAxis, axisLabel: { color: p.muted, formatter: (v: number) => (v >= 1000 ? `${plain(v / 1000)}k` : significant(v, 1)) } }, yAxis,
          // The deadline last, so that the place among the curves tells which one the pointer is at.
          (place) => [...curves.filter((c) => c.s === groups[place]).map(curve), ...deadlineLine(false)],
          tooltip((i) => { const all: (Curve | undefined)[] = groups.flatMap((s) => [...curves.filter((c) => c.s === s), ...deadlineLine(false).map(() => undefined)]); return all[i]; }))),
      };
    },
  };
}
