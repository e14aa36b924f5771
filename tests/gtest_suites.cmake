# Read by ctest: each suite of a GoogleTest program is one test, `slow` if the filter `slow` takes any of its cases. A process
# for each case would spend more time on loading libraries than on most cases. Set: name, program, slow, timeout.
function(suites_of filter out)
  set(list "")
  if(EXISTS "${program}" AND NOT filter STREQUAL "")
    execute_process(COMMAND "${program}" --gtest_list_tests "--gtest_filter=${filter}" OUTPUT_VARIABLE list)
  endif()
  string(REGEX MATCHALL "\n[A-Za-z0-9_/]+\\.(  #[^\n]*)?\n" heads "\n${list}")
  list(TRANSFORM heads REPLACE "\n([^.]+).*" "\\1")
  set(${out} "${heads}" PARENT_SCOPE)
endfunction()

suites_of("*" suites)
suites_of("${slow}" slow_suites)
foreach(suite IN LISTS suites)
  list(FIND slow_suites "${suite}" place)
  set(kind LABELS slow COST 20)  # begun early
  if(place EQUAL -1)
    set(kind LABELS fast)
  endif()
  add_test("${suite}" "${program}" "--gtest_filter=${suite}.*" --gtest_brief=1)
  # Threads that wait sleep: several tests share the cores.
  set_tests_properties("${suite}" PROPERTIES TIMEOUT "${timeout}" ENVIRONMENT OMP_WAIT_POLICY=passive ${kind})
endforeach()
if(NOT suites)
  add_test("${name}_NOT_BUILT" "${name}_NOT_BUILT")
endif()
