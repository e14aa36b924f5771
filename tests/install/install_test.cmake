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

# The installed headers must do without the source tree and its third-party sources.
file(GLOB_RECURSE headers "${prefix}/include/*.h")
list(LENGTH headers count)
if(count LESS 15)
  message(FATAL_ERROR "only ${count} headers were installed under ${prefix}/include")
endif()
file(GLOB_RECURSE packages "${prefix}/*/cmake/moma/*.cmake")
foreach(file IN LISTS headers packages)
  file(READ "${file}" text)
  string(FIND "${text}" "${SOURCE_DIR}" in_sources)
  string(FIND "${text}" "${BINARY_DIR}" in_build)
  if(NOT in_sources EQUAL -1 OR NOT in_build EQUAL -1)
    message(FATAL_ERROR "${file} names the source or build tree")
  endif()
endforeach()

run("configuring a consumer" "${CMAKE_COMMAND}" -S "${SOURCE_DIR}/tests/install/consumer" -B "${SCRATCH}/build"
    -G "${GENERATOR}" "-DCMAKE_PREFIX_PATH=${prefix}" "-DCMAKE_CXX_COMPILER=${CXX}" "-DCMAKE_CXX_FLAGS=${CXX_FLAGS}"
    "-DCMAKE_CXX_COMPILER_LAUNCHER=${LAUNCHER}" "-DEXAMPLE=${SOURCE_DIR}/examples/steer_frankie.cc")
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
file(GET_RUNTIME_DEPENDENCIES EXECUTABLES ${programs} RESOLVED_DEPENDENCIES_VAR loaded UNRESOLVED_DEPENDENCIES_VAR missing)
foreach(library IN LISTS loaded)
  file(REAL_PATH "${library}" real)
  cmake_path(IS_PREFIX prefix "${library}" NORMALIZE installed)
  if(NOT installed AND (library MATCHES "cmeel|/\\.venv/" OR real MATCHES "cmeel|/\\.venv/"))
    message(FATAL_ERROR "${library} is loaded from the wheels")
  endif()
endforeach()
if(missing)
  message(FATAL_ERROR "not found by the loader: ${missing}")
endif()
if(NOT "${loaded}" MATCHES "libcoal")
  message(FATAL_ERROR "the installed programs load no libcoal: ${loaded}")
endif()
if(HAS_PROGRAM)
  run("running the installed program" "${prefix}/bin/moma" --help)
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
