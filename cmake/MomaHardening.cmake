# What makes a memory error in our code end the program instead of letting in who provoked it: checked copies of the C
# library (_FORTIFY_SOURCE), canaries on stacks, programs that load anywhere (PIE), tables of functions that are read-only
# once loaded (RELRO, now). For optimised builds; sanitizers see more by themselves, and fortified functions would hide
# calls from them. Nothing here changes what floating-point code computes. The presets ask for it.
option(MOMA_HARDEN "Harden optimised builds" OFF)
if(NOT MOMA_HARDEN OR MOMA_SANITIZE OR NOT CMAKE_BUILD_TYPE MATCHES "^(Release|RelWithDebInfo|MinSizeRel)$")
  set(MOMA_HARDENED OFF)
  return()
endif()
set(MOMA_HARDENED ON)

include(CheckCSourceCompiles)
include(CheckPIESupported)
check_pie_supported(LANGUAGES C CXX)  # with CMAKE_POSITION_INDEPENDENT_CODE: programs are linked with -pie

# Level 3 needs a compiler that knows the sizes of objects at run time, and a C library that asks for them.
set(CMAKE_REQUIRED_FLAGS "-O2 -U_FORTIFY_SOURCE -D_FORTIFY_SOURCE=3")
set(CMAKE_REQUIRED_QUIET ON)
check_c_source_compiles("#include <stdio.h>
#if !defined(__USE_FORTIFY_LEVEL) || __USE_FORTIFY_LEVEL < 3
#error level 3 is not there
#endif
int main(void) { return 0; }" MOMA_FORTIFY_3)
unset(CMAKE_REQUIRED_FLAGS)
unset(CMAKE_REQUIRED_QUIET)
set(fortify 2)
if(MOMA_FORTIFY_3)
  set(fortify 3)
endif()

add_compile_options(-U_FORTIFY_SOURCE -D_FORTIFY_SOURCE=${fortify} -fstack-protector-strong)
add_link_options(LINKER:-z,relro,-z,now,-z,noexecstack)
