# `cmake --install`: the program (component `program`), and the controller library as the CMake package `moma`
# (component `library`): moma::controller, moma::config and moma::plugin, with DAQP's static library inside the export.
include(CMakePackageConfigHelpers)

set_target_properties(moma_controller PROPERTIES EXPORT_NAME controller)
set_target_properties(moma_config PROPERTIES EXPORT_NAME config)
set_target_properties(moma_daqp PROPERTIES EXPORT_NAME daqp)
set_target_properties(moma_plugin PROPERTIES EXPORT_NAME plugin)
# Headers are those that each target lists in its file set.
install(TARGETS moma_controller moma_config moma_plugin moma_daqp EXPORT momaTargets
        FILE_SET HEADERS DESTINATION "${CMAKE_INSTALL_INCLUDEDIR}/moma" COMPONENT library
        ARCHIVE DESTINATION "${CMAKE_INSTALL_LIBDIR}" COMPONENT library
        LIBRARY DESTINATION "${CMAKE_INSTALL_LIBDIR}" COMPONENT library)
install(EXPORT momaTargets NAMESPACE moma:: DESTINATION "${CMAKE_INSTALL_LIBDIR}/cmake/moma" COMPONENT library)

foreach(component program library)
  install(DIRECTORY configs/ DESTINATION "${CMAKE_INSTALL_DATADIR}/moma/configs" COMPONENT ${component})
  install(FILES LICENSE DESTINATION "${CMAKE_INSTALL_DOCDIR}" COMPONENT ${component})
  install(FILES "${DAQP_SOURCE_DIR}/../LICENSE" DESTINATION "${CMAKE_INSTALL_DOCDIR}" RENAME LICENSE.daqp
          COMPONENT ${component})
endforeach()

# coal lives in a Python wheel's prefix, which no loader and no search knows and which may go with
# the checkout: what is used of it is copied into the installed prefix, with all that it needs from there. The folder is
# called lib because the wheels' libraries look for each other in $ORIGIN/../lib.
set(MOMA_WHEEL_LIBDIR "${CMAKE_INSTALL_LIBDIR}/moma/lib")
set(MOMA_PACKAGES coal)
if(MOMA_WHEEL_PREFIX)
  set(libraries "")
  foreach(package IN LISTS MOMA_PACKAGES)
    list(APPEND libraries "${MOMA_WHEEL_PREFIX}/lib/lib${package}${CMAKE_SHARED_LIBRARY_SUFFIX}")
  endforeach()
  configure_file(cmake/install_wheels.cmake.in "${PROJECT_BINARY_DIR}/install_wheels.cmake" @ONLY)
  foreach(component program library)
    install(SCRIPT "${PROJECT_BINARY_DIR}/install_wheels.cmake" COMPONENT ${component})
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
  # Its manual page and completions (eval/cli/CMakeLists.txt writes them) where shells look for them, and the documentation.
  set(shell "${PROJECT_BINARY_DIR}/shell")
  install(FILES "${shell}/moma.1" DESTINATION "${CMAKE_INSTALL_MANDIR}/man1" COMPONENT program)
  install(FILES "${shell}/moma.bash" DESTINATION "${CMAKE_INSTALL_DATADIR}/bash-completion/completions" RENAME moma
          COMPONENT program)
  install(FILES "${shell}/moma.fish" DESTINATION "${CMAKE_INSTALL_DATADIR}/fish/vendor_completions.d" COMPONENT program)
  install(DIRECTORY docs examples DESTINATION "${CMAKE_INSTALL_DOCDIR}" COMPONENT program)
  install(FILES README.md CHANGELOG.md DESTINATION "${CMAKE_INSTALL_DOCDIR}" COMPONENT program)
endif()

# Into a wheel (component `python`, by pyproject.toml alone): pip's prefix is the package's folder there, and the program with
# its libraries is installed into the same.
if(TARGET moma_python)
  set_target_properties(moma_python PROPERTIES INSTALL_RPATH "$ORIGIN/${MOMA_WHEEL_LIBDIR}")
  install(TARGETS moma_python LIBRARY DESTINATION . COMPONENT python EXCLUDE_FROM_ALL)
  install(FILES plugin/process/runner.py DESTINATION . RENAME _runner.py COMPONENT python EXCLUDE_FROM_ALL)
  install(FILES "${PROJECT_BINARY_DIR}/python/moma/_core.pyi" DESTINATION . COMPONENT python EXCLUDE_FROM_ALL)
endif()
