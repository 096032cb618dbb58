# Debian packages: cmake --preset package, cmake --build --preset package, cpack in build/package.
set(INNERMAP_PACKAGE_CONTACT "The innermap developers <innermap@users.noreply.github.com>" CACHE STRING
    "Maintainer that packages name, with an address")
set(here ${CMAKE_CURRENT_LIST_DIR}/packages)

set(CPACK_GENERATOR DEB)
set(CPACK_PACKAGE_NAME innermap)
set(CPACK_PACKAGE_VENDOR innermap)
set(CPACK_PACKAGE_DESCRIPTION_SUMMARY "")  # each package has its own
set(CPACK_PACKAGE_CONTACT "${INNERMAP_PACKAGE_CONTACT}")
set(CPACK_PACKAGING_INSTALL_PREFIX /usr)
set(CPACK_STRIP_FILES ON)
set(CPACK_INSTALL_DEFAULT_DIRECTORY_PERMISSIONS
    OWNER_READ OWNER_WRITE OWNER_EXECUTE GROUP_READ GROUP_EXECUTE WORLD_READ WORLD_EXECUTE)
set(CPACK_PRE_BUILD_SCRIPTS ${here}/finish.cmake)
set(CPACK_VERBATIM_VARIABLES ON)

set(CPACK_DEB_COMPONENT_INSTALL ON)
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS ON)
set(CPACK_DEBIAN_PACKAGE_CONTROL_STRICT_PERMISSION ON)
set(CPACK_COMPONENTS_ALL "")

# innermap_package(COMPONENT NAME SECTION DEPENDS RECOMMENDS SUMMARY TEXT)
function(innermap_package component name section depends recommends summary text)
  list(APPEND CPACK_COMPONENTS_ALL ${component})
  string(TOUPPER ${component} key)
  set(CPACK_COMPONENTS_ALL ${CPACK_COMPONENTS_ALL} PARENT_SCOPE)
  set(INNERMAP_PACKAGE_${component} ${name} PARENT_SCOPE)
  set(CPACK_DEBIAN_${key}_PACKAGE_NAME ${name} PARENT_SCOPE)
  set(CPACK_DEBIAN_${key}_PACKAGE_SECTION ${section} PARENT_SCOPE)
  set(CPACK_DEBIAN_${key}_PACKAGE_DEPENDS "${depends}" PARENT_SCOPE)
  set(CPACK_DEBIAN_${key}_PACKAGE_RECOMMENDS "${recommends}" PARENT_SCOPE)
  set(CPACK_DEBIAN_${key}_DESCRIPTION "${summary}\n${text}" PARENT_SCOPE)
  set(CPACK_COMPONENT_${key}_DESCRIPTION "${summary}\n${text}" PARENT_SCOPE)
endfunction()

set(images "innermap-images (= ${PROJECT_VERSION})")
innermap_package(program innermap science "" "${images}"
  "harmonic maps of solids, into OpenVDB and EXR"
  "Carries what is inside a mesh (volumes, meshes, points, curves, cells) when
its surface deforms or is mapped to another shape, and proves where the map
folds nowhere. This is the command-line program.")
if(INNERMAP_BUILD_PICTURES)
  innermap_package(pictures innermap-images science "" "fonts-dejavu-core"
    "harmonic maps of solids: pictures"
    "The module that the innermap program, library and Python module load when
they read or write PNG pictures and textures. All else works without it.")
endif()
# What innermapConfig.cmake looks for. A library that is shared would be a package of its own.
string(CONCAT libraries
  "libopenvdb-dev, libtbb-dev, libopenexr-dev, libfmt-dev, libhwy-dev, zlib1g-dev, liblapacke-dev, "
  "libopenblas-dev, liblbfgs-dev, libblosc-dev, libboost-iostreams-dev")
if(NOT INNERMAP_SHARED)
  innermap_package(development libinnermap-dev libdevel "${libraries}" "${images}"
    "harmonic maps of solids: C++ library"
    "Headers, the static library and the CMake package for programs that compute
harmonic volume maps themselves.")
endif()
if(INNERMAP_BUILD_PYTHON)
  math(EXPR next "${INNERMAP_PYTHON_MINOR} + 1")
  set(numpy "python3-numpy")
  if(EXISTS /usr/share/numpy3/versions)
    file(STRINGS /usr/share/numpy3/versions abi REGEX "^abi ")
    string(REPLACE "abi " "python3-numpy-abi" abi "${abi}")
    set(numpy "python3-numpy, ${abi}")
  endif()
  innermap_package(python python3-innermap python
    "python3 (>= 3.${INNERMAP_PYTHON_MINOR}), python3 (<< 3.${next}), ${numpy}" "${images}"
    "harmonic maps of solids: Python module"
    "The functions of the innermap library on numpy arrays.")
  # Files of compiled Python come and go with the package.
  set(CPACK_DEBIAN_PYTHON_PACKAGE_CONTROL_EXTRA "${here}/postinst;${here}/prerm")
endif()

set(CPACK_PROJECT_CONFIG_FILE ${PROJECT_BINARY_DIR}/package_names.cmake)
set(names "")
foreach(component IN LISTS CPACK_COMPONENTS_ALL)
  string(APPEND names "set(INNERMAP_PACKAGE_${component} ${INNERMAP_PACKAGE_${component}})\n")
endforeach()
file(CONFIGURE OUTPUT ${CPACK_PROJECT_CONFIG_FILE} @ONLY CONTENT
"${names}set(INNERMAP_SOURCE [[${PROJECT_SOURCE_DIR}]])
set(INNERMAP_STRIP [[${CMAKE_STRIP}]])
")
include(CPack)
