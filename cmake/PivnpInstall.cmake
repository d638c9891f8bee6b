# What `cmake --install` installs: the program, and the engines as a package that other CMake projects find
# (examples/CMakeLists.txt is one). Headers go to include/pivnp, where they are included by the paths used here:
# "pivnp/piv/piv.hpp", "mpm/step/solver.hpp".
include(GNUInstallDirs)
include(CMakePackageConfigHelpers)

set(headers_dir ${CMAKE_INSTALL_INCLUDEDIR}/pivnp)
set(package_dir ${CMAKE_INSTALL_LIBDIR}/cmake/pivnp)

install(TARGETS pivnp RUNTIME)
foreach(engine version core image piv np io mpm compare)
  set_target_properties(pivnp_${engine} PROPERTIES EXPORT_NAME ${engine})  # pivnp::core
  target_include_directories(pivnp_${engine} INTERFACE $<INSTALL_INTERFACE:${headers_dir}>)
  target_compile_features(pivnp_${engine} INTERFACE cxx_std_20)
  install(TARGETS pivnp_${engine} EXPORT pivnp-targets ARCHIVE)
endforeach()
install(TARGETS pivnp_opencv pivnp_hdf5 EXPORT pivnp-targets)  # what engines are linked with
# The kernels' own headers stay here: they are no interface, and only the dispatch understands them.
install(DIRECTORY pivnp mpm compare DESTINATION ${headers_dir}
        FILES_MATCHING PATTERN "*.hpp" PATTERN "*-inl.hpp" EXCLUDE PATTERN "simd" EXCLUDE)

install(EXPORT pivnp-targets NAMESPACE pivnp:: DESTINATION ${package_dir})
configure_package_config_file(cmake/pivnp-config.cmake.in ${CMAKE_BINARY_DIR}/pivnp-config.cmake
                              INSTALL_DESTINATION ${package_dir})
write_basic_package_version_file(${CMAKE_BINARY_DIR}/pivnp-config-version.cmake COMPATIBILITY SameMinorVersion)
install(FILES ${CMAKE_BINARY_DIR}/pivnp-config.cmake ${CMAKE_BINARY_DIR}/pivnp-config-version.cmake
        DESTINATION ${package_dir})
