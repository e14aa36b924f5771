# Packages from Debian, and from the wheels of .venv (coal and the Boost that it brings; QP solvers of the tests).
find_package(PkgConfig REQUIRED)
find_package(Threads REQUIRED)

file(GLOB MOMA_WHEEL_PREFIX "${CMAKE_CURRENT_SOURCE_DIR}/.venv/lib/python3*/site-packages/cmeel.prefix")
if(MOMA_WHEEL_PREFIX)
  list(APPEND CMAKE_PREFIX_PATH "${MOMA_WHEEL_PREFIX}")
endif()

find_package(Eigen3 3.4 REQUIRED NO_MODULE)
find_package(urdfdom REQUIRED)
if(NOT urdfdom_VERSION)  # Debian's package does not say it
  pkg_check_modules(urdfdom_pc QUIET urdfdom)
  set(urdfdom_VERSION "${urdfdom_pc_VERSION}")
endif()
# coalConfig looks for Boost by the old module, which warns that it is newer than CMake.
set(Boost_NO_WARN_NEW_VERSIONS ON)
find_package(coal 3.0.3 REQUIRED)
find_package(yaml-cpp REQUIRED)
find_package(nlohmann_json REQUIRED)
if(MOMA_BUILD_EVALUATION)
  find_package(fmt REQUIRED)
  find_package(CLI11 REQUIRED)
  find_package(SQLite3 REQUIRED)
  find_package(SQLiteCpp REQUIRED)
  find_package(zstd REQUIRED)
  find_package(OpenMP REQUIRED)
  find_package(NLopt 2.7 REQUIRED PATH_SUFFIXES lib/${CMAKE_LIBRARY_ARCHITECTURE}/cmake/nlopt_cxx)
  pkg_check_modules(ODE REQUIRED IMPORTED_TARGET ode)
  pkg_check_modules(MICROHTTPD REQUIRED IMPORTED_TARGET libmicrohttpd)
  pkg_check_modules(XXHASH REQUIRED IMPORTED_TARGET libxxhash)
  find_path(RANDOM123_INCLUDE_DIR Random123/philox.h REQUIRED)
endif()

# moma_link_packaged(TARGET NAME LIBRARY): links LIBRARY in the build; what is installed links moma::NAME, which
# momaConfig.cmake makes of the copy in the installed prefix, or of the package that is on the system.
function(moma_link_packaged target name library)
  target_link_libraries(${target} PRIVATE "$<BUILD_INTERFACE:${library}>" "$<INSTALL_INTERFACE:moma::${name}>")
endfunction()

# DAQP has no CMake package: its C sources, fetched and checked by scripts/setup.sh, become a static library.
set(DAQP_SOURCE_DIR "${CMAKE_CURRENT_SOURCE_DIR}/.deps/daqp-0.11.0/csrc" CACHE PATH "Folder with DAQP's include/ and src/")
if(NOT EXISTS "${DAQP_SOURCE_DIR}/include/api.h")
  message(FATAL_ERROR "DAQP's sources are not in ${DAQP_SOURCE_DIR}: run scripts/setup.sh first")
endif()
set(daqp_sources api auxiliary avi bnb daqp daqp_prox eq_elim factorization hierarchical presolve utils)
list(TRANSFORM daqp_sources PREPEND "${DAQP_SOURCE_DIR}/src/")
list(TRANSFORM daqp_sources APPEND ".c")
add_library(moma_daqp STATIC ${daqp_sources})
target_include_directories(moma_daqp SYSTEM PUBLIC "$<BUILD_INTERFACE:${DAQP_SOURCE_DIR}/include>")
target_compile_options(moma_daqp PRIVATE -w)
set_target_properties(moma_daqp PROPERTIES UNITY_BUILD OFF)

if(MOMA_BUILD_TESTS)
  find_package(GTest REQUIRED)
  find_package(rapidcheck REQUIRED)
  # Two more QP solvers, oracles of tests where they are installed.
  find_package(eiquadprog QUIET)
  find_package(qpOASES QUIET)
endif()
if(MOMA_BUILD_BENCH)
  find_package(benchmark REQUIRED)
endif()
