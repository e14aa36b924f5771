# The dependency rules between the folders, read off the #include lines:
#
#   cmake -DROOT=... -P include_rules_test.cmake                          checks the tree
#   cmake -DROOT=... -DSELF_TEST=SCRATCH_DIR -P include_rules_test.cmake  proves that every rule can fail
#
# A rule is FOLDERS | FORBIDDEN | EXCEPT | WHY: in files under FOLDERS, whose path does not match EXCEPT, no include may
# match FORBIDDEN. All three are regular expressions on paths from the root.
cmake_minimum_required(VERSION 3.25)

set(rules
  "controller|(world|eval|reports)/|-|the controller is installable on its own and knows nothing of the evaluation"
  "controller/describe|controller/(model|task|qp|solver|closed_form|config|case|controller|params|step|types)|-|descriptions know no description"
  "controller/model|controller/(task|qp|solver|closed_form|config|case|controller|params|step)|-|the robot model knows nothing of what is built on it"
  "controller/task|controller/(qp|solver|closed_form|config|case|controller(_core)?)[./]|-|what E is asked to do knows nothing of how a QP is made of it"
  "controller/qp|controller/(solver|closed_form|policy|guard|lookahead|controller(_core)?)[./]|-|a problem is posed without knowing who solves it"
  "controller/solver|controller/(task|closed_form|controller(_core)?)[./]|-|solvers see the problem alone"
  "controller/safe|controller/(task|qp|solver|closed_form|config|case|controller(_core)?)[./]|-|what makes a command safe knows nothing of how it was found"
  "controller/policy|controller/(solver|guard|config|case|controller(_core)?)[./]|-|a policy asks without knowing who solves or who guards"
  "controller/guard|controller/(solver|policy|lookahead|task/escape|config|case|controller(_core)?)[./]|-|a guard judges a command without knowing how it was found"
  "controller/plan|controller/(lookahead|qp|solver|closed_form|config|case|controller(_core)?)[./]|-|paths are laid for a robot, not for a controller"
  "controller/(task|qp|solver|closed_form|safe)|controller/lookahead/|-|a step does not know that another looks ahead over it"
  "controller/closed_form|controller/(task|solver|controller(_core)?)[./]|-|the closed forms need no solver and no task"
  "controller/(task|qp|solver|closed_form)|controller/(config|case)/|-|problems are built from plain parameters, not from files"
  "controller/config|controller/(case|fit|draft)/|-|configuration is read without case files and without what describes robots"
  "controller/(model|task|qp|solver|closed_form|case)|controller/(fit|draft)/|-|robots are described before there is a controller"
  "controller/(fit|draft)|controller/(task|qp|solver|closed_form|case|controller(_core)?)[./]|-|describing a robot needs no controller"
  "(world|eval|plugin|examples)|controller/controller_core|eval/trial/trial_detail\\.cc|a controller is used by its public face, and what looks into one is named here"
  "controller|(fmt|spdlog|CLI|SQLiteCpp|omp)[/.]|controller/(fit|draft)/.*|the controller depends on Eigen, urdfdom, coal and its QP solver only"
  "controller|nlohmann/|controller/(config|case)/|JSON belongs to the controller's file formats"
  "world|(controller/(task|qp|solver|closed_form|policy|guard|case)/|eval/|reports/)|-|worlds see the robot, never the controller or the evaluation"
  "eval/(stats|risk|search)|(controller/model|world|plugin|eval/(trial|suite|batch|store|tune|run|cli))/|-|statistics, rare events and the search for gains know no robot, no trial and no store"
  "eval/identify|(controller/(task|qp|solver|closed_form|case|controller)[./]|plugin/|eval/(stats|trial|suite|batch|store|search|tune|run|cli)/)|-|identification knows a robot's log and nothing of trials"
  "eval/trial|eval/(stats|suite|batch|store|search|tune|run|cli)/|-|a trial needs its spec and its world alone"
  "eval/suite|eval/(stats|batch|store|search|tune|run|cli)/|-|a suite makes specs of files and computes nothing"
  "eval/batch|eval/(store|search|tune|run|cli)/|-|a batch computes trials whoever keeps them"
  "eval/store|eval/(stats|batch|search/(evaluator|nlopt|objective|random)|tune|run|cli)|-|the store keeps what it is given, and knows the records of a search"
  "eval/tune|eval/(run|cli)/|-|tuning is measured by trials, whoever asks for it"
  "eval/run|eval/cli/|-|what the commands do can be done without them"
  "eval/(stats|risk|identify|trial|suite|batch|store|search|tune|run)|(iostream|cstdio)|eval/store/define_store\\.cc|only the commands print, and a program that writes a part of the build"
  "eval|reports/|eval/cli/|only the commands know the reports"
  "plugin|(world|eval|reports)/|-|plugins and their host know the controller library and nothing of the evaluation"
  "(controller|world|reports|bench)|plugin/|-|plugins are loaded by plugin/host"
  "eval|plugin/[a-z_]+\\.h|-|eval meets plugins through plugin/host and does not know their interface"
  ".*|dlfcn\\.h|(plugin/host/.*|(tests|bench)/.*)|shared libraries are loaded by plugin/host"
  "(controller|world|eval|plugin)|(spawn|sys/wait)\\.h|plugin/process/.*|processes are started by plugin/process"
  "reports|(controller|world|eval)/|-|reports see only the database"
  "files|(controller|plugin|world|eval|reports)/|-|files are written without knowing what is in them"
  "python|(plugin|reports|eval/(stats|identify|batch|store|search|tune|run|cli))/|-|the Python package binds robots, controllers and trials, and what evaluates is the program"
  "(controller|plugin|world|eval|reports|bench)|python/|-|sources do not depend on the Python package"
  "controller|tests/|-|sources do not depend on tests"
  "(world|eval|reports|bench|examples)|tests/|bench/.*|sources do not depend on tests"
  ".*|ode/|((tests/)?world/.*|tests/support/ode_.*|bench/.*)|ODE belongs to world"
  ".*|yaml-cpp/|controller/config/.*|YAML belongs to controller/config"
  ".*|CLI/|(tests/)?eval/cli[/_].*|CLI11 belongs to eval/cli"
  ".*|(sqlite3|SQLiteCpp/)|((tests/)?eval/store|(tests/)?reports|tests/fuzz/store|tests/eval/cli_(look|mistakes|tamper|workers))[/_.].*|SQLite belongs to the store and the reports"
  ".*|nlopt\\.|((tests/)?eval/search[/_].*|controller/fit/.*)|NLopt belongs to eval/search and controller/fit"
  ".*|mpi\\.h|(tests/)?eval/batch[/_].*|MPI belongs to eval/batch"
  ".*|(urdf|urdf_parser|urdf_model)/|controller/.*|URDFs are read by the controller's library"
  ".*|coal/|((tests/)?controller/.*|tests/support/coal_.*)|distances come from controller/model"
  ".*|(api|auxiliary|avi|bnb|constants|daqp|daqp_prox|eq_elim|factorization|hierarchical|presolve|types|utils)\\.h|controller/solver/[a-z_]*daqp[a-z_]*\\.(h|cc)|DAQP is known to its adapter only"
  ".*|qpOASES|tests/support/solver_qpoases\\.cc|qpOASES is known to its adapter only"
  ".*|eiquadprog/|tests/support/solver_eiquadprog\\.cc|eiquadprog is known to its adapter only"
)

function(split_rule rule)
  string(REPLACE "\\|" "\\" rule "${rule}")
  # Alternatives inside parentheses use | too: split only at depth 0.
  set(parts "")
  set(part "")
  set(depth 0)
  string(LENGTH "${rule}" length)
  math(EXPR last "${length} - 1")
  foreach(i RANGE ${last})
    string(SUBSTRING "${rule}" ${i} 1 c)
    if(c STREQUAL "(")
      math(EXPR depth "${depth} + 1")
    elseif(c STREQUAL ")")
      math(EXPR depth "${depth} - 1")
    endif()
    if(c STREQUAL "|" AND depth EQUAL 0)
      list(APPEND parts "${part}")
      set(part "")
    else()
      string(APPEND part "${c}")
    endif()
  endforeach()
  list(GET parts 0 folders)
  list(GET parts 1 forbidden)
  list(GET parts 2 except)
  set(folders "${folders}" PARENT_SCOPE)
  set(forbidden "${forbidden}" PARENT_SCOPE)
  set(except "${except}" PARENT_SCOPE)
  set(why "${part}" PARENT_SCOPE)
endfunction()

# Sets `found` to the violations of the tree at `root`.
function(check_tree root)
  set(violations "")
  file(GLOB_RECURSE files RELATIVE "${root}" "${root}/files/*.h" "${root}/files/*.cc" "${root}/controller/*.h" "${root}/controller/*.cc" "${root}/world/*.h"
       "${root}/world/*.cc" "${root}/eval/*.h" "${root}/eval/*.cc" "${root}/reports/*.h" "${root}/reports/*.cc"
       "${root}/tests/*.h" "${root}/tests/*.cc" "${root}/bench/*.h" "${root}/bench/*.cc" "${root}/examples/*.cc"
       "${root}/plugin/*.h" "${root}/plugin/*.cc" "${root}/python/*.h" "${root}/python/*.cc")
  list(FILTER files EXCLUDE REGEX "/node_modules/")
  list(LENGTH files count)
  if(count EQUAL 0)
    message(FATAL_ERROR "no sources under ${root}")
  endif()
  set(includes "")
  foreach(file IN LISTS files)
    file(STRINGS "${root}/${file}" lines REGEX "^[ \t]*#[ \t]*include[ \t]*[<\"]")
    foreach(line IN LISTS lines)
      string(REGEX REPLACE "^[ \t]*#[ \t]*include[ \t]*[<\"]([^>\"]*).*" "\\1" header "${line}")
      list(APPEND includes "${file}=${header}")
    endforeach()
  endforeach()
  foreach(rule IN LISTS rules)
    split_rule("${rule}")
    foreach(include IN LISTS includes)
      if(include MATCHES "^(${folders})[/=]" OR folders STREQUAL ".*")
        string(REGEX MATCH "^[^=]*" file "${include}")
        string(REGEX MATCH "[^=]*$" header "${include}")
        if(header MATCHES "^(${forbidden})" AND NOT file MATCHES "^(${except})")
          list(APPEND violations "${file} includes ${header}: ${why}")
        endif()
      endif()
    endforeach()
  endforeach()
  set(found "${violations}" PARENT_SCOPE)
endfunction()

if(NOT SELF_TEST)
  check_tree("${ROOT}")
  if(found)
    list(JOIN found "\n  " text)
    message(FATAL_ERROR "dependency rules broken:\n  ${text}")
  endif()
  return()
endif()

# One file that breaks one rule, for each rule at least one; and one file that breaks none.
set(samples
  "files/a.cc=eval/store/error.h"
  "controller/a.cc=world/world.h" "controller/qp/a.h=eval/trial/row.h" "controller/model/a.h=reports/render/page.h"
  "controller/model/b.cc=controller/solver/solver.h" "controller/qp/b.cc=controller/config/node.h"
  "controller/describe/a.h=controller/types.h" "controller/task/a.cc=controller/qp/problem.h" "controller/qp/e.cc=controller/solver/solver.h"
  "controller/policy/a.cc=controller/solver/fallback.h" "controller/guard/a.cc=controller/policy/policy.h" "controller/plan/a.cc=controller/qp/problem.h" "controller/safe/b.cc=controller/qp/limits.h" "controller/safe/a.cc=controller/lookahead/rollout.h"
  "controller/solver/a.cc=controller/task/servo.h" "controller/closed_form/a.cc=controller/task/servo.h"
  "world/g.cc=controller/controller_core.h" "eval/cli/g.cc=controller/controller_core.h"
  "controller/config/a.cc=controller/case/solve.h" "controller/model/c.cc=controller/fit/solid.h"
  "controller/draft/a.cc=controller/qp/problem.h" "controller/config/c.cc=controller/draft/posture.h"
  "controller/fit/b.cc=controller/qp/problem.h" "controller/config/b.cc=controller/fit/fit_robot.h" "controller/b.cc=fmt/format.h"
  "controller/c.cc=nlohmann/json.hpp"
  "world/a.cc=controller/qp/problem.h" "world/b.cc=eval/suite/suite.h" "eval/trial/a.cc=reports/render/page.h"
  "python/bindings/a.cc=eval/run/evaluate.h" "controller/f.cc=python/bindings/robot.h" "reports/a.cc=controller/step.h" "reports/b.cc=world/world.h" "controller/d.cc=tests/support/x.h"
  "eval/a.cc=tests/support/x.h" "eval/trial/b.cc=ode/ode.h" "world/c.cc=yaml-cpp/yaml.h" "eval/suite/a.cc=CLI/CLI.hpp"
  "eval/batch/a.cc=SQLiteCpp/SQLiteCpp.h" "eval/cli/a.cc=sqlite3.h" "eval/batch/b.cc=nlopt.hpp" "eval/cli/b.cc=mpi.h"
  "world/d.cc=urdf_parser/urdf_parser.h" "world/e.cc=coal/distance.h" "tests/world/a.cc=coal/distance.h" "controller/solver/solver.cc=api.h"
  "plugin/a.h=eval/trial/row.h" "controller/e.cc=plugin/moma_plugin.h" "eval/trial/c.cc=plugin/moma_plugin.h"
  "eval/stats/a.cc=eval/trial/row.h" "eval/risk/a.cc=eval/store/writer.h" "eval/search/a.cc=world/world.h" "eval/search/b.cc=eval/tune/tuning.h"
  "eval/trial/d.cc=eval/suite/suite.h" "eval/identify/a.cc=eval/trial/spec.h" "eval/suite/c.h=eval/batch/batch.h" "eval/batch/c.cc=eval/store/writer.h"
  "eval/store/a.cc=eval/batch/batch.h" "eval/tune/a.cc=eval/run/evaluate.h" "eval/tune/b.cc=nlopt.hpp"
  "eval/run/a.cc=eval/cli/table.h" "eval/run/b.cc=iostream" "eval/run/c.cc=reports/render/page.h"
  "eval/suite/b.cc=dlfcn.h" "eval/suite/e.cc=spawn.h" "controller/solver/c.cc=qpOASES.hpp" "tests/controller/a.cc=eiquadprog/eiquadprog-fast.hpp"
)
set(allowed "plugin/host/a.cc=dlfcn.h" "plugin/process/a.cc=spawn.h" "plugin/host/b.cc=plugin/moma_plugin.h" "plugin/b.h=controller/step.h"
            "examples/a.cc=plugin/plugin.h" "tests/plugin/plugins/a.cc=plugin/plugin.h"
            "controller/solver/solver_daqp.cc=api.h" "world/plant/ode_plant.cc=ode/ode.h" "eval/cli/c.cc=reports/render/page.h"
            "python/bindings/b.cc=eval/trial/stepped_trial.h" "controller/case/solve.cc=nlohmann/json.hpp" "controller/qp/d.cc=controller/types.h"
            "world/f.cc=controller/model/kinematics.h" "tests/support/coal_distance.cc=coal/distance.h"
            "controller/fit/a.cc=nlopt.hpp" "controller/draft/b.cc=fmt/format.h" "eval/search/c.cc=nlopt.hpp" "eval/suite/d.h=eval/trial/spec.h"
            "eval/store/b.cc=eval/suite/suite.h" "eval/tune/c.cc=eval/store/writer.h" "eval/run/d.cc=eval/tune/tuning.h"
            "eval/cli/d.cc=eval/run/evaluate.h" "eval/cli/e.cc=iostream")
set(broken 0)
set(seen "")
foreach(sample IN LISTS samples allowed)
  file(REMOVE_RECURSE "${SELF_TEST}")
  string(REGEX MATCH "^[^=]*" file "${sample}")
  string(REGEX MATCH "[^=]*$" header "${sample}")
  file(WRITE "${SELF_TEST}/${file}" "#pragma once\n#include <vector>\n#include \"${header}\"\n")
  check_tree("${SELF_TEST}")
  if(sample IN_LIST samples AND NOT found)
    message(SEND_ERROR "not noticed: ${file} includes ${header}")
  elseif(sample IN_LIST allowed AND found)
    message(SEND_ERROR "refused though allowed: ${found}")
  endif()
  foreach(violation IN LISTS found)
    string(REGEX REPLACE "^[^:]*: " "" why "${violation}")
    list(APPEND seen "${why}")
  endforeach()
endforeach()
file(REMOVE_RECURSE "${SELF_TEST}")
foreach(rule IN LISTS rules)
  split_rule("${rule}")
  if(NOT why IN_LIST seen)
    message(SEND_ERROR "no sample breaks the rule: ${why}")
  endif()
endforeach()
