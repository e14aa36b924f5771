# Has PROGRAM write its manual page and its completions into FOLDER.
#   cmake -DPROGRAM=build/moma -DFOLDER=build/shell -P write_shell_files.cmake
cmake_minimum_required(VERSION 3.25)
file(MAKE_DIRECTORY "${FOLDER}")

function(write_file name)
  execute_process(COMMAND "${PROGRAM}" ${ARGN} OUTPUT_FILE "${FOLDER}/${name}" RESULT_VARIABLE code)
  if(NOT code EQUAL 0)
    message(FATAL_ERROR "${PROGRAM} ${ARGN} ended with ${code}")
  endif()
endfunction()

write_file(moma.1 help --man)
foreach(shell IN ITEMS bash zsh fish)
  write_file(moma.${shell} completion ${shell})
endforeach()
