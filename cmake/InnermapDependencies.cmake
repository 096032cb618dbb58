# Libraries that innermap links, found alike in its own build and by its installed package.
include(CMakeFindDependencyMacro)

list(APPEND CMAKE_MODULE_PATH "/usr/lib/${CMAKE_LIBRARY_ARCHITECTURE}/cmake/OpenVDB")
set(_innermap_warn_deprecated "${CMAKE_WARN_DEPRECATED}")
set(CMAKE_WARN_DEPRECATED OFF)
find_dependency(OpenVDB)
set(CMAKE_WARN_DEPRECATED "${_innermap_warn_deprecated}")
find_dependency(TBB)
find_dependency(OpenEXR)
find_dependency(fmt)
find_dependency(hwy)
# compressed .vtu files
find_dependency(ZLIB)

if(NOT TARGET innermap_lapacke)
  find_library(INNERMAP_LAPACKE lapacke REQUIRED)
  find_library(INNERMAP_OPENBLAS openblas REQUIRED)
  add_library(innermap_lapacke INTERFACE IMPORTED)
  set_target_properties(innermap_lapacke PROPERTIES
    INTERFACE_LINK_LIBRARIES "${INNERMAP_LAPACKE};${INNERMAP_OPENBLAS}")
endif()

if(NOT TARGET innermap_lbfgs)
  find_library(INNERMAP_LBFGS lbfgs REQUIRED)
  add_library(innermap_lbfgs INTERFACE IMPORTED)
  set_target_properties(innermap_lbfgs PROPERTIES INTERFACE_LINK_LIBRARIES "${INNERMAP_LBFGS}")
endif()
