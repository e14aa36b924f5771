# Writes OUTPUT with the commit checked out in SOURCE_DIR, only when it changed.
find_program(git git)
set(commit "")
set(dirty false)
if(git)
  execute_process(COMMAND ${git} -C ${SOURCE_DIR} rev-parse HEAD OUTPUT_VARIABLE commit ERROR_QUIET
                  OUTPUT_STRIP_TRAILING_WHITESPACE RESULT_VARIABLE failed)
  if(failed)
    set(commit "")
  else()
    execute_process(COMMAND ${git} -C ${SOURCE_DIR} --no-optional-locks status --porcelain --untracked-files=no
                    OUTPUT_VARIABLE changes ERROR_QUIET OUTPUT_STRIP_TRAILING_WHITESPACE)
    if(changes)
      set(dirty true)
    endif()
  endif()
endif()
set(text "// Written at build time.
#include \"eval/store/machine.h\"

namespace moma::store {
const char* const kGitCommit = \"${commit}\";
const bool kGitDirty = ${dirty};
}  // namespace moma::store
")
set(old "")
if(EXISTS ${OUTPUT})
  file(READ ${OUTPUT} old)
endif()
if(NOT old STREQUAL text)
  file(WRITE ${OUTPUT} "${text}")
endif()
