"""The tables of docs/studies/peers.md from stores, of which each may have some of the controllers: Markdown on standard output.

    python3 examples/peers/table.py results/peers.db results/tuned/peers.db ...
"""

import sys

import moma
import pandas

SUMMARY = """
    SELECT robot, controller, family, sum(n) AS n, success_rate, success_low, success_high, collision_rate, collision_low, collision_high,
           time_to_goal_median_s, manip_mean, command_change_mean
    FROM v_summary WHERE n > 0 GROUP BY robot, controller, family
"""


def percent(row, rate):
    low, high = (100 * row[f"{rate}_{end}"] for end in ("low", "high"))
    return f"{100 * row[f'{rate}_rate']:.0f} [{low:.0f}, {high:.0f}]"


def main(*files):
    whole = pandas.concat([moma.Store(file).sql(SUMMARY) for file in files])
    for (robot, family), table in whole.groupby(["robot", "family"], sort=False):
        print(f"\n{robot}, {family}\n")
        print("| controller | n | success % [95 %] | collision % [95 %] | median time to goal s | mean manip. | mean command change |")
        print("| --- | ---: | ---: | ---: | ---: | ---: | ---: |")
        for _, row in table.sort_values(["success_rate", "controller"], ascending=[False, True]).iterrows():
            numbers = (row.time_to_goal_median_s, 2), (row.manip_mean, 3), (row.command_change_mean, 3)
            cells = [percent(row, "success"), percent(row, "collision"), *(f"{value:.{digits}f}" for value, digits in numbers)]
            print(f"| `{row.controller}` | {row.n} | " + " | ".join(cells) + " |")


if __name__ == "__main__":
    main(*sys.argv[1:])
