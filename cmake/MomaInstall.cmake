# `cmake --install`: the program (component `program`), and the controller library as the CMake package `moma`
# (component `library`): moma::controller, moma::config and moma::plugin, with DAQP's static library inside the export.
include(CMakePackageConfigHelpers)

set_target_properties(moma_controller PROPERTIES EXPORT_NAME controller)
set_target_properties(moma_config PROPERTIES EXPORT_NAME config)
set_target_properties(moma_daqp PROPERTIES EXPORT_NAME daqp)
set_target_properties(moma_plugin PROPERTIES EXPORT_NAME plugin)
install(TARGETS moma_controller moma_config moma_plugin moma_daqp EXPORT momaTargets
        ARCHIVE DESTINATION "${CMAKE_INSTALL_LIBDIR}" COMPONENT library
        LIBRARY DESTINATION "${CMAKE_INSTALL_LIBDIR}" COMPONENT library)
install(EXPORT momaTargets NAMESPACE moma:: DESTINATION "${CMAKE_INSTALL_LIBDIR}/cmake/moma" COMPONENT library)

# Case files and their optimality check serve `moma solve` alone, the fitting of shapes `moma robot`; solver adapters show the solvers' own headers.
install(DIRECTORY controller DESTINATION "${CMAKE_INSTALL_INCLUDEDIR}/moma" COMPONENT library
        FILES_MATCHING PATTERN "*.h" PATTERN "case" EXCLUDE PATTERN "fit" EXCLUDE PATTERN "solver_*.h" EXCLUDE)
install(DIRECTORY plugin DESTINATION "${CMAKE_INSTALL_INCLUDEDIR}/moma" COMPONENT library
        FILES_MATCHING PATTERN "*.h" PATTERN "host" EXCLUDE)
foreach(component program library)
  install(DIRECTORY configs/ DESTINATION "${CMAKE_INSTALL_DATADIR}/moma/configs" COMPONENT ${component})
  install(FILES LICENSE DESTINATION "${CMAKE_INSTALL_DOCDIR}" COMPONENT ${component})
  install(FILES "${DAQP_SOURCE_DIR}/../LICENSE" DESTINATION "${CMAKE_INSTALL_DOCDIR}" RENAME LICENSE.daqp
          COMPONENT ${component})
endforeach()

set(MOMA_OPTIONAL_DEPENDENCIES "")
if(eiquadprog_FOUND)
  string(APPEND MOMA_OPTIONAL_DEPENDENCIES "find_dependency(eiquadprog)\n")
endif()
configure_package_config_file(cmake/momaConfig.cmake.in "${PROJECT_BINARY_DIR}/momaConfig.cmake"
  INSTALL_DESTINATION "${CMAKE_INSTALL_LIBDIR}/cmake/moma" PATH_VARS CMAKE_INSTALL_DATADIR)
write_basic_package_version_file("${PROJECT_BINARY_DIR}/momaConfigVersion.cmake" COMPATIBILITY SameMinorVersion)
install(FILES "${PROJECT_BINARY_DIR}/momaConfig.cmake" "${PROJECT_BINARY_DIR}/momaConfigVersion.cmake"
        DESTINATION "${CMAKE_INSTALL_LIBDIR}/cmake/moma" COMPONENT library)

if(TARGET moma)
  # coal lives in a wheel's prefix, which no loader knows; inside the source tree it is not taken from the link line.
  set_target_properties(moma PROPERTIES INSTALL_RPATH_USE_LINK_PATH ON)
  if(MOMA_WHEEL_PREFIX)
    set_target_properties(moma PROPERTIES INSTALL_RPATH "${MOMA_WHEEL_PREFIX}/lib")
  endif()
  install(TARGETS moma RUNTIME DESTINATION "${CMAKE_INSTALL_BINDIR}" COMPONENT program)
endif()
