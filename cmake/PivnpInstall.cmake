# What `cmake --install` installs: the program (component `program`), the engines as a package that other CMake projects find and
# a file for pkg-config (`dev`; examples/ uses both), and the Python module (`python`). Headers go to include/pivnp, where they are
# included by the paths used here: "pivnp/piv/piv.hpp", "mpm/solver/solver.hpp".
include(GNUInstallDirs)
include(CMakePackageConfigHelpers)

set(headers_dir ${CMAKE_INSTALL_INCLUDEDIR}/pivnp)
set(package_dir ${CMAKE_INSTALL_LIBDIR}/cmake/pivnp)
set(engines version core image piv np io mpm compare)

# The program, with what desktop and shell know of it. Manual pages and completion are made of its --help.
install(TARGETS pivnp RUNTIME COMPONENT program)
install(FILES docs/case.schema.json DESTINATION ${CMAKE_INSTALL_DATADIR}/pivnp COMPONENT program)
install(FILES packaging/pivnp.xml DESTINATION ${CMAKE_INSTALL_DATADIR}/mime/packages COMPONENT program)
install(FILES packaging/pivnp.svg DESTINATION ${CMAKE_INSTALL_DATADIR}/icons/hicolor/scalable/apps COMPONENT program)
install(FILES packaging/pivnp.svg DESTINATION ${CMAKE_INSTALL_DATADIR}/icons/hicolor/scalable/mimetypes
        RENAME application-x-pivnp-case.svg COMPONENT program)
find_program(PIVNP_SCRIPT_PYTHON NAMES python3 PATHS /usr/bin NO_DEFAULT_PATH)
if(PIVNP_SCRIPT_PYTHON AND NOT PIVNP_SANITIZE)
  set(share ${CMAKE_BINARY_DIR}/share)
  add_custom_command(OUTPUT ${share}/zsh/vendor-completions/_pivnp
    COMMAND ${PIVNP_SCRIPT_PYTHON} ${CMAKE_SOURCE_DIR}/packaging/share.py $<TARGET_FILE:pivnp> ${share}
    DEPENDS pivnp packaging/share.py VERBATIM)
  add_custom_target(pivnp_share ALL DEPENDS ${share}/zsh/vendor-completions/_pivnp)
  install(DIRECTORY ${share}/man ${share}/bash-completion ${share}/zsh DESTINATION ${CMAKE_INSTALL_DATADIR} COMPONENT program)
endif()

# The window, a package of its own.
if(TARGET pivnp-view)
  install(TARGETS pivnp-view RUNTIME COMPONENT view)
  install(FILES packaging/pivnp-view.desktop DESTINATION ${CMAKE_INSTALL_DATADIR}/applications COMPONENT view)
endif()

# The engines.
foreach(engine IN LISTS engines)
  set_target_properties(pivnp_${engine} PROPERTIES EXPORT_NAME ${engine})  # pivnp::core
  target_include_directories(pivnp_${engine} INTERFACE $<INSTALL_INTERFACE:${headers_dir}>)
  target_compile_features(pivnp_${engine} INTERFACE cxx_std_20)
  install(TARGETS pivnp_${engine} EXPORT pivnp-targets ARCHIVE COMPONENT dev)
endforeach()
install(TARGETS pivnp_opencv pivnp_hdf5 EXPORT pivnp-targets)  # what engines are linked with
# The kernels' own headers stay here: they are no interface, and only the dispatch understands them.
install(DIRECTORY pivnp mpm compare DESTINATION ${headers_dir} COMPONENT dev
        FILES_MATCHING PATTERN "*.hpp" PATTERN "*-inl.hpp" EXCLUDE PATTERN "simd" EXCLUDE)
install(EXPORT pivnp-targets NAMESPACE pivnp:: DESTINATION ${package_dir} COMPONENT dev)
configure_package_config_file(cmake/pivnp-config.cmake.in ${CMAKE_BINARY_DIR}/pivnp-config.cmake
                              INSTALL_DESTINATION ${package_dir})
write_basic_package_version_file(${CMAKE_BINARY_DIR}/pivnp-config-version.cmake COMPATIBILITY SameMinorVersion)
install(FILES ${CMAKE_BINARY_DIR}/pivnp-config.cmake ${CMAKE_BINARY_DIR}/pivnp-config-version.cmake
        DESTINATION ${package_dir} COMPONENT dev)

# For pkg-config: the engines as one, each before those it needs.
set(pc_libraries "")
foreach(engine compare mpm np piv image io core version)
  string(APPEND pc_libraries " -lpivnp_${engine}")
endforeach()
if(PIVNP_OPENCV_aruco)
  string(APPEND pc_libraries " -lopencv_aruco")
endif()
foreach(module video calib3d videoio imgcodecs imgproc core)
  string(APPEND pc_libraries " -lopencv_${module}")
endforeach()
get_target_property(hdf5_library pivnp_hdf5 INTERFACE_LINK_LIBRARIES)
if(hdf5_library MATCHES "/serial/")  # Debian's second name of it, in the usual folder
  string(APPEND pc_libraries " -lhdf5_serial")
else()
  string(APPEND pc_libraries " -lhdf5")
endif()
string(APPEND pc_libraries " -lmpfr -lgmp -lgomp -pthread")
configure_file(cmake/pivnp.pc.in ${CMAKE_BINARY_DIR}/pivnp.pc @ONLY)
install(FILES ${CMAKE_BINARY_DIR}/pivnp.pc DESTINATION ${CMAKE_INSTALL_LIBDIR}/pkgconfig COMPONENT dev)

# The Python module, where Debian's python3 finds it (a wheel has a place of its own: packaging/pivnp_wheel.py).
set(PIVNP_PYTHON_DIR lib/python3/dist-packages CACHE STRING "Where the Python package is installed, under the prefix")
if(TARGET pivnp_core_module)
  install(TARGETS pivnp_core_module LIBRARY DESTINATION ${PIVNP_PYTHON_DIR}/pivnp COMPONENT python)
  install(DIRECTORY python/pivnp DESTINATION ${PIVNP_PYTHON_DIR} COMPONENT python
          FILES_MATCHING PATTERN "*.py" PATTERN "*.pyi" PATTERN "py.typed" PATTERN "__pycache__" EXCLUDE)
endif()
