#!/usr/bin/env python3
"""Kills `moma run` with SIGKILL at random moments, goes on each time, and compares the store with an undisturbed one.

    python3 bench/kill_run.py build/moma [SUITE] [--kills 50] [--trials 200] [--seed 1] [-- OPTION...]

Prints, per kill, how many trials were saved, and at the end: that PRAGMA integrity_check was clean after every kill,
that all deterministic columns are those of the undisturbed run, and how many trials were computed for those wanted.
Standard library only; exit 1 where any of it does not hold.
"""
import argparse
import os
import random
import signal
import sqlite3
import subprocess
import sys
import tempfile
import time


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument('moma')
    parser.add_argument('suite', nargs='?', default='configs/suites/prototype-kinematic.yaml')
    parser.add_argument('--kills', type=int, default=50)
    parser.add_argument('--trials', type=int, default=200, help='worlds; the suite has two controllers')
    parser.add_argument('--seed', type=int, default=1)
    parser.add_argument('options', nargs='*', help='of moma run')
    args = parser.parse_args()
    rng = random.Random(args.seed)
    folder = tempfile.mkdtemp(prefix='moma-kill-')

    def command(db):
        return [args.moma, 'run', args.suite, '-o', db, '--trials', str(args.trials), '-q', *args.options]

    def result_hash(db):
        out = subprocess.run([args.moma, 'verify', db, '--fraction', '0', '--hash', '-q'], capture_output=True,
                             text=True, check=True).stdout
        return out.split('results ')[1].strip()

    whole, broken = os.path.join(folder, 'whole.db'), os.path.join(folder, 'broken.db')
    begin = time.monotonic()
    subprocess.run(command(whole), stdout=subprocess.DEVNULL, check=True)
    whole_time = time.monotonic() - begin
    begin = time.monotonic()
    subprocess.run(command(whole), stdout=subprocess.DEVNULL, check=True)  # finds nothing to do
    start_up = time.monotonic() - begin
    # Moments from the first instant to `latest`, such that on average each run gets to the share of work that lets
    # the last kill meet the end of it: E[max(0, U(0, latest) - start_up)] = share.
    share = (whole_time - start_up) / args.kills
    latest = start_up + share + (share ** 2 + 2 * share * start_up) ** 0.5
    wanted = sqlite3.connect(whole).execute('SELECT count(*) FROM trial').fetchone()[0]
    faults, saved = [], 0
    for k in range(args.kills):
        process = subprocess.Popen(command(broken), stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        time.sleep(rng.uniform(0.0, latest))
        process.send_signal(signal.SIGKILL)
        process.wait()
        if not os.path.exists(broken) or os.path.getsize(broken) == 0:
            continue
        db = sqlite3.connect(broken)
        check = db.execute('PRAGMA integrity_check').fetchone()[0]
        if check != 'ok':
            faults.append(f'kill {k}: {check}')
        tables = db.execute("SELECT count(*) FROM sqlite_schema WHERE name = 'trial'").fetchone()[0]
        now = db.execute('SELECT count(*) FROM trial').fetchone()[0] if tables else 0
        if now < saved:
            faults.append(f'kill {k}: {saved} trials were saved before, {now} now')
        saved = now
        db.close()
        print(f'kill {k + 1}: {saved} of {wanted} saved', file=sys.stderr)
    subprocess.run(command(broken), stdout=subprocess.DEVNULL, check=True)
    if result_hash(broken) != result_hash(whole):
        faults.append('the results differ from those of an undisturbed run')
    done = sqlite3.connect(broken).execute('SELECT sum(trials_done) FROM invocation').fetchone()[0]
    if done != wanted:
        faults.append(f'{done} trials were stored for {wanted} wanted')
    for fault in faults:
        print(fault)
    print(f'{args.kills} kills: {"all well" if not faults else "FAULTS"}; {wanted} trials, hash {result_hash(broken)}')
    return 1 if faults else 0


if __name__ == '__main__':
    sys.exit(main())
