# What other projects get: find_package(corpuscle), then link corpuscle::core, ::kernels, ::physics or ::io.
include(CMakePackageConfigHelpers)
set(package ${CMAKE_INSTALL_LIBDIR}/cmake/corpuscle)
configure_package_config_file(cmake/corpuscleConfig.cmake.in corpuscleConfig.cmake INSTALL_DESTINATION ${package})
write_basic_package_version_file(corpuscleConfigVersion.cmake COMPATIBILITY SameMinorVersion)
install(FILES ${PROJECT_BINARY_DIR}/corpuscleConfig.cmake ${PROJECT_BINARY_DIR}/corpuscleConfigVersion.cmake
        DESTINATION ${package})
install(EXPORT corpuscle NAMESPACE corpuscle:: FILE corpuscleTargets.cmake DESTINATION ${package})
install(DIRECTORY scenes report DESTINATION ${CMAKE_INSTALL_DATADIR}/corpuscle PATTERN __pycache__ EXCLUDE)
