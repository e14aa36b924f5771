# Language level and warnings of every target of ours, on one interface target.
if(NOT CMAKE_BUILD_TYPE AND NOT CMAKE_CONFIGURATION_TYPES)
  set(CMAKE_BUILD_TYPE Release CACHE STRING "Release, Debug or RelWithDebInfo" FORCE)
endif()
set(CMAKE_CXX_STANDARD 20)
set(CMAKE_CXX_STANDARD_REQUIRED ON)
set(CMAKE_CXX_EXTENSIONS OFF)
set(CMAKE_POSITION_INDEPENDENT_CODE ON)
set(CMAKE_EXPORT_COMPILE_COMMANDS ON)
set(CMAKE_RUNTIME_OUTPUT_DIRECTORY "${CMAKE_BINARY_DIR}")

find_program(CCACHE_PROGRAM ccache)
if(CCACHE_PROGRAM AND NOT CMAKE_CXX_COMPILER_LAUNCHER)
  set(CMAKE_C_COMPILER_LAUNCHER "${CCACHE_PROGRAM}")
  set(CMAKE_CXX_COMPILER_LAUNCHER "${CCACHE_PROGRAM}")
endif()

# Most of a source's compile time goes into what it includes: where sources are compiled together, a folder is one or two.
if(NOT DEFINED CMAKE_UNITY_BUILD_BATCH_SIZE)
  set(CMAKE_UNITY_BUILD_BATCH_SIZE 20)
endif()

option(MOMA_FAST_LINK "Link by mold where it is there" OFF)
find_program(MOLD_PROGRAM mold)
if(MOMA_FAST_LINK AND MOLD_PROGRAM)
  add_link_options(-fuse-ld=mold)
endif()

add_library(moma_warnings INTERFACE)
target_compile_options(moma_warnings INTERFACE -Wall -Wextra -Wpedantic -Wshadow $<$<COMPILE_LANGUAGE:CXX>:-Wnon-virtual-dtor> -Wswitch)
if(CMAKE_CXX_COMPILER_ID STREQUAL "GNU" AND CMAKE_CXX_COMPILER_VERSION VERSION_LESS 13)
  # GCC 12 reports overlaps in std::string's operator+ that cannot be (GCC bug 105329).
  target_compile_options(moma_warnings INTERFACE -Wno-restrict)
endif()
if(CMAKE_CXX_COMPILER_ID STREQUAL "GNU" AND CMAKE_UNITY_BUILD)
  # Sources that are compiled together are included, and gcc takes what they keep to themselves for a header's.
  target_compile_options(moma_warnings INTERFACE $<$<COMPILE_LANGUAGE:CXX>:-Wno-subobject-linkage>)
endif()
if(MOMA_WERROR)
  target_compile_options(moma_warnings INTERFACE -Werror)
endif()
# One layout of Eigen's types and memory, whatever instructions are built for and with whatever sanitizer: that of coal's
# wheel (controller/types.h).
set(MOMA_EIGEN_LAYOUT EIGEN_MAX_ALIGN_BYTES=16 EIGEN_MALLOC_ALREADY_ALIGNED=1)
add_compile_definitions(${MOMA_EIGEN_LAYOUT})
# Contracted multiply-adds would make results depend on the compiler's mood.
add_compile_options(-ffp-contract=off)

set(MOMA_SANITIZE "" CACHE STRING "Sanitizers, for instance address,undefined or thread")
if(MOMA_SANITIZE)
  # What is found ends the program: undefined behaviour would only be printed, which neither a test nor a fuzzer notices.
  add_compile_options(-fsanitize=${MOMA_SANITIZE} -fno-sanitize-recover=all -fno-omit-frame-pointer)
  add_link_options(-fsanitize=${MOMA_SANITIZE})
  if(CMAKE_CXX_COMPILER_ID STREQUAL "GNU")
    add_compile_options(-Wno-maybe-uninitialized)  # GCC: not to be trusted in instrumented code (std::variant, say)
  endif()
  if(CMAKE_CXX_COMPILER_ID STREQUAL "Clang" AND MOMA_SANITIZE MATCHES "undefined")
    # Checks make Eigen's accessors too long to be inlined; called, a control step takes three times as long.
    add_compile_options("$<$<COMPILE_LANGUAGE:CXX>:SHELL:-mllvm -inline-threshold=2000>")
  endif()
endif()
