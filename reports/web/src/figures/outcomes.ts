// How trials ended: one bar per controller, within each family.

import { kNarrow, kTwoLines, legend, legendHeight, rowAxis, shareAxis, tip, type FigureSpec } from '../chart';
import { inkOn } from '../colour';
import { outcomeName, kOutcomes, type Outcome, type Series } from '../data';
import { integer, percent, plural, sizes } from '../format';
import { goToSection } from '../go_to';
import * as state from '../state';
import { outcomeColour, type Palette } from '../theme';
import { view } from '../view';

interface Bar {
  family: string;
  series: Series;
  counts: Map<Outcome, number>;
  n: number;
}

function bars(): Bar[] {
  const { model, families, family, series } = view();
  const shown = family === '' ? families : [family];
  const out: Bar[] = [];
  for (const name of shown) {
    for (const s of series) {
      const counts = new Map<Outcome, number>();
      let n = 0;
      for (const row of s.rows) {
        if (model.trials.text('family', row) !== name) continue;
        const outcome = model.trials.outcome(row);
        counts.set(outcome, (counts.get(outcome) ?? 0) + 1);
        ++n;
      }
      if (n > 0) out.push({ family: name, series: s, counts, n });
    }
  }
  return out;
}

export function outcomes(): FigureSpec {
  return {
    id: 'outcomes',
    title: 'How trials ended',
    caption: 'Every trial has exactly one outcome; a bar is all trials of a controller in a family of worlds. A click lists the trials.',
    empty: 'No trial here has a result.',
    draw: (p: Palette, width: number) => {
      const all = bars();
      if (all.length === 0) return null;
      const present = kOutcomes.filter((o) => all.some((bar) => bar.counts.has(o)));
      const top = legendHeight(present.map((o) => outcomeName(o)), width);
      const families = view().families.length > 1;
      const row = all.length <= 12 ? 38 : families && width < kNarrow ? kTwoLines : 26;
      return {
        height: 30 + top + all.length * row,
        note: `n = ${sizes(all.map((bar) => bar.n))} trials a bar; counts of five and more are written in.`,
        columns: ['family', 'controller', 'point', 'outcome', 'trials', 'share', 'n'],
        rows: all.flatMap((bar) => present.map((o) => [
          bar.family, bar.series.controller, bar.series.point, o, bar.counts.get(o) ?? 0, (bar.counts.get(o) ?? 0) / bar.n, bar.n,
        ])),
        option: {
          legend: legend(p, present.map((o) => outcomeName(o))),
          grid: { left: 4, right: 20, top, bottom: 4, outerBoundsMode: 'same', outerBoundsContain: 'axisLabel' },
          xAxis: shareAxis(p, width, { splitLine: { show: false } }),
          yAxis: rowAxis(p, all.map((bar) => ({ name: bar.series.short, family: families ? bar.family : '' })), width),
          series: present.map((o) => ({
            name: outcomeName(o), type: 'bar', stack: 'all', barWidth: '68%', barCategoryGap: '20%',
            itemStyle: { color: outcomeColour(p, o), borderColor: p.surface, borderWidth: 1 },
            emphasis: { disabled: true },
            label: {
              show: true, color: inkOn(outcomeColour(p, o)), fontSize: 11.5,
              formatter: ({ dataIndex }: { dataIndex: number }) => {
                const count = all[dataIndex]?.counts.get(o) ?? 0;
                return count >= 5 && count / (all[dataIndex]?.n ?? 1) > 0.04 ? String(count) : '';
              },
            },
            data: all.map((bar) => (bar.counts.get(o) ?? 0) / bar.n),
          })),
          tooltip: {
            trigger: 'item',
            formatter: ({ dataIndex, seriesIndex }: { dataIndex: number; seriesIndex: number }) => {
              const bar = all[dataIndex] as Bar;
              const o = present[seriesIndex] as Outcome;
              const count = bar.counts.get(o) ?? 0;
              return tip(outcomeName(o), [
                ['controller', bar.series.short], ['family', bar.family], ['trials', `${integer(count)} of ${plural(bar.n, 'trial')}`],
                ['share', percent(count / bar.n)],
              ], outcomeColour(p, o));
            },
          },
        },
      };
    },
    click: (_, { seriesIndex, dataIndex }) => {
      const all = bars();
      const bar = all[dataIndex];
      const outcome = kOutcomes.filter((o) => all.some((b) => b.counts.has(o)))[seriesIndex];
      if (bar === undefined || outcome === undefined) return;
      state.set({ outcome, who: bar.series.controller, q: [bar.family, bar.series.point].filter((text) => /^\S+$/.test(text)).join(' '), in: 'trials' }, true);
      goToSection('trials');
    },
  };
}
