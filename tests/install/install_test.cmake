# Installs what BINARY_DIR built to a scratch prefix, then configures, builds and runs programs that know moma only
# as an installed package, and the installed program itself.
#   cmake -DBINARY_DIR=... -DSOURCE_DIR=... -DSCRATCH=... -DGENERATOR=... [-DHAS_PROGRAM=ON] ... -P install_test.cmake
cmake_minimum_required(VERSION 3.25)

function(run what)
  execute_process(COMMAND ${ARGN} RESULT_VARIABLE code OUTPUT_VARIABLE output ERROR_VARIABLE output)
  if(NOT code EQUAL 0)
    message(FATAL_ERROR "${what} failed (${code}):\n${output}")
  endif()
  set(output "${output}" PARENT_SCOPE)
endfunction()

set(prefix "${SCRATCH}/prefix")
file(REMOVE_RECURSE "${SCRATCH}")
set(components library)
if(HAS_PROGRAM)
  list(APPEND components program)
endif()
foreach(component IN LISTS components)
  run("installing ${component}" "${CMAKE_COMMAND}" --install "${BINARY_DIR}" --prefix "${prefix}" --component ${component})
endforeach()

# The public face is what the targets list, and none of the controller's parts.
file(GLOB_RECURSE headers RELATIVE "${prefix}/include/moma" "${prefix}/include/moma/*")
set(listed "")
foreach(header IN LISTS HEADERS)
  file(RELATIVE_PATH header "${SOURCE_DIR}" "${header}")
  list(APPEND listed "${header}")
endforeach()
list(SORT headers)
list(SORT listed)
if(NOT headers STREQUAL listed OR NOT "controller/controller.h" IN_LIST headers)
  message(FATAL_ERROR "installed are\n  ${headers}\nand listed\n  ${listed}")
endif()
foreach(header IN LISTS headers)
  if(header MATCHES "_core|/(qp|solver|task|closed_form|case|fit|host)/")
    message(FATAL_ERROR "${header} is installed: it is an inner part")
  endif()
endforeach()
list(TRANSFORM headers PREPEND "${prefix}/include/moma/")

# Installed files must do without the source tree and its third-party sources.
file(GLOB_RECURSE packages "${prefix}/*/cmake/moma/*.cmake")
foreach(file IN LISTS headers packages)
  file(READ "${file}" text)
  string(FIND "${text}" "${SOURCE_DIR}" in_sources)
  string(FIND "${text}" "${BINARY_DIR}" in_build)
  if(NOT in_sources EQUAL -1 OR NOT in_build EQUAL -1)
    message(FATAL_ERROR "${file} names the source or build tree")
  endif()
endforeach()

# What the prefix carries of other people's is there with its licence.
foreach(wheel IN ITEMS coal:libcoal boost_filesystem:cmeel_boost)
  string(REGEX REPLACE ":.*" "" library "${wheel}")
  string(REGEX REPLACE ".*:" "" wheel "${wheel}")
  file(GLOB_RECURSE carried "${prefix}/lib*/lib${library}.so*")
  file(GLOB texts "${prefix}/share/doc/moma/licenses/${wheel}/*")
  if(carried AND NOT texts)
    message(FATAL_ERROR "no licence of ${wheel} under ${prefix}/share/doc/moma/licenses, but ${carried}")
  endif()
endforeach()

# ccache takes precompiled headers where it is told that they are no matter of macros and time. What it misses it compiles
# without preprocessing it before.
set(ENV{CCACHE_SLOPPINESS} "pch_defines,time_macros")
set(ENV{CCACHE_DEPEND} 1)
run("configuring a consumer" "${CMAKE_COMMAND}" -S "${SOURCE_DIR}/tests/install/consumer" -B "${SCRATCH}/build"
    -G "${GENERATOR}" "-DCMAKE_PREFIX_PATH=${prefix}" "-DCMAKE_CXX_COMPILER=${CXX}" "-DCMAKE_CXX_FLAGS=${CXX_FLAGS}"
    "-DCMAKE_CXX_COMPILER_LAUNCHER=${LAUNCHER}" "-DEXAMPLE=${SOURCE_DIR}/examples/steer_frankie.cc"
    "-DHEADERS=${prefix}/include/moma")
run("building a consumer" "${CMAKE_COMMAND}" --build "${SCRATCH}/build")
run("running the consumer" "${SCRATCH}/build/consumer")
if(NOT output MATCHES "frankie: solved")
  message(FATAL_ERROR "unexpected output of the consumer: ${output}")
endif()
run("running the consumer of the bare library" "${SCRATCH}/build/library_only")
run("running the example" "${SCRATCH}/build/my_robot" "${prefix}/share/moma/configs/robots/frankie.yaml"
    "${prefix}/share/moma/configs/controllers/moma.yaml")

# Whatever is loaded comes from the prefix or the system: the checkout, and the wheels in it, may go.
set(programs "${SCRATCH}/build/consumer" "${SCRATCH}/build/library_only")
if(HAS_PROGRAM)
  list(APPEND programs "${prefix}/bin/moma")
endif()
run("asking the loader" ldd ${programs})
string(REGEX MATCHALL "/[^\n]* [(]0x" loaded "${output}")
list(TRANSFORM loaded REPLACE " [(]0x$" "")
foreach(library IN LISTS loaded)
  file(REAL_PATH "${library}" real)
  cmake_path(IS_PREFIX prefix "${library}" NORMALIZE installed)
  if(NOT installed AND (library MATCHES "cmeel|/\\.venv/" OR real MATCHES "cmeel|/\\.venv/"))
    message(FATAL_ERROR "${library} is loaded from the wheels")
  endif()
endforeach()
string(REGEX MATCHALL "[^\n]+ => not found" missing "${output}")
if(missing)
  message(FATAL_ERROR "not found by the loader: ${missing}")
endif()
if(NOT "${loaded}" MATCHES "libcoal")
  message(FATAL_ERROR "the installed programs load no libcoal: ${loaded}")
endif()
if(HAS_PROGRAM)
  run("running the installed program" "${prefix}/bin/moma" --help)
  foreach(file IN ITEMS man/man1/moma.1 bash-completion/completions/moma
          fish/vendor_completions.d/moma.fish doc/moma/README.md doc/moma/docs/index.md doc/moma/examples/steer_frankie.cc)
    if(NOT EXISTS "${prefix}/share/${file}")
      message(FATAL_ERROR "share/${file} is not installed")
    endif()
  endforeach()
  file(WRITE "${SCRATCH}/suite.yaml" "
robot: ${prefix}/share/moma/configs/robots/frankie.yaml
controllers: {mine: {method: plugin, path: build/consumer_plugin.so, parameters: {gain: 2}}}
worlds: {seed: 1, families: {open: {weight: 1}}}
simulation: {mode: kinematic, time_limit: 1}
trials: 2
")
  run("running a plugin" "${prefix}/bin/moma" run "${SCRATCH}/suite.yaml" -o "${SCRATCH}/plugin.db")
  if(NOT output MATCHES "mine")
    message(FATAL_ERROR "unexpected output of a run with a plugin: ${output}")
  endif()
  run("reading an installed robot" "${prefix}/bin/moma" robot "${prefix}/share/moma/configs/robots/frankie.yaml")
endif()
file(REMOVE_RECURSE "${SCRATCH}")
