// The replay section: choose a trial, play it, scrub, look around.

import { disturbed } from '../conditions';
import { kOutcomeNames, type Model, type Motion } from '../data';
import { downloadBlob, h, replace, roving } from '../dom';
import { fixed, integer, plural } from '../format';
import { whenSeen } from '../later';
import { onPaper, paperPlace } from '../paper';
import { onSelect, select } from '../select';
import { command } from '../sections/trials';
import * as state from '../state';
import { onTheme, palette } from '../theme';
import { onView } from '../view';
import { Robot } from './robot';
import { collisionParameters, type Row } from './rows';
import { ReplayScene, type Colours, type WorldJson } from './scene';
import { statusAt, Timeline } from './timeline';
import { decode, type Trace } from './trace';

const kSpeeds = [0.25, 0.5, 1, 2, 4] as const;

function colours(): Colours {
  const p = palette();
  return p.dark
    ? { background: '#171b21', floor: '#1b2027', grid: '#2c343f', base: '#8794a6', arm: '#d7dde6', object: '#6b6257', moving: '#8a7450', hit: '#e2664c', goal: '#dcb45a', path: '#7fb0e6', begin: '#5d6570', ghost: '#cb64a3', wheel: '#4a525e' }
    : { background: '#eeece6', floor: '#f4f2ed', grid: '#d8d4c9', base: '#5d6b7e', arm: '#f7f8fa', object: '#b5ab9b', moving: '#cfae74', hit: '#c4472f', goal: '#c79a2b', path: '#27598f', begin: '#b9c2cc', ghost: '#b8447b', wheel: '#3a424d' };
}

/** Trials to choose from: the worst of each kind with samples; where none has any but all can be asked for, failures. */
function listed(model: Model): string[] {
  const named = model.page.replays.map((replay) => replay.trial);
  const t = model.trials;
  if (named.length > 0 || model.page.live?.simulates !== true) return named;
  const rows = Array.from({ length: t.n }, (_, row) => row);
  const failed = rows.filter((row) => !t.success(row));
  return (failed.length > 0 ? failed : rows).slice(0, 24).map((row) => t.text('trial', row));
}

function shelfNote(model: Model): string {
  const [first] = model.page.replays;
  if (model.page.live !== undefined) {
    return model.page.samples_stored === 0 ? 'Any trial can be played, from the table too: it is simulated again.'
      : `The worst of each kind, of ${plural(model.page.samples_stored, 'trial')} with stored samples. Any other can be played from the table${model.page.live.simulates ? ': it is simulated again' : ''}.`;
  }
  return `${plural(model.page.replays.length, 'trial')} of ${integer(model.page.samples_stored)} with stored samples; the worst of each kind first, at ${first !== undefined && 'hz' in first ? first.hz : 10} Hz.`;
}

export function player(model: Model): HTMLElement {
  if (listed(model).length === 0) {
    const trial = model.trials.n > 0 ? model.trials.text('trial', 0) : 'TRIAL';
    return h('div', { class: 'empty' },
      h('p', null, model.trials.n === 0 ? 'No trials, no replays.' : 'The store keeps no samples of these trials, so none can be played here. A trial is simulated again, bit for bit, by'),
      model.trials.n === 0 ? null : h('p', { class: 'command' }, h('code', null, command(model, trial))));
  }
  const canvas = h('canvas', { class: 'stage', tabindex: 0, 'aria-label': 'Replay in 3-D; drag to turn; after a click the wheel comes closer' });
  const lines = h('canvas', { class: 'timeline', 'aria-hidden': 'true' });
  const play = h('button', { type: 'button', class: 'play', click: () => toggle() }, 'Play');
  const scrub = h('input', { type: 'range', min: 0, max: 1, step: 'any', value: 0, 'aria-label': 'Time', input: () => { pause(); seek(Number(scrub.value)); } });
  const clock = h('output', { class: 'clock' });
  const speed = h('select', { 'aria-label': 'Speed', change: () => { rate = Number(speed.value); } }, ...kSpeeds.map((s) => h('option', { value: s, selected: s === 1 }, `${s}\u00d7`)));
  const follow = h('input', { type: 'checkbox', change: () => { if (scene !== null) scene.follow = follow.checked; } });
  const home = h('button', { type: 'button', class: 'quiet', click: () => { scene?.home(); scene?.set(time); draw(); } }, 'Reset view');
  const caption = h('div', { class: 'replay-caption' });
  const joints = h('div', { class: 'joints' });
  const status = h('p', { class: 'note' });
  const shelf = roving(h('div', { class: 'shelf', role: 'listbox', 'aria-label': 'Trials that can be played' }), 'button');
  const other = h('select', { 'aria-label': 'Beside it', change: () => state.set({ beside: other.value }) });
  const otherBox = h('label', { class: 'choice', hidden: true }, h('span', null, 'beside it'), other);
  const closest = h('button', { type: 'button', class: 'quiet', click: () => jump('least') }, 'Closest approach');
  const stopped = h('button', { type: 'button', class: 'quiet', click: () => jump('end') }, 'Why it stopped');
  const picture = h('button', { type: 'button', class: 'quiet', click: () => savePicture() }, 'Save PNG');
  const film = h('button', { type: 'button', class: 'quiet', click: () => saveFilm() }, 'Save WebM');
  const legend = h('p', { class: 'replay-legend' });
  const labels = h('div', { class: 'row-labels', 'aria-hidden': 'true' });
  const near = h('p', { class: 'note rows-near' });
  const stage = h('div', { class: 'stage-box' }, canvas, labels, caption);
  const paper = paperPlace();
  let scene: ReplayScene | null = null;
  let trace: Trace | null = null;
  let robot: Robot | null = null;
  let current = '';
  let ghost: { trial: string; trace: Trace } | null = null;
  let recorder: MediaRecorder | null = null;
  let sees = '';   // what of the controller's senses is disturbed
  let wanted = '';
  let time = 0;
  let rate = 1;
  let playing = false;
  let frame = 0;
  let before: number | null = null;   // time of the last frame
  const timeline = new Timeline(lines, (t) => { pause(); seek(t); });
  const robots = new Map<string, Robot>();

  /** Distances at the arrows of the rows that hold the command back, and of the nearest one. */
  const drawLabels = (): void => {
    const shown = scene?.rows.filter((row, i) => row.kind !== 'passing' && (row.active || i === 0)).slice(0, 8) ?? [];
    const placed: [number, number][] = [];
    replace(labels, ...shown.flatMap((row) => {
      const at = scene?.project(row.first.clone().add(row.second).multiplyScalar(0.5)) ?? null;
      // Nearest first: what would lie over a nearer one's label is left out; the sentence below names it.
      if (at === null || placed.some(([x, y]) => Math.abs(x - at[0]) < 62 && Math.abs(y - at[1]) < 16)) return [];
      placed.push(at);
      return [h('span', { class: row.active ? 'active' : null, style: `left:${at[0].toFixed(1)}px;top:${at[1].toFixed(1)}px` }, `${fixed(1000 * row.d, 0)} mm`)];
    }));
  };

  const tellRows = (): void => {
    const rows = scene?.rows ?? [];
    const active = rows.filter((row) => row.active);
    const sides = rows.filter((row) => row.kind === 'passing');
    const ends = rows.filter((row) => row.kind === 'end');
    const [first] = rows;
    const mm = (row: Row): string => `${row.link} to ${row.other} ${row.kind === 'passing' ? `(passing, ${fixed(row.d, 2)} m)` : `${fixed(1000 * row.d, 0)} mm`}`;
    const sentences = first === undefined ? ['No collision rows now: nothing is within the distance of influence.'] : [
      `${plural(rows.length, 'collision row')}${ends.length > 0 ? `, ${integer(ends.length)} of them of the ends of capsules` : ''}, ${integer(active.length)} active (the command approaches as fast as allowed)${active.length > 0 ? `: ${active.slice(0, 4).map(mm).join(', ')}` : ''}.`,
      first.kind === 'passing' ? '' : `Nearest: ${mm(first)}.`,
      sides.length > 0 ? `${plural(sides.length, 'row')} for passing objects: the long arrow points to the side that the base keeps to.` : '',
    ];
    if (sees !== '') sentences.push(`The controller saw measured poses, not these true ones (disturbed: ${sees}).`);
    near.textContent = sentences.filter((text) => text !== '').join(' ');
    const objects = rows.filter((row) => row.kind === 'object').map((row) => row.d);
    stage.dataset['leastDistance'] = objects.length > 0 ? String(Math.min(...objects)) : '';
    stage.dataset['activeRows'] = String(active.length);
    stage.dataset['arrows'] = String(rows.length);
    stage.dataset['ends'] = String(ends.length);
    stage.dataset['passing'] = String(sides.length);
    // Of rows whose nearest point is no matter of choice, as it is of parallel shapes.
    stage.dataset['leastRoom'] = String(Math.min(Infinity, ...[...ends, ...sides].map((row) => row.room)));
  };

  const draw = (): void => {
    scene?.render();
    drawLabels();
    timeline.draw(palette(), time);
  };

  const drawJoints = (): void => {
    if (robot === null || trace === null) return;
    const now = trace;
    const bars = joints.querySelectorAll<HTMLElement>('i');
    robot.driven.forEach((joint, i) => {
      const value = now.at(`q${i}`, Math.min(time, now.end));
      const bounded = Number.isFinite(joint.lower) && Number.isFinite(joint.upper);
      const share = bounded ? Math.min(1, Math.max(0, (value - joint.lower) / (joint.upper - joint.lower))) : 0.5;
      const bar = bars[i];
      if (bar === undefined) return;
      bar.style.left = `${100 * share}%`;
      bar.parentElement?.classList.toggle('near', bounded && Math.min(share, 1 - share) < 0.04);
    });
  };

  const last = (): number => Math.max(trace?.end ?? 0, ghost?.trace.end ?? 0);

  const tellLegend = (): void => {
    const c = colours();
    const part = (colour: string, text: string): Node => h('span', { class: 'dotted', style: `--c:${colour}` }, text);
    const t = model.trials;
    replace(legend, part(c.arm, 'robot'), part(c.goal, 'goal: the hand as it must arrive, a ball as large as the tolerance'), part(c.path, 'path of the hand, paler at its begin'),
      part(c.hit, 'touched, or a row that holds the command back'), ghost === null ? null : part(c.ghost, `${t.text('controller', model.row(ghost.trial) ?? -1)} in the same world`));
  };

  const show = (): void => {
    scene?.set(time);
    scrub.value = String(time);
    clock.textContent = `${fixed(time, 2)} of ${fixed(last(), 2)} s`;
    if (trace !== null) status.textContent = `Solver: ${statusAt(trace, Math.min(time, trace.end))}; ${plural(Math.round(trace.at('active_rows', Math.min(time, trace.end))), 'active constraint')}.`;
    if (scene !== null) stage.dataset['positionErrorNow'] = String(scene.positionError());
    tellRows();
    drawJoints();
    draw();
  };

  const seek = (t: number): void => {
    time = Math.min(Math.max(0, t), last());
    show();
  };

  const tick = (now: number): void => {
    if (!playing) return;
    // A frame's time is that of its begin, which may lie before start().
    if (before !== null) time += Math.min(0.1, Math.max(0, now - before) / 1000) * rate;
    before = now;
    if (time >= last()) {
      time = last();
      pause();
    }
    show();
    if (playing) frame = requestAnimationFrame(tick);
  };

  const pause = (): void => {
    playing = false;
    if (recorder?.state === 'recording') recorder.stop();
    cancelAnimationFrame(frame);
    play.textContent = 'Play';
  };

  const start = (): void => {
    if (trace === null || playing) return;
    if (time >= last() - 1e-6) time = 0;
    playing = true;
    before = null;
    play.textContent = 'Pause';
    frame = requestAnimationFrame(tick);
  };

  const toggle = (): void => (playing ? pause() : start());

  /** To the least distance from an object, or to the end. */
  const jump = (to: 'least' | 'end'): void => {
    if (trace === null) return;
    pause();
    const distances = trace.column('least_distance');
    let best = 0;
    for (let i = 1; i < trace.n; ++i) if ((distances[i] ?? Infinity) < (distances[best] ?? Infinity)) best = i;
    seek(to === 'end' ? trace.end : trace.t[best] ?? 0);
  };

  const fileName = (): string => `replay-${current || 'trial'}`;

  const savePicture = (): void => {
    draw();   // the canvas holds a picture only until the frame is shown
    canvas.toBlob((blob) => { if (blob !== null) downloadBlob(`${fileName()}-${fixed(time, 2)}s.png`, blob); });
  };

  /** Plays the motion from its begin and records what is seen, in real time. */
  const saveFilm = (): void => {
    if (trace === null || recorder?.state === 'recording') return;
    const type = ['video/webm;codecs=vp9', 'video/webm;codecs=vp8', 'video/webm'].find((t) => typeof MediaRecorder !== 'undefined' && MediaRecorder.isTypeSupported(t));
    if (type === undefined) {
      film.textContent = 'No WebM here';
      return;
    }
    const parts: Blob[] = [];
    pause();
    seek(0);
    const name = fileName();
    recorder = new MediaRecorder(canvas.captureStream(30), { mimeType: type, videoBitsPerSecond: 6e6 });
    recorder.addEventListener('dataavailable', (event) => { if (event.data.size > 0) parts.push(event.data); });
    recorder.addEventListener('stop', () => {
      film.textContent = 'Save WebM';
      downloadBlob(`${name}.webm`, new Blob(parts, { type: 'video/webm' }));
    });
    recorder.start(500);
    film.textContent = 'Recording\u2026';
    start();
  };

  /** Trials of other controllers in the world of `trial` that can be played, successes first. */
  const rivals = (trial: string): string[] => {
    const t = model.trials;
    const row = model.row(trial);
    if (row === undefined) return [];
    const same = (name: string, i: number): boolean => t.text(name, i) === t.text(name, row);
    const found: number[] = [];
    for (let i = 0; i < t.n; ++i) {
      if (i !== row && same('world_key', i) && same('suite', i) && same('robot', i) && same('mode', i) && model.playable(t.text('trial', i))) found.push(i);
    }
    return found.sort((a, b) => Number(t.success(b)) - Number(t.success(a))).slice(0, 40).map((i) => t.text('trial', i));
  };

  /** As chosen; by itself a success of the page beside a failure. */
  const wantedBeside = (): string => {
    const chosen = state.get('beside');
    const all = rivals(current);
    if (chosen === 'none' || all.includes(chosen)) return chosen === 'none' ? '' : chosen;
    const t = model.trials;
    const first = all[0];
    return model.page.live === undefined && first !== undefined && !t.success(model.row(current) ?? -1) && t.success(model.row(first) ?? -1) ? first : '';
  };

  const fillOthers = (): void => {
    const t = model.trials;
    const all = rivals(current);
    otherBox.hidden = all.length === 0;
    const now = wantedBeside();
    replace(other, h('option', { value: 'none', selected: now === '' }, 'nothing'), ...all.map((trial) => {
      const row = model.row(trial) ?? -1;
      return h('option', { value: trial, selected: trial === now }, `${t.text('controller', row)}${t.text('point', row) === '' ? '' : ` ${t.text('point', row)}`}: ${kOutcomeNames[t.outcome(row)]}`);
    }));
  };

  /** Brings the other motion into the scene, or takes it away. */
  const setBeside = async (): Promise<void> => {
    fillOthers();
    const trial = wantedBeside();
    const of = current;
    if ((ghost?.trial ?? '') === trial) return;
    const motion = trial === '' ? null : await model.motion(trial);
    if (of !== current || wantedBeside() !== trial) return;   // another was chosen meanwhile
    putBeside(trial, motion);
    scene?.home();
    show();
  };

  const putBeside = (trial: string, motion: Motion | null): void => {
    ghost = motion === null ? null : { trial, trace: decode(motion.replay) };
    scene?.beside(ghost === null || motion === null ? null : { robot: new Robot(motion.robot), trace: ghost.trace });
    timeline.beside(ghost?.trace ?? null);
    scrub.max = String(last());
    stage.dataset['beside'] = ghost?.trial ?? '';
    tellLegend();
  };

  const fillShelf = (): void => {
    const t = model.trials;
    const p = palette();
    const names = listed(model);
    replace(shelf, ...(current === '' || names.includes(current) ? names : [current, ...names]).map((trial) => {
      const row = model.row(trial) ?? 0;
      return h('button', {
        type: 'button', role: 'option', 'aria-selected': trial === current ? 'true' : 'false', click: () => select(trial, true),
      },
        h('span', { class: 'dotted', style: `--c:${p.outcomes[t.outcome(row)]}` }, kOutcomeNames[t.outcome(row)]),
        h('small', null, `${t.text('controller', row)} \u00b7 ${t.text('family', row)} ${integer(t.number('world', row))}`),
        t.text('point', row) === '' ? null : h('small', null, t.text('point', row)),
        t.text('link', row) === '' ? null : h('small', null, `${t.text('link', row)} \u2013 ${t.text('object', row)}`));
    }));
  };

  /** Shows a motion from its start. Throws an Error where samples or robot cannot be read. */
  const present = (trial: string, { replay, robot: resolved, simulated }: Motion): void => {
    const decoded = decode(replay);
    const row = model.row(trial) ?? -1;
    const t = model.trials;
    const key = `${t.text('store', row)}:${replay.robot}`;
    const next = robots.get(key) ?? new Robot(resolved);
    robots.set(key, next);
    scene ??= new ReplayScene(canvas, colours(), () => requestAnimationFrame(draw));
    current = trial;
    sees = disturbed(model.point(row));
    trace = decoded;
    robot = next;
    scene.follow = follow.checked;
    scene.render();
    scene.show(next, replay.world as WorldJson, decoded, { link: t.text('link', row), object: t.text('object', row) },
      collisionParameters(model.point(row)?.parameters), model.point(row)?.success_position_m ?? 0);
    const point = model.point(row);
    timeline.show(decoded, point === undefined ? null : { position: point.success_position_m, rotation: point.success_orientation_rad });
    ghost = null;
    const twin = wantedBeside();
    const embedded = model.embedded(twin);
    putBeside(twin, embedded === undefined ? null : { replay: embedded, robot: model.page.robots[embedded.robot], simulated: false });
    if (ghost !== null) scene.home();
    fillOthers();
    const outcome = t.outcome(row);
    const hit = t.text('link', row);
    replace(caption,
      h('span', { class: 'chip', style: `--c:${palette().outcomes[outcome]}` }, kOutcomeNames[outcome]), ' ',
      h('b', null, t.text('controller', row)), ` ${t.text('point', row)} \u00b7 ${t.text('family', row)} world ${integer(t.number('world', row))}`,
      hit === '' ? (t.text('reason', row) === '' ? '' : ` \u00b7 ${t.text('reason', row)}`) : ` \u00b7 ${hit} against ${t.text('object', row)}`,
      disturbed(model.point(row)) === '' ? '' : ` \u00b7 disturbed: ${disturbed(model.point(row))}`,
      simulated ? ' \u00b7 simulated again for this view' : '');
    replace(joints, ...next.driven.map((joint) => h('div', null, h('span', null, joint.name), h('div', { class: 'rail' }, h('i')))));
    time = 0;
    show();
    fillShelf();
    stage.dataset['trial'] = trial;
    stage.dataset['positionError'] = String(scene.positionError());
  };

  const load = async (trial: string, thenPlay: boolean): Promise<void> => {
    if (trial === current) {
      if (thenPlay && !playing) start();
      return;
    }
    wanted = trial;
    pause();
    if (model.page.live !== undefined) replace(caption, 'Reading the motion\u2026');
    const motion = await model.motion(trial);
    if (wanted !== trial) return;   // another was chosen meanwhile
    present(trial, motion);
    if (thenPlay) start();
  };

  /** The moment shown, or the first motion of the page, as pictures. */
  const still = (): Node | null => {
    const first = listed(model)[0] ?? '';
    const replay = model.embedded(first);
    try {
      if (current === '' && replay !== undefined) present(first, { replay, robot: model.page.robots[replay.robot], simulated: false });
    } catch {
      return null;   // the caption on the screen says why
    }
    if (current === '') return null;
    draw();
    return h('div', null, h('p', null, ...[...caption.childNodes].map((node) => node.cloneNode(true)), ` \u00b7 at ${fixed(time, 2)} s`),
      h('img', { src: canvas.toDataURL('image/png'), alt: 'The moment shown in the replay' }), h('img', { src: lines.toDataURL('image/png'), alt: 'The motion\u2019s time line' }));
  };

  const safely = (trial: string, thenPlay: boolean): void => {
    load(trial, thenPlay).catch((error: unknown) => {
      if (wanted !== trial) return;
      replace(caption, `This trial cannot be shown here: ${error instanceof Error ? error.message : String(error)}. `, h('code', null, command(model, trial)));
    });
  };

  onSelect((trial, thenPlay) => {
    if (!model.playable(trial)) return;
    if (model.page.live !== undefined && !thenPlay) return;   // walking through the table asks for nothing
    if (thenPlay) document.getElementById('replay')?.scrollIntoView();
    safely(trial, thenPlay);
  });
  const besideSafely = (): void => {
    setBeside().catch((error: unknown) => { near.textContent = `The other motion cannot be shown: ${error instanceof Error ? error.message : String(error)}.`; });
  };
  state.listen(['beside'], () => { if (current !== '') besideSafely(); });
  onTheme(() => { scene?.setColours(colours()); fillShelf(); tellLegend(); show(); });
  const element = h('div', { class: 'replay' },
    h('div', { class: 'replay-main' },
      stage, paper,
      h('div', { class: 'transport' }, play, scrub, clock, speed, h('label', null, follow, ' follow'), home),
      h('div', { class: 'transport more' }, otherBox, closest, stopped, picture, film),
      legend,
      lines, status, near),
    h('aside', null, h('h3', null, 'To play'), h('p', { class: 'note' }, shelfNote(model)), shelf,
      h('h3', null, 'Joints within their limits'), joints));
  element.addEventListener('keydown', (event) => {
    if (event.target instanceof HTMLInputElement || event.target instanceof HTMLSelectElement || event.target instanceof HTMLButtonElement) return;
    const move = { ArrowLeft: -0.1, ArrowRight: 0.1 }[event.key];
    if (event.key === ' ') toggle();
    else if (move !== undefined) { pause(); seek(time + move); }
    else return;
    event.preventDefault();
  });
  fillShelf();
  onPaper(paper, still);
  onView(fillShelf);
  whenSeen(element, () => {
    const asked = state.get('trial');
    if (current === '' && wanted === '') safely(model.playable(asked) ? asked : listed(model)[0] ?? '', false);
    new ResizeObserver(() => draw()).observe(stage);
  });
  return element;
}
