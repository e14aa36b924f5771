// The page of `moma view`: asks the server whether the store has changed, and shows what came.

import { ask, type Model, type PageData } from './data';
import { h, replace } from './dom';
import { integer, plural, said } from './format';
import { isSwept } from './figures/swept';
import { refreshView } from './view';

interface State { trials: number; running: boolean; killed: boolean; stored: number; planned: number; token: string }

const kPause = 3000;
/** The rate is that of the last two minutes, as far as the page has looked. */
const kWindow = 120000;

/** "40 s", "12 min", "3.2 h". */
function roughly(seconds: number): string {
  if (seconds < 90) return `${integer(Math.max(1, Math.round(seconds)))}\u00a0s`;
  if (seconds < 5400) return `${integer(Math.round(seconds / 60))}\u00a0min`;
  return `${(seconds / 3600).toFixed(1)}\u00a0h`;
}

/** Trials per second over the observed counts; null until two counts differ. */
function pace(): (stored: number) => number | null {
  const seen: { at: number; stored: number }[] = [];
  return (stored) => {
    const now = performance.now();
    if (stored < (seen.at(-1)?.stored ?? 0)) seen.length = 0;   // another run
    seen.push({ at: now, stored });
    while (seen.length > 2 && now - (seen[0]?.at ?? now) > kWindow) seen.shift();
    const [first] = seen;
    return first === undefined || stored <= first.stored || now <= first.at ? null : (1000 * (stored - first.stored)) / (now - first.at);
  };
}

function words(now: State, rate: number | null): string {
  if (now.killed) return `${plural(now.trials, 'trial')}; the last run was killed: nobody writes to this store.`;
  if (!now.running) return `${plural(now.trials, 'trial')}; no run is going on.`;
  if (now.planned === 0) return `${plural(now.trials, 'trial')}; a search goes on, and this page follows it.`;
  const pace = rate === null ? '' : `, ${rate < 10 ? rate.toFixed(1) : integer(Math.round(rate))} a second, about ${roughly((now.planned - now.stored) / rate)} left`;
  return `${integer(now.stored)} of ${plural(now.planned, 'trial')} (${integer(Math.floor((100 * now.stored) / now.planned))}\u00a0%)${pace}; a run goes on, and this page follows it.`;
}

/** A line that says what the store is doing, kept up to date while the page is looked at. */
export function liveLine(model: Model): HTMLElement | null {
  if (model.page.live === undefined) return null;
  const line = h('p', { class: 'live', role: 'status' }, `${plural(model.page.trials.stored, 'trial')}, served live.`);
  const paceOf = pace();
  let shown = model.page.live.token;
  let pause = kPause;

  const update = async (): Promise<void> => {
    const began = performance.now();
    const page = await ask('data.json') as PageData;
    const other = (model.trials.n === 0) !== (page.trials.n === 0) || page.tuning.length !== model.page.tuning.length;
    const swept = isSwept(model);
    model.load(page);
    if (other || swept !== isSwept(model)) {
      location.reload();   // sections come or go
      return;
    }
    shown = page.live?.token ?? shown;
    refreshView();
    // The interval grows with the time that an update takes, so that showing a large store does not load the machine.
    pause = Math.max(kPause, 10 * (performance.now() - began));
  };

  const look = async (): Promise<void> => {
    try {
      if (!document.hidden) {
        const now = await ask('state.json') as State;
        if (now.token !== shown) await update();
        replace(line, words(now, now.running ? paceOf(now.stored) : null));
        line.classList.toggle('running', now.running);
      }
    } catch (error) {
      line.classList.remove('running');
      replace(line, error instanceof TypeError ? 'moma view has ended: this is what the store held last.' : `The store cannot be read now: ${said(error)}`);
    }
    setTimeout(() => void look(), pause);
  };
  void look();
  return line;
}
