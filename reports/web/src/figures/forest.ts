// Success of every controller with its interval: a row each, the best first where they are many.

import { kNarrow, kTwoLines, rowAxis, shareAxis, tip, whisker, type FigureSpec } from '../chart';
import { inSlice, type Series, type SummaryRow } from '../data';
import { integer, percent, percentRange, plural, sizes } from '../format';
import { seriesColour, type Palette } from '../theme';
import { baseline, kFew, view } from '../view';

/** More rows than this are no picture; the table has them all. */
const kMost = 60;

interface Line { series: Series; row: SummaryRow; family: string }

function lines(): Line[] {
  const { model, slice, family, families, all } = view();
  const of = (name: string): Line[] => {
    const rows = (name === '' ? model.page.overall : model.page.summary.filter((s) => s.family === name)).filter((r) => inSlice(r, slice));
    return all.flatMap((series) => {
      const row = rows.find((r) => r.controller === series.controller && r.point === series.point);
      return row === undefined ? [] : [{ series, row, family: name }];
    });
  };
  if (all.length > kFew) return of(family).sort((a, b) => b.row.success_rate - a.row.success_rate).slice(0, kMost);
  return family !== '' ? of(family) : [...of(''), ...(families.length > 1 ? families.flatMap(of) : [])];
}

export function forest(): FigureSpec {
  return {
    id: 'forest',
    title: 'Success rate of every controller',
    caption: 'A dot per controller with its 95 % Wilson interval.',
    empty: 'No trial here has a result.',
    draw: (p: Palette, width: number) => {
      const all = lines();
      const { all: series } = view();
      if (all.length === 0) return null;
      const base = baseline();
      const many = series.length > kFew;
      const families = !many && view().families.length > 1;
      const row = families && width < kNarrow ? kTwoLines : all.length > 24 ? 17 : 24;
      const against = many ? all.find((l) => l.series === base)?.row.success_rate : undefined;
      return {
        height: 56 + all.length * row,
        note: `n = ${sizes(all.map((l) => l.row.n))} trials a row; 95 % Wilson, each by itself.${against === undefined ? '' : ' The broken line is the baseline: the first controller, unless another is chosen under Pairs.'}${many ? ` The best stand first. The best of ${plural(series.length, series.some((s) => s.point !== '') ? 'point' : 'controller')} looks better on the worlds that chose it than it is: confirm it on others.` : ''}${series.length > kMost ? ` The best ${integer(kMost)} are shown.` : ''}`,
        columns: ['family', 'controller', 'point', 'n', 'success_rate', 'success_low', 'success_high'],
        rows: all.map((l) => [l.family, l.series.controller, l.series.point, l.row.n, l.row.success_rate, l.row.success_low, l.row.success_high]),
        option: {
          grid: { left: 4, right: 24, top: 8, bottom: 8, outerBoundsMode: 'same', outerBoundsContain: 'all' },
          xAxis: shareAxis(p, width),
          yAxis: rowAxis(p, all.map((l) => ({ name: l.series.short, family: !families ? '' : l.family === '' ? 'all worlds' : l.family })), width, all.length > 24 ? 11 : 12.5),
          tooltip: {
            trigger: 'item',
            formatter: ({ dataIndex }: { dataIndex: number }) => {
              const l = all[dataIndex];
              if (l === undefined) return '';
              const r = l.row;
              return tip(l.series.name, [['success', percent(r.success_rate)], ['95 % interval', percentRange(r.success_low, r.success_high)], ['n', integer(r.n)]], seriesColour(p, l.series.mark));
            },
          },
          series: [
            ...(against === undefined ? [] : [{ type: 'line', silent: true, showSymbol: false, data: [[against, '0'], [against, String(all.length - 1)]], lineStyle: { color: p.faint, width: 1, type: [4, 3] }, z: 1 }]),
            {
              type: 'custom', silent: true, tooltip: { show: false }, data: all.map((l, i) => [l.row.success_low, l.row.success_high, i]), encode: { x: [0, 1], y: 2 },
              renderItem: (params: { dataIndex: number }, api: { value: (i: number) => number; coord: (at: number[]) => number[] }) => whisker(seriesColour(p, all[params.dataIndex]?.series.mark ?? -1), true, 2)(params, api),
            },
            { type: 'scatter', symbolSize: all.length > 24 ? 7 : 9, z: 4, data: all.map((l, i) => ({ value: [l.row.success_rate, String(i)], itemStyle: { color: seriesColour(p, l.series.mark) } })) },
          ],
        },
      };
    },
  };
}
