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

# coal and the optional solvers live in a Python wheel's prefix, which no loader and no search knows and which may go with
# the checkout: what is used of it is copied into the installed prefix, with all that it needs from there. The folder is
# called lib because the wheels' libraries look for each other in $ORIGIN/../lib.
set(MOMA_WHEEL_LIBDIR "${CMAKE_INSTALL_LIBDIR}/moma/lib")
set(MOMA_PACKAGES coal)
if(qpOASES_FOUND)
  list(APPEND MOMA_PACKAGES qpOASES)
endif()
if(eiquadprog_FOUND)
  list(APPEND MOMA_PACKAGES eiquadprog)
endif()
if(MOMA_WHEEL_PREFIX)
  set(libraries "")
  foreach(package IN LISTS MOMA_PACKAGES)
    list(APPEND libraries "${MOMA_WHEEL_PREFIX}/lib/lib${package}${CMAKE_SHARED_LIBRARY_SUFFIX}")
  endforeach()
  foreach(component program library)
    install(CODE "
      set(moma_wheel \"${MOMA_WHEEL_PREFIX}/lib\")
      file(GET_RUNTIME_DEPENDENCIES LIBRARIES ${libraries} DIRECTORIES \"\${moma_wheel}\"
           RESOLVED_DEPENDENCIES_VAR moma_needed UNRESOLVED_DEPENDENCIES_VAR moma_missing)
      if(moma_missing)
        message(FATAL_ERROR \"the wheels' libraries need what is nowhere: \${moma_missing}\")
      endif()
      list(FILTER moma_needed INCLUDE REGEX \"^\${moma_wheel}/\")
      # Loaders ask for the name that a library gives itself, which may be another than the linker's.
      foreach(moma_library IN ITEMS ${libraries})
        file(GLOB moma_names \"\${moma_library}*\")
        list(APPEND moma_needed \${moma_names})
      endforeach()
      file(INSTALL \${moma_needed} DESTINATION \"\${CMAKE_INSTALL_PREFIX}/${MOMA_WHEEL_LIBDIR}\" FOLLOW_SYMLINK_CHAIN)"
      COMPONENT ${component})
  endforeach()
endif()

configure_package_config_file(cmake/momaConfig.cmake.in "${PROJECT_BINARY_DIR}/momaConfig.cmake"
  INSTALL_DESTINATION "${CMAKE_INSTALL_LIBDIR}/cmake/moma" PATH_VARS CMAKE_INSTALL_DATADIR MOMA_WHEEL_LIBDIR)
write_basic_package_version_file("${PROJECT_BINARY_DIR}/momaConfigVersion.cmake" COMPATIBILITY SameMinorVersion)
install(FILES "${PROJECT_BINARY_DIR}/momaConfig.cmake" "${PROJECT_BINARY_DIR}/momaConfigVersion.cmake"
        DESTINATION "${CMAKE_INSTALL_LIBDIR}/cmake/moma" COMPONENT library)

if(TARGET moma)
  file(RELATIVE_PATH libraries "/${CMAKE_INSTALL_BINDIR}" "/${MOMA_WHEEL_LIBDIR}")
  set_target_properties(moma PROPERTIES INSTALL_RPATH "$ORIGIN/${libraries}")
  install(TARGETS moma RUNTIME DESTINATION "${CMAKE_INSTALL_BINDIR}" COMPONENT program)
endif()
