# `pip install .` in a checkout that is built compiles nothing: what scikit-build-core runs of CMake takes program and package out of build/.
#   cmake -DSOURCE_DIR=... -DSCRATCH=... -DPYTHON=... -P reuse_test.cmake
file(REMOVE_RECURSE "${SCRATCH}")
function(run)
  execute_process(COMMAND ${ARGN} RESULT_VARIABLE result OUTPUT_VARIABLE output ERROR_VARIABLE output)
  if(result)
    message(FATAL_ERROR "${ARGN}: ${result}\n${output}")
  endif()
  set(output "${output}" PARENT_SCOPE)
endfunction()
function(configure folder)
  run("${CMAKE_COMMAND}" -S "${SOURCE_DIR}" -B "${SCRATCH}/${folder}" -G Ninja -DSKBUILD=2 "-DPython_EXECUTABLE=${PYTHON}" ${ARGN})
  set(output "${output}" PARENT_SCOPE)
endfunction()

configure(wheel)
if(NOT output MATCHES "program and package come from build/")
  message(FATAL_ERROR "build/ was not taken:\n${output}")
endif()
run("${CMAKE_COMMAND}" --build "${SCRATCH}/wheel" --target moma moma_python)
foreach(component IN ITEMS program python)
  run("${CMAKE_COMMAND}" --install "${SCRATCH}/wheel" --prefix "${SCRATCH}/moma" --component ${component})
endforeach()
run("${SCRATCH}/moma/bin/moma" --version)
file(GLOB module "${SCRATCH}/moma/_core*.so")
if(NOT module OR NOT EXISTS "${SCRATCH}/moma/_runner.py" OR NOT EXISTS "${SCRATCH}/moma/share/moma/configs/suites/demo.yaml")
  message(FATAL_ERROR "the package is not whole: ${module}")
endif()
# The module finds its libraries where it is.
run("${CMAKE_COMMAND}" -E env "PYTHONPATH=${SCRATCH}/moma" "${PYTHON}" -c "import _core; print(_core.layouts(7, 9))")

# Of another Python it is none of its business.
file(WRITE "${SCRATCH}/other" "#!/bin/sh\necho cpython-399\n")
file(CHMOD "${SCRATCH}/other" PERMISSIONS OWNER_READ OWNER_WRITE OWNER_EXECUTE)
execute_process(COMMAND "${CMAKE_COMMAND}" -S "${SOURCE_DIR}" -B "${SCRATCH}/apart" -G Ninja -DSKBUILD=2 "-DPython_EXECUTABLE=${SCRATCH}/other"
                OUTPUT_VARIABLE output ERROR_VARIABLE output)
if(NOT output MATCHES "compiles all of the program, because build/ is for cpython-[0-9]+, not cpython-399")
  message(FATAL_ERROR "a build for another Python was taken:\n${output}")
endif()
