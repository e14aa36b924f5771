#!/usr/bin/env python3
"""The dependency rules between the folders, read off the #include lines.

  include_rules_test.py ROOT          checks the tree
  include_rules_test.py --self-test   proves that each rule can fail, and that what is allowed breaks none
"""

import re
import sys
from pathlib import Path

# In files under FOLDERS, whose path does not match EXCEPT, no include matches FORBIDDEN: FOLDERS, FORBIDDEN, EXCEPT, WHY.
# Regular expressions of the beginnings of paths from the root.
RULES = [
    ("controller", "(world|eval|reports)/", None, "the controller is installable on its own and knows nothing of the evaluation"),
    ("controller/describe", "controller/(model|task|qp|solver|closed_form|config|case|controller|params|step|types)", None, "descriptions know no description"),
    ("controller/model", "controller/(task|qp|solver|closed_form|config|case|controller|params|step)", None, "the robot model knows nothing of what is built on it"),
    ("controller/task", "controller/(qp|solver|closed_form|config|case|controller(_core)?)[./]", None, "what E is asked to do knows nothing of how a QP is made of it"),
    ("controller/qp", "controller/(solver|closed_form|policy|guard|lookahead|controller(_core)?)[./]", None, "a problem is posed without knowing who solves it"),
    ("controller/solver", "controller/(task|closed_form|controller(_core)?)[./]", None, "solvers see the problem alone"),
    ("controller/safe", "controller/(task|qp|solver|closed_form|config|case|controller(_core)?)[./]", None, "what makes a command safe knows nothing of how it was found"),
    ("controller/policy", "controller/(solver|guard|config|case|controller(_core)?)[./]", None, "a policy asks without knowing who solves or who guards"),
    ("controller/guard", "controller/(solver|policy|lookahead|task/escape|config|case|controller(_core)?)[./]", None, "a guard judges a command without knowing how it was found"),
    ("controller/plan", "controller/(lookahead|qp|solver|closed_form|config|case|controller(_core)?)[./]", None, "paths are laid for a robot, not for a controller"),
    ("controller/map", "controller/(task|qp|solver|closed_form|policy|guard|lookahead|plan|safe|config|case|params|controller(_core)?)[./]", None, "a map keeps what was seen and knows nothing of its use"),
    ("controller/(task|qp|solver|closed_form|safe)", "controller/lookahead/", None, "a step does not know that another looks ahead over it"),
    ("controller/closed_form", "controller/(task|solver|controller(_core)?)[./]", None, "the closed forms need no solver and no task"),
    ("controller/(task|qp|solver|closed_form)", "controller/(config|case)/", None, "problems are built from plain parameters, not from files"),
    ("controller/config", "controller/(case|fit|draft)/", None, "configuration is read without case files and without what describes robots"),
    ("controller/(model|task|qp|solver|closed_form|case)", "controller/(fit|draft)/", None, "robots are described before there is a controller"),
    ("controller/(fit|draft)", "controller/(task|qp|solver|closed_form|case|controller(_core)?)[./]", None, "describing a robot needs no controller"),
    ("(world|eval|plugin|examples)", "controller/controller_core", r"eval/trial/trial_detail\.cc", "a controller is used by its public face, and what looks into one is named here"),
    ("controller", "(fmt|spdlog|CLI|SQLiteCpp|omp)[/.]", "controller/(fit|draft)/.*", "the controller depends on Eigen, urdfdom, coal and its QP solver only"),
    ("controller", "nlohmann/", "controller/(config|case)/", "JSON belongs to the controller's file formats"),
    ("world", "(controller/(task|qp|solver|closed_form|policy|guard|case)/|eval/|reports/)", None, "worlds see the robot, never the controller or the evaluation"),
    ("eval/(stats|risk|search)", "(controller/model|world|plugin|eval/(trial|suite|batch|store|tune|run|cli))/", None, "statistics, rare events and the search for gains know no robot, no trial and no store"),
    ("eval/identify", "(controller/(task|qp|solver|closed_form|case|controller)[./]|plugin/|eval/(trial|suite|batch|store|search|tune|run|cli)/)", None, "identification knows a robot's log and nothing of trials"),
    ("eval/trial", "eval/(stats|suite|batch|store|search|tune|run|cli)/", None, "a trial needs its spec and its world alone"),
    ("eval/suite", "eval/(stats|batch|store|search|tune|run|cli)/", None, "a suite makes specs of files and computes nothing"),
    ("eval/batch", "eval/(store|search|tune|run|cli)/", None, "a batch computes trials whoever keeps them"),
    ("eval/store", "eval/(stats|batch|search/(evaluator|nlopt|objective|random)|tune|run|cli)", None, "the store keeps what it is given, and knows the records of a search"),
    ("eval/tune", "eval/(run|cli)/", None, "tuning is measured by trials, whoever asks for it"),
    ("eval/run", "eval/cli/", None, "what the commands do can be done without them"),
    ("eval/(stats|risk|identify|trial|suite|batch|store|search|tune|run)", "(iostream|cstdio)", r"eval/store/define_store\.cc", "only the commands print, and a program that writes a part of the build"),
    ("eval", "reports/", "eval/cli/", "only the commands know the reports"),
    ("plugin", "(world|eval|reports)/", None, "plugins and their host know the controller library and nothing of the evaluation"),
    ("(controller|world|reports|bench)", "plugin/", None, "plugins are loaded by plugin/host"),
    ("eval", r"plugin/[a-z_]+\.h", None, "eval meets plugins through plugin/host and does not know their interface"),
    (".*", r"dlfcn\.h", "(plugin/host/.*|(tests|bench)/.*)", "shared libraries are loaded by plugin/host"),
    ("(controller|world|eval|plugin)", r"(spawn|sys/wait)\.h", "plugin/process/.*", "processes are started by plugin/process"),
    ("reports", "(controller|world|eval)/", None, "reports see only the database"),
    ("files", "(controller|plugin|world|eval|reports)/", None, "files are written without knowing what is in them"),
    ("python", "(plugin|reports|eval/(stats|identify|batch|store|search|tune|run|cli))/", None, "the Python package binds robots, controllers and trials, and what evaluates is the program"),
    ("(controller|plugin|world|eval|reports|bench)", "python/", None, "sources do not depend on the Python package"),
    ("controller", "tests/", None, "sources do not depend on tests"),
    ("(world|eval|reports|bench|examples)", "tests/", "bench/.*", "sources do not depend on tests"),
    (".*", "ode/", "((tests/)?world/.*|tests/support/ode_.*|bench/.*)", "ODE belongs to world"),
    (".*", "yaml-cpp/", "controller/config/.*", "YAML belongs to controller/config"),
    (".*", "CLI/", "(tests/)?eval/cli[/_].*", "CLI11 belongs to eval/cli"),
    (".*", "(sqlite3|SQLiteCpp/)", "((tests/)?eval/store|(tests/)?reports|tests/fuzz/store|tests/eval/cli_(look|mistakes|tamper|workers))[/_.].*", "SQLite belongs to the store and the reports"),
    (".*", r"nlopt\.", "((tests/)?eval/search[/_].*|controller/fit/.*)", "NLopt belongs to eval/search and controller/fit"),
    (".*", r"mpi\.h", "(tests/)?eval/batch[/_].*", "MPI belongs to eval/batch"),
    (".*", "(urdf|urdf_parser|urdf_model)/", "controller/.*", "URDFs are read by the controller's library"),
    (".*", "coal/", "((tests/)?controller/.*|tests/support/coal_.*)", "distances come from controller/model"),
    (".*", r"(api|auxiliary|avi|bnb|constants|daqp|daqp_prox|eq_elim|factorization|hierarchical|presolve|types|utils)\.h", r"controller/solver/[a-z_]*daqp[a-z_]*\.(h|cc)", "DAQP is known to its adapter only"),
    (".*", "qpOASES", r"tests/support/solver_qpoases\.cc", "qpOASES is known to its adapter only"),
    (".*", "eiquadprog/", r"tests/support/solver_eiquadprog\.cc", "eiquadprog is known to its adapter only"),
]
FOLDERS = ("files", "controller", "world", "eval", "reports", "tests", "bench", "examples", "plugin", "python")

# FILE=HEADER: a file that includes a header. Each of the first breaks a rule, none of the others.
SAMPLES = """
    files/a.cc=eval/store/error.h controller/a.cc=world/world.h controller/qp/a.h=eval/trial/row.h
    controller/model/a.h=reports/render/page.h controller/model/b.cc=controller/solver/solver.h
    controller/qp/b.cc=controller/config/node.h controller/describe/a.h=controller/types.h
    controller/task/a.cc=controller/qp/problem.h controller/qp/e.cc=controller/solver/solver.h
    controller/policy/a.cc=controller/solver/fallback.h controller/guard/a.cc=controller/policy/policy.h
    controller/plan/a.cc=controller/qp/problem.h controller/safe/b.cc=controller/qp/limits.h
    controller/map/a.cc=controller/plan/plan_params.h
    controller/safe/a.cc=controller/lookahead/rollout.h controller/solver/a.cc=controller/task/servo.h
    controller/closed_form/a.cc=controller/task/servo.h world/g.cc=controller/controller_core.h
    eval/cli/g.cc=controller/controller_core.h controller/config/a.cc=controller/case/solve.h
    controller/model/c.cc=controller/fit/solid.h controller/draft/a.cc=controller/qp/problem.h
    controller/config/c.cc=controller/draft/posture.h controller/fit/b.cc=controller/qp/problem.h
    controller/config/b.cc=controller/fit/fit_robot.h controller/b.cc=fmt/format.h controller/c.cc=nlohmann/json.hpp
    world/a.cc=controller/qp/problem.h world/b.cc=eval/suite/suite.h eval/trial/a.cc=reports/render/page.h
    python/bindings/a.cc=eval/run/evaluate.h controller/f.cc=python/bindings/robot.h reports/a.cc=controller/step.h
    reports/b.cc=world/world.h controller/d.cc=tests/support/x.h eval/a.cc=tests/support/x.h eval/trial/b.cc=ode/ode.h
    world/c.cc=yaml-cpp/yaml.h eval/suite/a.cc=CLI/CLI.hpp eval/batch/a.cc=SQLiteCpp/SQLiteCpp.h eval/cli/a.cc=sqlite3.h
    eval/batch/b.cc=nlopt.hpp eval/cli/b.cc=mpi.h world/d.cc=urdf_parser/urdf_parser.h world/e.cc=coal/distance.h
    tests/world/a.cc=coal/distance.h controller/solver/solver.cc=api.h plugin/a.h=eval/trial/row.h
    controller/e.cc=plugin/moma_plugin.h eval/trial/c.cc=plugin/moma_plugin.h eval/stats/a.cc=eval/trial/row.h
    eval/risk/a.cc=eval/store/writer.h eval/search/a.cc=world/world.h eval/search/b.cc=eval/tune/tuning.h
    eval/trial/d.cc=eval/suite/suite.h eval/identify/a.cc=eval/trial/spec.h eval/suite/c.h=eval/batch/batch.h
    eval/batch/c.cc=eval/store/writer.h eval/store/a.cc=eval/batch/batch.h eval/tune/a.cc=eval/run/evaluate.h
    eval/tune/b.cc=nlopt.hpp eval/run/a.cc=eval/cli/table.h eval/run/b.cc=iostream eval/run/c.cc=reports/render/page.h
    eval/suite/b.cc=dlfcn.h eval/suite/e.cc=spawn.h controller/solver/c.cc=qpOASES.hpp
    tests/controller/a.cc=eiquadprog/eiquadprog-fast.hpp
""".split()
ALLOWED = """
    plugin/host/a.cc=dlfcn.h plugin/process/a.cc=spawn.h plugin/host/b.cc=plugin/moma_plugin.h plugin/b.h=controller/step.h
    examples/a.cc=plugin/plugin.h tests/plugin/plugins/a.cc=plugin/plugin.h controller/solver/solver_daqp.cc=api.h
    world/plant/ode_plant.cc=ode/ode.h eval/cli/c.cc=reports/render/page.h python/bindings/b.cc=eval/trial/stepped_trial.h
    controller/case/solve.cc=nlohmann/json.hpp controller/qp/d.cc=controller/types.h world/f.cc=controller/model/kinematics.h
    tests/support/coal_distance.cc=coal/distance.h controller/fit/a.cc=nlopt.hpp controller/draft/b.cc=fmt/format.h
    eval/search/c.cc=nlopt.hpp eval/suite/d.h=eval/trial/spec.h eval/store/b.cc=eval/suite/suite.h
    eval/tune/c.cc=eval/store/writer.h eval/run/d.cc=eval/tune/tuning.h eval/cli/d.cc=eval/run/evaluate.h eval/cli/e.cc=iostream
""".split()


def includes_of(root):
    """(file, header) for each #include line of the sources under `root`."""
    for folder in FOLDERS:
        for path in sorted((root / folder).rglob("*")):
            if path.suffix in (".h", ".cc") and "node_modules" not in path.parts:
                for header in re.findall(r'^[ \t]*#[ \t]*include[ \t]*[<"]([^>"]*)', path.read_text(), re.M):
                    yield path.relative_to(root).as_posix(), header


def violations(includes):
    """(file, header, why) for each include that breaks a rule."""
    for folders, forbidden, exempt, why in RULES:
        inside = re.compile(f"(?:{folders})/" if folders != ".*" else "")
        wrong, right = re.compile(forbidden), re.compile(exempt or "(?!)")
        for file, header in includes:
            if inside.match(file) and wrong.match(header) and not right.match(file):
                yield file, header, why


def self_test():
    seen, wrong = set(), []
    for sample in SAMPLES + ALLOWED:
        found = list(violations([sample.split("=")]))
        seen.update(why for *_, why in found)
        if (sample in ALLOWED) == bool(found):
            wrong.append(f"{sample} is {'refused though allowed' if found else 'not noticed'}")
    return wrong + [f"no sample breaks the rule: {why}" for *_, why in RULES if why not in seen]


def main():
    if sys.argv[1] == "--self-test":
        wrong = self_test()
    else:
        includes = list(includes_of(Path(sys.argv[1])))
        wrong = [f"{file} includes {header}: {why}" for file, header, why in violations(includes)] if includes else ["no sources"]
    print("\n".join(wrong))
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main())
