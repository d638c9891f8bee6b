# Debian packages, by `cpack` in the build folder: pivnp (program), pivnp-view (window), pivnp-dev (engines) and python3-pivnp.
set(PIVNP_MAINTAINER "The pivnp developers <pivnp@users.noreply.github.com>" CACHE STRING "Name and address in Debian packages")

set(CPACK_GENERATOR DEB)
set(CPACK_PACKAGE_NAME pivnp)
set(CPACK_PACKAGE_DESCRIPTION_SUMMARY "")  # each package has its own, in its first line
set(CPACK_PACKAGE_CONTACT "${PIVNP_MAINTAINER}")
set(CPACK_PACKAGE_DIRECTORY ${CMAKE_BINARY_DIR}/packages)
set(CPACK_STRIP_FILES ON)
set(CPACK_THREADS 0)
set(CPACK_COMPONENTS_ALL program dev)
if(TARGET pivnp_core_module)
  list(APPEND CPACK_COMPONENTS_ALL python)
endif()
if(TARGET pivnp-view)
  list(APPEND CPACK_COMPONENTS_ALL view)
endif()
set(CPACK_COMPONENTS_GROUPING ONE_PER_GROUP)
set(CPACK_DEB_COMPONENT_INSTALL ON)
set(CPACK_INSTALL_DEFAULT_DIRECTORY_PERMISSIONS OWNER_READ OWNER_WRITE OWNER_EXECUTE GROUP_READ GROUP_EXECUTE WORLD_READ WORLD_EXECUTE)
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_DEBIAN_PACKAGE_CONTROL_STRICT_PERMISSION ON)
set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS ON)
set(CPACK_DEBIAN_COMPRESSION_TYPE gzip)  # half a minute less than xz

set(CPACK_DEBIAN_PROGRAM_PACKAGE_NAME pivnp)
set(CPACK_DEBIAN_PROGRAM_PACKAGE_SECTION science)
set(CPACK_DEBIAN_PROGRAM_PACKAGE_DEPENDS "fonts-dejavu-core")
set(CPACK_COMPONENT_PROGRAM_DESCRIPTION "measurement of soil in motion from video, and its simulation
The program pivnp measures displacement and large strain of soil from the
frames of an experiment, by particle image velocimetry and numerical
particles (PIV-NP). It simulates the same experiment by the material point
method on the same nodes, and reports the difference of both beside the
uncertainty of each.")

set(CPACK_DEBIAN_VIEW_PACKAGE_NAME pivnp-view)
set(CPACK_DEBIAN_VIEW_PACKAGE_SECTION science)
set(CPACK_DEBIAN_VIEW_PACKAGE_DEPENDS "pivnp (= ${PROJECT_VERSION})")
set(CPACK_COMPONENT_VIEW_DESCRIPTION "window of pivnp
A desktop program that sets a case of pivnp up on the frames of an
experiment, with the vectors of any pair as settings change, runs it, and
shows the particles of its record, measured and simulated side by side.")

set(CPACK_DEBIAN_DEV_PACKAGE_NAME pivnp-dev)
set(CPACK_DEBIAN_DEV_PACKAGE_SECTION libdevel)
set(CPACK_DEBIAN_DEV_PACKAGE_SHLIBDEPS OFF)
set(CPACK_DEBIAN_DEV_PACKAGE_DEPENDS "libeigen3-dev, libcgal-dev, libhwy-dev, libfftw3-dev, libdeflate-dev, libhdf5-dev, libgmp-dev, libmpfr-dev, \
libopencv-core-dev, libopencv-imgproc-dev, libopencv-imgcodecs-dev, libopencv-videoio-dev, libopencv-calib3d-dev, libopencv-contrib-dev, pkg-config")
set(CPACK_COMPONENT_DEV_DESCRIPTION "engines of pivnp as C++ libraries
Static libraries and headers of the engines: image correlation, numerical
particles, the material point method, records and their comparison. They
are found by CMake (find_package(pivnp)) and by pkg-config.")

set(CPACK_DEBIAN_PYTHON_PACKAGE_NAME python3-pivnp)
set(CPACK_DEBIAN_PYTHON_PACKAGE_SECTION python)
if(TARGET pivnp_core_module)
  math(EXPR next "${PIVNP_PYTHON_MINOR} + 1")
  set(CPACK_DEBIAN_PYTHON_PACKAGE_DEPENDS "python3 (>= 3.${PIVNP_PYTHON_MINOR}), python3 (<< 3.${next}), python3-numpy, pivnp (= ${PROJECT_VERSION})")
endif()
set(CPACK_DEBIAN_PYTHON_PACKAGE_SUGGESTS "python3-matplotlib, python3-pandas, python3-xarray")
set(CPACK_DEBIAN_PYTHON_PACKAGE_CONTROL_EXTRA ${CMAKE_SOURCE_DIR}/packaging/debian/postinst ${CMAKE_SOURCE_DIR}/packaging/debian/prerm)
set(CPACK_COMPONENT_PYTHON_DESCRIPTION "PIV, numerical particles and the material point method in Python
Records of pivnp as numpy arrays, and its engines on arrays: image
correlation, numerical particles, the material point method and comparison,
with the bits of the program.")

# What every package holds of itself.
string(TIMESTAMP PIVNP_PACKAGE_DATE "%a, %d %b %Y %H:%M:%S +0000" UTC)
find_program(PIVNP_GZIP gzip)
foreach(package pivnp:program pivnp-view:view pivnp-dev:dev python3-pivnp:python)
  string(REPLACE ":" ";" package ${package})
  list(GET package 0 PIVNP_PACKAGE)
  list(GET package 1 component)
  set(folder ${CMAKE_BINARY_DIR}/packaging/${PIVNP_PACKAGE})
  configure_file(packaging/debian/changelog.in ${folder}/changelog @ONLY)
  if(PIVNP_GZIP)
    execute_process(COMMAND ${PIVNP_GZIP} -9nf ${folder}/changelog)
    install(FILES ${folder}/changelog.gz DESTINATION ${CMAKE_INSTALL_DATADIR}/doc/${PIVNP_PACKAGE} COMPONENT ${component} EXCLUDE_FROM_ALL)
  endif()
  install(FILES packaging/debian/copyright DESTINATION ${CMAKE_INSTALL_DATADIR}/doc/${PIVNP_PACKAGE} COMPONENT ${component} EXCLUDE_FROM_ALL)
endforeach()
include(CPack)
